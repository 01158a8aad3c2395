#!/usr/bin/env bash
# The README's pictures, made from the demo's. Usage: pictures.sh DEMO FOLDER STYLUT
set -euo pipefail
demo=$1
out=$2
stylut=$3
mkdir -p "$out"

# on_paper IN OUT WIDTH: over white, scaled to WIDTH, without metadata.
on_paper() {
  local height=$(($3 * 1024 / 900))
  oiiotool --no-autopremult "$1" --ch R,G,B,A --resize "$3x$height" --premult --create "$3x$height" 3 \
    --fill:color=1,1,1 "$3x$height" --ch R,G,B,A=1 --over --ch R,G,B -d uint8 --eraseattrib '.*' \
    --attrib DateTime '2000:01:01 00:00:00' -o "$2"
}

on_paper "$demo/oil.png" "$out/oil.png" 450
on_paper "$demo/oil.chunks.png" "$out/chunks.png" 450
oiiotool "$demo/frame.exr" --ch normal.X,normal.Y,normal.Z,A --mulc 0.5,0.5,0.5,1 --addc 0.5,0.5,0.5,0 \
  --chnames R,G,B,A -o "$out/normals.tif"
on_paper "$out/normals.tif" "$out/guide.png" 450
rm "$out/normals.tif"
oiiotool "$demo/oil.lut.exr" --ch u,v,error --chnames R,G,B --mulc 1,1,4 -d uint8 --eraseattrib '.*' \
  --attrib DateTime '2000:01:01 00:00:00' -o "$out/lut.png"
"$stylut" match "$demo/oil.guide.exr" "$demo/frame.exr" -o "$demo/field.exr" -q
oiiotool "$demo/field.exr" --ch u,v,error,A --chnames R,G,B,A --mulc 1,1,4,1 -o "$out/field.tif"
on_paper "$out/field.tif" "$out/match.png" 450
rm "$out/field.tif"
oiiotool "$demo/contact.png" --resize 50% -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/contact.png"

# What blending does, as a heat map: the borders between the pieces.
printf '{"schema": "stylut-bundle/1", "styles": [{"name": "oil", "exemplar": "%s", "params": {"radius": 0}}]}' \
  "$(realpath "$(dirname "$0")/spheres/oil.png")" >"$demo/sharp.json"
"$stylut" pack "$demo/sharp.json" -o "$demo/sharp" -q
"$stylut" stylize "$demo/sharp" --guide "$demo/frame.exr" -o "$demo/sharp.png" -q
"$stylut" compare "$demo/oil.png" "$demo/sharp.png" --failpercent 100 -o "$demo/heat.png" -q
oiiotool "$demo/heat.png" --resize 450x512 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/heat.png"

# The report on the creature as its own exemplar, as a browser shows it: few
# texels and six bits a colour keep the picture small.
here=$(dirname "$0")
"$stylut" guide scene "$here/creature.ply" -s 512 -q -o "$demo/creature.png"
"$stylut" lut "$demo/creature.png" -s 64 -q -o "$demo/creature.lut.exr"
"$stylut" report "$demo/creature.lut.exr" --guide "$demo/creature.png" -q -o "$demo/creature.html"
node "$here/../tests/cli/browse.mjs" "$demo/creature.html#map=spread&overlay=alike&texel=32,24" --size 1240x1460 \
  --shot "$out/page.png" >/dev/null
oiiotool "$out/page.png" --ch R,G,B --mulc 0.2471 -d uint8 -o "$out/page.tif"
oiiotool "$out/page.tif" --mulc 4.0476 --clamp:max=1 -d uint8 --compression zip:9 --eraseattrib '.*' \
  --attrib DateTime '2000:01:01 00:00:00' -o "$out/report.png"
rm "$out/page.png" "$out/page.tif"
