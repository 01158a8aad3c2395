#!/usr/bin/env bash
# The runtime depends on nothing: it links with libc and libm alone, exports our
# prefix only, and neither allocates, prints nor keeps writable state.
# Usage: test_purity.sh LIBSTYLUT_RT.a CONFIG
set -euo pipefail
library=$1
config=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Passes when its input is empty; else shows it and fails.
expect_nothing() {
  local found
  found=$(cat)
  [ -z "$found" ] || { printf 'found:\n%s\n' "$found"; exit 1; }
}

echo "headers compile alone, as C11 and as C++17"
"${CC:-gcc}" -std=c11 -pedantic -Wall -Werror -fsyntax-only -x c -I"$root/include" "$root/include/stylut/runtime.h"
"${CXX:-g++}" -std=c++17 -pedantic -Wall -Werror -fsyntax-only -x c++ -I"$root/include" "$root/include/stylut/runtime.h"

echo "sources include the runtime's own headers and libc only"
{ grep -hE '#include "' "$root"/src/runtime/*.[ch] | grep -vE '"(stylut/runtime(_format)?|view|picture)\.h"' || true; } | expect_nothing

# Instrumented objects call their instruments; what follows is for plain ones.
case $config in sanitize | coverage) exit 0 ;; esac

echo "exports sty_ names only"
nm -g --defined-only "$library" | awk 'NF == 3 && $3 !~ /^sty_/' | expect_nothing

echo "asks libc for nothing but memory blocks"
nm -g --undefined-only "$library" |
  awk 'NF == 2 && $2 !~ /^(sty_[a-z0-9_]+|mem(cpy|move|set|cmp)|_GLOBAL_OFFSET_TABLE_)$/' | expect_nothing

echo "has no writable data"
nm "$library" | awk 'NF > 1 && $(NF - 1) ~ /^[bBdDcC]$/' | expect_nothing

echo "links with libc and libm alone"
printf '#include "stylut/runtime.h"\nint main(void) { StyBundle b; StyBlob f[STY_BUNDLE_FILES] = {{0, 0}}; return sty_open_bundle(f, &b, 0) == STY_RUNTIME_OK; }\n' >"$work/use.c"
"${CC:-gcc}" -std=c11 -I"$root/include" -o "$work/use" "$work/use.c" "$library" -lm
"$work/use"
ldd "$work/use" | awk '!/linux-vdso|libc\.so|libm\.so|ld-linux/' | expect_nothing
echo "all true"
