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
mkdir -p "$corpus"/{bundle,index,lut,manifest,pairs,picture,ply}
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
cp seed-*.json "$corpus/manifest"
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

# Meshes: a tetrahedron in either order of bytes, one with normals and texture coordinates, one as text.
zero='\x00\x00\x00\x00' little='\x00\x00\x80\x3f' big='\x3f\x80\x00\x00'
faces='\x03\x00\x02\x01\x03\x00\x01\x03\x03\x01\x02\x03\x03\x02\x00\x03'
plain=('property float x' 'property float y' 'property float z')
ply() { # FORMAT PROPERTY...
  printf '%s\n' ply "format $1 1.0" 'element vertex 4' "${@:2}" 'element face 4' \
    'property list uchar uchar vertex_indices' end_header
}
# corners ONE TAIL: four points, each followed by TAIL.
# shellcheck disable=SC2059 # escapes for bytes
corners() { printf "$zero$zero$zero$2$1$zero$zero$2$zero$1$zero$2$zero$zero$1$2"; }
# shellcheck disable=SC2059
{
  { ply binary_little_endian "${plain[@]}" && corners "$little" '' && printf "$faces"; } >"$corpus/ply/seed-little"
  { ply binary_big_endian "${plain[@]}" && corners "$big" '' && printf "$faces"; } >"$corpus/ply/seed-big"
  { ply binary_little_endian "${plain[@]}" 'property float '{nx,ny,nz,u,v} &&
    corners "$little" "$zero$zero$little$zero$little" && printf "$faces"; } >"$corpus/ply/seed-normals"
  { ply ascii "${plain[@]}" && printf '%s\n' '0 0 0' '1 0 0' '0 1 0' '0 0 1' '3 0 2 1' '3 0 1 3' '3 1 2 3' '3 2 0 3'; } \
    >"$corpus/ply/seed-text"
}

# Bundles, as fuzz_bundle.c reads them. Jitter keeps what lies before its texels.
for name in short long; do
  for file in exemplars guides luts params jitter; do
    size=$(stat -c %s "$name/$file.ktx2") own=$size
    [ $file != jitter ] || own=$((size - 256 * 256 * 2))
    number 2 "$own"
    number 3 $((size - own))
    head -c "$own" "$name/$file.ktx2"
  done >"$corpus/bundle/seed-$name"
  # The frame: all there is to it, covered.
  printf '\x0f\x80\xff\xff\x80\x70\xe0\xff\x41\x92\xc0\x01\xc3' >>"$corpus/bundle/seed-$name"
done

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
