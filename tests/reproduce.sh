#!/usr/bin/env bash
# Two builds of the same sources, in folders of different names, are the same
# files. Usage: reproduce.sh FOLDER
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p "$1"
out=$(cd "$1" && pwd)
rm -rf "$out/one" "$out/another-longer-name"
for copy in one another-longer-name; do
  mkdir "$out/$copy"
  git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$out/$copy"
  make -s -j "$(nproc)" -C "$out/$copy" >"$out/$copy.log" 2>&1 || { cat "$out/$copy.log" && exit 1; }
done
cd "$out"
find one/build/release -maxdepth 1 -type f ! -name stamp -printf '%f\n' | sort | while read -r file; do
  cmp "one/build/release/$file" "another-longer-name/build/release/$file" && printf 'the same: %s\n' "$file"
done
