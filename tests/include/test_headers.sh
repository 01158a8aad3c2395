#!/usr/bin/env bash
# Every public header compiles alone, as C11 and as C++17; included, since clang
# complains of inline functions that nobody calls in what it compiles itself.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
for header in "$root"/include/stylut/*.h; do
  echo "$header"
  include="#include \"$header\""
  "${CC:-gcc}" -std=c11 -Wall -Wextra -Werror -fsyntax-only -x c -I"$root/include" - <<<"$include"
  "${CXX:-g++}" -std=c++17 -Wall -Wextra -Werror -fsyntax-only -x c++ -I"$root/include" - <<<"$include"
done
