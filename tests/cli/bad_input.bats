#!/usr/bin/env bats
# What is refused: every case is a command that passes, broken in one place.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 8 --no-history -q -o guide.exr
  "$STYLUT" guide sphere -s 8 --no-history -q -o guide.png
  "$STYLUT" guide sphere -s 8 --no-history -q --bits 16 -o exemplar.png
  "$STYLUT" guide sphere -s 256 --no-history -q -o jitter.png
  "$STYLUT" lut guide.exr -s 16 --no-history -q -o lut.exr
  "$STYLUT" lut guide.exr -s 16 --no-history -q -o lut.png
  write_manifest
  "$STYLUT" pack manifest.json -q -o bundle
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >mesh.obj
  printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
    'element face 1' 'property list uchar int vertex_indices' end_header '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' >mesh.ply
  printf '%s\n' OFF '3 1 0' '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' >mesh.off
  printf '%s\n' 'solid a' 'facet normal 0 0 1' 'outer loop' 'vertex 0 0 0' 'vertex 1 0 0' 'vertex 0 1 0' endloop \
    endfacet 'endsolid a' >mesh.stl
}

bring() { (cd "$BATS_FILE_TMPDIR" && cp -r "$@" "$BATS_TEST_TMPDIR/work"); }

# edit FILE OLD NEW: replaces a text that must be there, once.
edit() {
  grep -qF -- "$2" "$1" || complain "$1 doesn't hold '$2'"
  OLD=$2 NEW=$3 perl -0pi -e 's/\Q$ENV{OLD}\E/$ENV{NEW}/' "$1"
}

# ---- files ----

# Every role an input can have, with BAD in its place.
swap_every_input() { # CODE BAD-NAME-WITHOUT-ENDING
  local code=$1 bad=$2 ending
  for ending in obj ply off stl; do swap "$code" mesh.$ending "$bad.$ending" guide scene mesh.$ending -s 8 -o out.exr; done
  for ending in exr png; do
    swap "$code" guide.$ending "$bad.$ending" lut guide.$ending -s 8 -o out.exr
    swap "$code" lut.$ending "$bad.$ending" check lut.$ending --guide guide.exr
  done
  swap "$code" guide.exr "$bad.exr" check lut.exr --guide guide.exr
  swap "$code" guide.png "$bad.png" stylize bundle --guide guide.png -o out.png
  swap "$code" manifest.json "$bad.json" pack manifest.json -o out.bundle
  local key name
  for name in exemplar.png guide.exr jitter.png; do
    sed "s/$name/$bad.${name##*.}/" manifest.json >swapped.json
    swap_named "$code" "$bad.${name##*.}" swapped.json
  done
  for ending in exr png; do
    perl -0pe "s/\"lut\": \{.*?\}/\"lut\": \"lut.$ending\"/s" manifest.json >with.json
    sed "s/lut\.$ending/$bad.$ending/" with.json >swapped.json
    accept pack with.json -o out.bundle || return 1
    rm -rf out.bundle
    swap_named "$code" "$bad.$ending" swapped.json
  done
}
swap_named() { refuse "$1" "$2" pack "$3" -o out.bundle; }

@test "a missing file" {
  bring .
  swap_every_input 2 missing
  swap 2 guide.exr missing.exr info guide.exr
  swap 2 bundle missing info bundle
  swap 2 bundle missing validate bundle
  swap 2 bundle missing stylize bundle --guide guide.exr -o out.png
}

@test "a folder in place of a file" {
  bring .
  mkdir folder.{exr,png,obj,ply,off,stl,json}
  swap_every_input 2 folder
  swap 2 guide.exr folder.exr info guide.exr
}

@test "a file or an empty folder in place of a bundle" {
  bring .
  mkdir folder
  local bad
  for bad in guide.exr folder; do
    swap 2 bundle $bad info bundle || true
    swap 2 bundle $bad validate bundle
    swap 2 bundle $bad stylize bundle --guide guide.exr -o out.png
  done
}

@test "an empty file" {
  bring .
  touch empty.{exr,png,obj,ply,off,stl,json}
  swap_every_input 3 empty
  swap 3 guide.exr empty.exr info guide.exr
}

@test "text in place of pictures, meshes and manifests" {
  bring .
  local ending
  for ending in exr png obj ply off stl json; do printf 'the quick brown fox\njumps over the lazy dog\n' >text.$ending; done
  swap_every_input 3 text
  swap 3 guide.exr text.exr info guide.exr
  for ending in gltf glb tif jpg tga hdr; do cp text.png text.$ending; done
  refuse 3 text.gltf guide scene text.gltf -o out.exr
  refuse 3 text.glb guide scene text.glb -o out.exr
  for ending in tif jpg tga hdr; do refuse 3 text.$ending lut text.$ending -o out.exr; done
}

@test "a picture of one kind under the name of another is read for what it is, or refused" {
  bring .
  cp guide.exr really_exr.png
  cp guide.png really_png.exr
  local file
  for file in really_exr.png really_png.exr; do
    if "$STYLUT" lut $file -s 8 -o out.exr >/dev/null 2>&1; then rm out.exr; else refuse 3 $file lut $file -s 8 -o out.exr; fi
  done
}

@test "a mesh with an unknown ending" {
  bring mesh.obj
  cp mesh.obj mesh.xyz
  cp mesh.obj mesh
  swap 3 mesh.obj mesh.xyz guide scene mesh.obj -s 8 -o out.exr
  refuse 3 mesh guide scene mesh -s 8 -o out.exr
}

# ---- truncation ----

# cut_everywhere FILE COMMAND...: FILE named cut.* in the command, cut every 64
# bytes and near its end, is refused; where only the end mark is gone and all
# pixels are there, the outcome may also be the whole file's.
cut_everywhere() {
  local file=$1 size length cut
  shift
  size=$(stat -c %s "$file")
  cut=cut.${file##*.}
  cp "$file" "$cut"
  accept "$@" || return 1
  [ ! -e out.exr ] || mv out.exr whole.exr
  rm -rf out.*
  for length in $(seq 0 64 $((size - 1))) 1 7 8 33 $((size - 13)) $((size - 20)) $((size - 2)); do
    head -c "$length" "$file" >"$cut"
    refuse 3 "$cut" "$@"
  done
}
