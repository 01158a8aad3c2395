#!/usr/bin/env bash
# What helps flat surfaces, where a guide is the same everywhere and a style repeats one patch: `scatter` in a style's
# params, `guide scene --frame ray`, and both, in a room of walls. CSV, and a picture of four of them.
# Usage: flat.sh STYLUT WORK CSV_FOLDER PICTURE_FOLDER
set -euo pipefail
stylut=$(realpath "$1")
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$2" "$3" "$4"
csv=$(realpath "$3")/flat.csv
pictures=$(realpath "$4")
cd "$2"
export LC_ALL=C # a point, whatever the language
scatters=(0 6 12 24 48)

{
  printf '{ "schema": "stylut-bundle/1", "styles": ['
  for scatter in "${scatters[@]}"; do
    [ "$scatter" = 0 ] || printf ','
    printf '{ "name": "%s", "exemplar": "%s/spheres/oil.png", "params": { "scatter": %s } }' "$scatter" "$here" "$scatter"
  done
  printf '] }\n'
} >styles.json
"$stylut" pack styles.json --allow-outside -q -o bundle

# number KEY FILE: of what --measure wrote for all frames.
number() { sed -n '/^  "overall"/,$ s/^ *"'"$1"'": \([-+.e0-9]*\).*/\1/p' "$2"; }

echo 'frame,scatter,flat,repetition,shown,chunk_weighted,fallback' >flat.csv
for frame in camera ray; do
  "$stylut" guide scene "$here/box/box.json" --frame $frame -s 640 -c normal,depth,object -q -o $frame.exr
  for scatter in "${scatters[@]}"; do
    made=$frame.$scatter
    "$stylut" stylize bundle --style "$scatter" --guide $frame.exr --measure "$made.json" -q -o "$made.png"
    printf '%s,%s' "$frame" "$scatter"
    for key in flat repetition shown chunk_weighted fallback; do printf ',%s' "$(number $key "$made.json")"; done
    echo
  done
done >>flat.csv
"$stylut" stylize bundle --style 0 --guide camera.exr --flat flat.png -q -o flat.0.png

# Five bits a colour keep pictures of paint small.
for made in camera.0 camera.24 ray.0 ray.24; do
  oiiotool "$made.png" --ch R,G,B --cut 384x384+120+120 --origin +0+0 --mulc 0.121569 -d uint8 -o "$made.tif"
done
oiiotool --nosoftwareattrib camera.0.tif camera.24.tif ray.0.tif ray.24.tif --mosaic:pad=8 2x2 --mulc 8.225806 \
  --clamp:max=1 -d uint8 --compression zip:9 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' \
  -o "$pictures/flat.png"
cp flat.csv "$csv"
column -s, -t flat.csv
