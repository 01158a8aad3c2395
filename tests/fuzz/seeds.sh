#!/usr/bin/env bash
# Makes the seed-* files of the corpus: small things that our own tool writes, a
# few of them turned into other formats by oiiotool.
# Usage: seeds.sh STYLUT. Files are listed in no other place: what a crash left
# behind has another name and stays.
set -euo pipefail
stylut=$(realpath "$1")
corpus=$(cd "$(dirname "$0")" && pwd)/corpus
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir -p "$corpus"/{bundle,index,lut,manifest,pairs,picture,pivots,ply,scene}
rm -f "$corpus"/*/seed-*

# number BYTES VALUE: little-endian
number() {
  local value=$2 i
  for ((i = 0; i < $1; i++, value >>= 8)); do
    # shellcheck disable=SC2059 # an escape for the byte is made first
    printf "\\x$(printf %02x $((value & 255)))"
  done
}

"$stylut" guide sphere -q -s 8 -o sphere.exr
"$stylut" guide sphere -q -s 8 -o sphere.png

# Manifests, and the indices of what they make.
cat >seed-short.json <<'END'
{ "schema": "stylut-bundle/1", "styles": [ { "name": "a", "exemplar": "sphere.png", "lut": { "size": 8 } } ] }
END
cat >seed-long.json <<'END'
{ "schema": "stylut-bundle/1",
  "styles": [ { "name": "first", "exemplar": "sphere.png", "guide": "sphere",
                "lut": { "size": 8, "engine": "brute", "resolve": "nearest", "sampling": "centre" },
                "params": { "threshold": 100, "top_level": 3, "radius": 2, "depth_tolerance": 0.25 } },
              { "name": "s\u00e9cond", "exemplar": "sphere.png", "guide": "sphere.exr",
                "lut": { "file": "table.exr", "sampling": "centre" } },
              { "name": "third", "exemplar": "sphere.png", "lut": "table.exr" } ],
  "jitter": "jitter.png" }
END
cat >seed-all.json <<'END'
{ "schema": "stylut-bundle/1",
  "styles": [ { "name": "lit", "base": 2.5, "guide": "scene.json",
                "exemplars": [ { "image": "a.png", "luma": 0.2 }, { "image": "b.png", "luma": 1 } ],
                "lut": { "budget": { "mean": 1, "p99": 2.5, "max": 30 }, "engine": "brute" },
                "params": { "threshold": 24, "top_level": 6, "radius": 1, "depth_tolerance": 0, "luma_weight": 0.25,
                            "colour_weight": 0.5, "jitter_amount": 1, "jitter_period": 2, "scale": 0.5,
                            "objects": true, "scatter": 6 } },
              { "name": "served", "exemplar": "a.png",
                "lut": { "resolve": "both", "frames": [ "f.exr", "g.exr" ], "slack": 1.5 } } ],
  "jitter": [ "one.png", "two.png" ] }
END
cp seed-*.json "$corpus/manifest"
rm seed-all.json
"$stylut" lut -q sphere.exr -s 8 -o table.exr
sed -i '/"jitter"/d; s/ } \],$/ } ] }/' seed-long.json
for name in short long; do
  "$stylut" pack -q "seed-$name.json" -o "$name"
  cp "$name/bundle.json" "$corpus/index/seed-$name.json"
done

# Point pairs.
cat >"$corpus/pairs/seed-short.json" <<'END'
{ "schema": "stylut-pairs/1", "pairs": [ { "from": [1, 2], "to": [3, 1] } ] }
END
cat >"$corpus/pairs/seed-long.json" <<'END'
{ "schema": "stylut-pairs/1", "kind": "affine", "alpha": 2.5, "units": "normalized",
  "pairs": [ { "from": [0, 0], "to": [0.1, 0.2] }, { "to": [1e-1, 1], "from": [0, 1] },
             { "from": [1, 0], "to": [0.9, 0.1] }, { "from": [0.5, 0.5], "to": [0.4, 6e-1] } ] }
END

# Pivots: of every frame, of each, and as guides have them.
cat >"$corpus/pivots/seed-all.json" <<'END'
{ "schema": "stylut-pivots/1", "pivots": { "1": [512.25, -300.5], "2": [1e3, 40] } }
END
cat >"$corpus/pivots/seed-each.json" <<'END'
{ "schema": "stylut-pivots/1", "frames": { "1": { "1": [512.25, 300.5] }, "20": { "1": [513.5, 300.5], "3": [0, 0] } } }
END
printf '1 512.25 300.5; 2 17 -40.125' >"$corpus/pivots/seed-attribute.txt"

# Scenes, beside the mesh and the texture that fuzz_scene.c puts there.
cat >"$corpus/scene/seed-short.json" <<'END'
{ "schema": "stylut-scene/1", "spheres": [ {} ] }
END
cat >"$corpus/scene/seed-long.json" <<'END'
{ "schema": "stylut-scene/1",
  "camera": { "type": "perspective", "position": [1, 2, 6], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 50 },
  "objects": [ { "mesh": "m.off", "transform": [1,0,0,-2, 0,1,0,0.5, 0,0,-1,0, 0,0,0,1], "style": 3,
                 "color": [0.8, 0.3, 0.2], "specular": 0.5, "shininess": 20 }, { "mesh": "m.off" } ],
  "spheres": [ { "center": [2, 0, 0], "radius": 0.7, "style": 255, "color": [1, 1, 0], "texture": "t.ppm" } ],
  "lights": [ { "type": "directional", "direction": [-1, -1, -1], "intensity": 2, "color": [1, 1, 0.5] },
              { "type": "point", "position": [0, 5, 0] } ],
  "ambient": 0.2, "shadows": false }
END
cat >"$corpus/scene/seed-fit.json" <<'END'
{ "schema": "stylut-scene/1", "camera": { "type": "fit", "view": "30,-20", "up": [0, 0, 1], "fov": 35 },
  "spheres": [ { "center": [1e8, 0, 0], "radius": 3 }, { "center": [1e8, 2, 0], "radius": 1e-3 } ], "lights": [] }
END
cat >"$corpus/scene/seed-above.json" <<'END'
{ "schema": "stylut-scene/1",
  "camera": { "type": "orthographic", "position": [0, 9, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 1e-3 },
  "spheres": [ { "texture": "t.ppm" } ], "shadows": true }
END

# Meshes: one tetrahedron in all encodings.
points=('0 0 0' '1 0 0' '0 1 0' '0 0 1') faces=('0 2 1' '0 1 3' '0 3 2' '1 2 3')
header() { # FORMAT TYPE-OF-COUNTS
  printf '%s\n' ply "format $1 1.0" 'comment four' 'element vertex 4' 'property float x' 'property float y' \
    'property float z' 'element face 4' "property list $2 int vertex_indices" end_header
}
{ header ascii uchar && printf '%s\n' "${points[@]}" "${faces[@]/#/3 }"; } >"$corpus/ply/seed-ascii.ply"
# 1.0 is 0x3f800000; number writes lowest bytes first, so that for the other order they are swapped here.
for order in little big; do
  one=0x3f800000 three=3 shift=0
  [ $order = little ] || one=0x803f three=0x300 shift=24
  {
    header binary_${order}_endian ushort
    for point in "${points[@]}"; do for word in $point; do number 4 $((word * one)); done; done
    for face in "${faces[@]}"; do
      number 2 $three
      for word in $face; do number 4 $((word << shift)); done
    done
  } >"$corpus/ply/seed-$order.ply"
done
# With normals along the points, and texture coordinates.
{
  header binary_little_endian ushort | sed '/^element face/i property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v'
  for point in "${points[@]}"; do for word in $point $point ${point% *}; do number 4 $((word * 0x3f800000)); done; done
  for face in "${faces[@]}"; do
    number 2 3
    for word in $face; do number 4 "$word"; done
  done
} >"$corpus/ply/seed-normals.ply"

# What no manifest asks for, in the first style of three: rows of parameters end the file.
# put FOLDER ROW COMPONENT BYTES: a float, lowest byte first
put() {
  local size
  size=$(stat -c %s "$1/params.ktx2")
  # shellcheck disable=SC2059 # the bytes are escapes
  printf "$4" | dd of="$1/params.ktx2" bs=1 seek=$((size - 5 * 3 * 16 + 3 * 16 * $2 + 4 * $3)) conv=notrunc status=none
}
for name in light base; do
  cp -r long $name
  put $name 1 0 '\xcd\xcc\xcc\x3d' # luminance weight 0.1
  put $name 1 1 '\0\0\0\x3f'       # colour weight 0.5
  put $name 2 1 '\0\0\x80\x3f'     # luminance of the second lighting 1
  put $name 3 0 '\0\0\x40\x3f'     # jitter amount 0.75
  put $name 3 1 '\0\0\0\x40'       # jitter period 2
  put $name 4 0 '\0\0\xe0\x40'     # scatter 7
done
put light 1 3 '\0\0\x40\x40' # three lightings
put light 3 2 '\0\0\0\x40'   # scale 2
put base 3 2 '\0\0\0\x3f'    # scale 0.5
put base 3 3 '\0\0\xc0\x40'  # objects and a base

# Bundles, as fuzz_bundle.c reads them. Jitter keeps what lies before its texels.
for name in short long light base; do
  for file in exemplars guides luts params jitter; do
    size=$(stat -c %s "$name/$file.ktx2") own=$size
    [ $file != jitter ] || own=$((size - 256 * 256 * 2))
    number 2 "$own"
    number 3 $((size - own))
    head -c "$own" "$name/$file.ktx2"
  done >"$corpus/bundle/seed-$name"
done
# The frame: what it has, then all there is to it, covered.
for name in short long; do printf '\x0f\x80\xff\xff\x80\x70\xe0\xff\x41\x92\xc0\x01\xc3' >>"$corpus/bundle/seed-$name"; done
printf '\xf7\x0c\xff\xff\x80\x70\xe0\xff\x41\x92\xc0\x01\xc3' >>"$corpus/bundle/seed-light"
printf '\xfe\x16\xff\xff\x80\x70\xe0\xff\x41\x92\xc0\x01\xc3' >>"$corpus/bundle/seed-base"

# Tables as files, and a guide.
cp sphere.exr "$corpus/picture/seed-guide.exr"
for ending in tif tga hdr jpg; do oiiotool -q sphere.png --ch R,G,B -o "$corpus/picture/seed-guide.$ending"; done
oiiotool -q sphere.exr --tile 16 16 -o "$corpus/picture/seed-tiles.exr"
# A file of the first program that is imported from; which one is tried goes by the size.
blender=$corpus/picture/seed-blender.exr
oiiotool -q sphere.exr --ch normal.X,normal.Y,normal.Z,depth.Z \
  --chnames a.Normal.X,a.Normal.Y,a.Normal.Z,a.Depth.Z -d half -o "$blender"
while (($(stat -c %s "$blender") % 6)); do number 1 0 >>"$blender"; done
"$stylut" lut -q --no-history sphere.exr -s 4 -o "$corpus/picture/seed-f32.exr"
for encoding in rg16 rg8x2 rg8; do
  "$stylut" lut -q --no-history sphere.exr -s 4 --encoding $encoding -o "$corpus/picture/seed-$encoding.png"
done

# Tables as fuzz_lut.c builds them: hints; width, height, precision, channels;
# how many attributes, and each one's name and value by number; values.
cd "$corpus/lut"
printf '\x20\x01\x07\x01\x02\x00\x02\x06\x00\x00\x01\x01\x02\x05\x03\x08\x04\x0b\x05\x0cSome values.' >seed-f32
printf '\x00\x01\x05\x01\x01\x01\x02\x02\x02\x06\x03\x09The quick brown fox jumps' >seed-rg16
printf '\x00\x01\x08\x01\x00\x01\x03\x03\x01\x03\x02\x05\x05\x0cover the lazy dog' >seed-rg8x2
printf '\x00\x01\x08\x01\x00\x01\x02\x02\x01\x04\x02\x0d, which says nothing' >seed-rg8
printf '\x20\x01\x02\x03\x02\x00\x02\x05\x00\x00\x01\x01\x02\x05\x06\x10\x07\x12Several slices' >seed-cube
printf '\x01\x40\x07\x08\x00\x01\x02\x00but goes on sleeping.' >seed-unity
