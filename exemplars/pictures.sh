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
  oiiotool --nosoftwareattrib --no-autopremult "$1" --ch R,G,B,A --resize "$3x$height" --premult --create "$3x$height" 3 \
    --fill:color=1,1,1 "$3x$height" --ch R,G,B,A=1 --over --ch R,G,B -d uint8 --eraseattrib '.*' \
    --attrib DateTime '2000:01:01 00:00:00' -o "$2"
}

on_paper "$demo/oil.png" "$out/oil.png" 450
on_paper "$demo/oil.chunks.png" "$out/chunks.png" 450
oiiotool --nosoftwareattrib "$demo/frame.exr" --ch normal.X,normal.Y,normal.Z,A --mulc 0.5,0.5,0.5,1 --addc 0.5,0.5,0.5,0 \
  --chnames R,G,B,A -o "$out/normals.tif"
on_paper "$out/normals.tif" "$out/guide.png" 450
rm "$out/normals.tif"
oiiotool --nosoftwareattrib "$demo/oil.lut.exr" --ch u,v,error --chnames R,G,B --mulc 1,1,4 -d uint8 --eraseattrib '.*' \
  --attrib DateTime '2000:01:01 00:00:00' -o "$out/lut.png"
"$stylut" match "$demo/oil.guide.exr" "$demo/frame.exr" -o "$demo/field.exr" -q
oiiotool --nosoftwareattrib "$demo/field.exr" --ch u,v,error,A --chnames R,G,B,A --mulc 1,1,4,1 -o "$out/field.tif"
on_paper "$out/field.tif" "$out/match.png" 450
rm "$out/field.tif"
oiiotool --nosoftwareattrib "$demo/contact.png" --resize 50% -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/contact.png"

# What blending does, as a heat map: the borders between the pieces.
printf '{"schema": "stylut-bundle/1", "styles": [{"name": "oil", "exemplar": "%s", "params": {"radius": 0}}]}' \
  "$(realpath "$(dirname "$0")/spheres/oil.png")" >"$demo/sharp.json"
"$stylut" pack "$demo/sharp.json" --allow-outside -o "$demo/sharp" -q
"$stylut" stylize "$demo/sharp" --guide "$demo/frame.exr" -o "$demo/sharp.png" -q
"$stylut" compare "$demo/oil.png" "$demo/sharp.png" --failpercent 100 -o "$demo/heat.png" -q
oiiotool --nosoftwareattrib "$demo/heat.png" --resize 450x512 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/heat.png"

# A lit room by the ways that its light came.
"$stylut" guide scene "$(dirname "$0")/box/box.json" -s 180 -c paths --spp 512 -q -o "$demo/box.exr"
for name in full LDE LSE LD12E LIE; do
  oiiotool --nosoftwareattrib "$demo/box.exr" --ch "$name.R,$name.G,$name.B" --chnames R,G,B --colorconvert linear sRGB -d uint8 -o "$demo/box.$name.png"
done
oiiotool --nosoftwareattrib "$demo"/box.{full,LDE,LSE,LD12E,LIE}.png --mosaic 5x1 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/paths.png"

# Things in the light: their colours, how light they are, their outlines.
"$stylut" guide scene "$(dirname "$0")/lit/lit.json" -s 300x267 -c albedo,luma,contour -q -o "$demo/lit.exr"
oiiotool --nosoftwareattrib "$demo/lit.exr" --ch albedo.R,albedo.G,albedo.B --chnames R,G,B --colorconvert linear sRGB -d uint8 \
  -o "$demo/lit.albedo.png" "$demo/lit.exr" --ch luma.Y,luma.Y,luma.Y --chnames R,G,B --colorconvert linear sRGB -d uint8 \
  -o "$demo/lit.luma.png" "$demo/lit.exr" --ch contour.Y,contour.Y,contour.Y --chnames R,G,B --mulc -1 --addc 1 -d uint8 -o "$demo/lit.contour.png"
oiiotool --nosoftwareattrib "$demo"/lit.{albedo,luma,contour}.png --mosaic 3x1 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/lit.png"

