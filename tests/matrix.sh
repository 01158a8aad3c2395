#!/usr/bin/env bash
# Every output of the demo, by every compiler, configuration, vector unit and
# number of threads: one byte that differs fails. Usage: matrix.sh FOLDER
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
mkdir -p "$1"
out=$(cd "$1" && pwd)
rm -f "$out/first"
differing=0 rows=0

# hash_demo TOOL UNIT THREADS: the demo's files and their hashes. What it draws
# last, the contact sheet, is oiiotool's.
hash_demo() {
  rm -rf "$out/demo"
  printf '#!/bin/sh\nexec "%s" "$@" -j %s\n' "$1" "$3" >"$out/stylut"
  chmod +x "$out/stylut"
  STYLUT_VECTOR=$2 exemplars/demo.sh "$out/stylut" "$out/demo" >"$out/log" 2>&1 || return 1
  (cd "$out/demo" && find . -type f ! -name contact.png -exec sha256sum {} + | sort -k 2)
}

units=(plain)
grep -qw avx2 /proc/cpuinfo && units+=(avx2)
grep -qw avx512bw /proc/cpuinfo && units+=(avx512)
printf '%-6s %-8s %-9s %-8s %s\n' CC config unit threads 'the same bytes'
for config in release debug; do
  for compiler in gcc clang; do
    cxx=g++
    folder=$config
    [ $compiler = clang ] && cxx=clang++ folder=$config-clang
    make -s -j "$(nproc)" CC=$compiler CXX=$cxx config=$config "build/$folder/stylut" >"$out/build.log" 2>&1 || { cat "$out/build.log" && exit 1; }
    for unit in "${units[@]}"; do
      for threads in 1 2 3 4; do
        rows=$((rows + 1)) said=yes
        hash_demo "$PWD/build/$folder/stylut" "$unit" $threads >"$out/hashes" || said='no: the demo failed'
        [ -f "$out/first" ] || [ "$said" != yes ] || cp "$out/hashes" "$out/first"
        cmp -s "$out/hashes" "$out/first" || said="no: $(diff "$out/first" "$out/hashes" | sed -n 's/^> [0-9a-f]*  //p' | tr '\n' ' ')"
        [ "$said" = yes ] || differing=$((differing + 1))
        printf '%-6s %-8s %-9s %-8s %s\n' $compiler $config "$unit" $threads "$said"
      done
    done
  done
done
printf '%d rows of %d files, %d differ\n' $rows "$(wc -l <"$out/first")" $differing
rm -f "$out/first"
[ $differing = 0 ]
