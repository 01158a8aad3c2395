#!/usr/bin/env bash
# The urn of exemplars/lit and the pictures that things there wear. Usage: lit.sh FOLDER
set -euo pipefail
out=$1
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export LC_ALL=C # a point, whatever the language

awk -v shape=urn -f "$here/shapes.awk" >"$out/urn.obj"
for pattern in glaze tiles; do
  awk -v pattern=$pattern -f "$here/patterns.awk" >"$scratch/$pattern.ppm"
  oiiotool --nosoftwareattrib "$scratch/$pattern.ppm" -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' \
    -o "$out/$pattern.png"
done