# The same in steps of light, plain and hatched; their lines alone, and a hand's on the hatching.
"$stylut" guide scene "$(dirname "$0")/lit/lit.json" -s 450x400 -c normal,depth,object,albedo,luma -q -o "$demo/room.exr"
"$stylut" toon --guide "$demo/room.exr" -q -o "$demo/room.1.png"
"$stylut" toon --guide "$demo/room.exr" --texture hatch --strength 0.3 -q -o "$demo/room.2.png"
"$stylut" outline --guide "$demo/room.exr" -q -o "$demo/room.3.png"
"$stylut" outline --guide "$demo/room.exr" --over "$demo/room.2.png" --width 2.5 --wobble 2.5 -q -o "$demo/room.4.png"
for k in 1 2 3 4; do
  oiiotool --nosoftwareattrib --no-autopremult "$demo/room.$k.png" --premult --create 450x400 3 --fill:color=1,1,1 450x400 \
    --ch R,G,B,A=1 --over --ch R,G,B -d uint8 -o "$demo/room.$k.tif"
done
for name in toon:1:2 outline:3:4; do
  IFS=: read -r name left right <<<"$name"
  oiiotool --nosoftwareattrib "$demo/room.$left.tif" "$demo/room.$right.tif" --mosaic 2x1 -d uint8 --eraseattrib '.*' \
    --attrib DateTime '2000:01:01 00:00:00' -o "$out/$name.png"
done

# What a painter would go by, 8x8 pixels at a time: colour, detail (dark), and lines by twice their angle.
"$stylut" guide strokes "$demo/oil.png" --level 3 --space srgb -c all -q -o "$demo/strokes.exr"
oiiotool --nosoftwareattrib "$demo/strokes.exr" --ch color.R,color.G,color.B,A --chnames R,G,B,A -o "$demo/strokes.1.tif" \
  "$demo/strokes.exr" --ch detail.Y,detail.Y,detail.Y,A --mulc -5,-5,-5,1 --addc 1,1,1,0 --chnames R,G,B,A -o "$demo/strokes.2.tif" \
  "$demo/strokes.exr" --ch line.X,line.Y,B=0.5,A --mulc 0.5,0.5,1,1 --addc 0.5,0.5,0,0 --chnames R,G,B,A -o "$demo/strokes.3.tif"
for k in 1 2 3; do on_paper "$demo/strokes.$k.tif" "$demo/strokes.$k.png" 300; done
oiiotool --nosoftwareattrib "$demo"/strokes.[123].png --mosaic 3x1 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/strokes.png"

# The creature bent by pairs of points: as it is, and by each kind.
# A pixel's texture coordinate is that of its centre and what the field adds; the rim mixes with what is beyond it.
bend() { # KIND
  local field=$demo/warp.$1.exr
  "$stylut" guide warp "$(dirname "$0")/warp.json" -s 450x512 --kind "$1" -q -o "$field"
  oiiotool --nosoftwareattrib "$out/oil.png" --ch R,G,B "$field" --ch motion.U,motion.V --mulc 0.002222222,0.001953125 \
    --pattern fill:topleft=0.001111111,0.000976563:topright=0.998888889,0.000976563:bottomleft=0.001111111,0.999023438:bottomright=0.998888889,0.999023438 \
    450x512 2 --add --st_warp "$field" --ch A,A,A --erode 3x3 --mul "$field" --ch A,A,A --erode 3x3 --mulc -1 --addc 1 --add --resize 300x341 -d uint8 \
    -o "$demo/warp.$1.png"
}
for kind in affine similarity rigid; do bend $kind; done
oiiotool --nosoftwareattrib "$demo"/warp.{affine,similarity,rigid}.png --mosaic 3x1 -d uint8 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00' -o "$out/warp.png"

# The report on the creature as its own exemplar, as a browser shows it: few
# texels and six bits a colour keep the picture small.
here=$(dirname "$0")
"$stylut" guide scene "$here/creature.ply" -s 512 -q -o "$demo/creature.png"
"$stylut" lut "$demo/creature.png" -s 64 -q -o "$demo/creature.lut.exr"
"$stylut" report "$demo/creature.lut.exr" --guide "$demo/creature.png" -q -o "$demo/creature.html"
node "$here/../tests/cli/browse.mjs" "$demo/creature.html#map=spread&overlay=alike&texel=32,24" --size 1240x1460 \
  --shot "$out/page.png" >/dev/null
oiiotool --nosoftwareattrib "$out/page.png" --ch R,G,B --mulc 0.2471 -d uint8 -o "$out/page.tif"
oiiotool --nosoftwareattrib "$out/page.tif" --mulc 4.0476 --clamp:max=1 -d uint8 --compression zip:9 --eraseattrib '.*' \
  --attrib DateTime '2000:01:01 00:00:00' -o "$out/report.png"
rm "$out/page.png" "$out/page.tif"
