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

bring_all() { bring 'guide.*' exemplar.png jitter.png 'lut.*' manifest.json bundle 'mesh.*'; }

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
  local name
  for name in exemplar.png guide.exr jitter.png; do
    sed "s/$name/$bad.${name##*.}/" manifest.json >swapped.json
    swap_named "$code" "$bad.${name##*.}" swapped.json
  done
  for ending in exr png; do
    perl -0pe "s/\"lut\": \{.*?\}/\"lut\": \"lut.$ending\"/s" manifest.json >with.json
    sed "s/lut\.$ending/$bad.$ending/" with.json >swapped.json
    prove pack with.json -o out.bundle || return 1
    swap_named "$code" "$bad.$ending" swapped.json
  done
}
swap_named() { beside refuse "$1" "$2" pack "$3" -o out.bundle; }

@test "a missing file" {
  bring_all
  swap_every_input 2 missing
  swap 2 guide.exr missing.exr info guide.exr
  swap 2 bundle missing info bundle
  swap 2 bundle missing validate bundle
  swap 2 bundle missing stylize bundle --guide guide.exr -o out.png
}

@test "a folder in place of a file" {
  bring_all
  mkdir folder.{exr,png,obj,ply,off,stl,json}
  swap_every_input 2 folder
  swap 2 guide.exr folder.exr info guide.exr
}

@test "a file or an empty folder in place of a bundle" {
  bring_all
  mkdir folder
  local bad
  for bad in guide.exr folder; do
    [ $bad = guide.exr ] || swap 2 bundle $bad info bundle
    swap 2 bundle $bad validate bundle
    swap 2 bundle $bad stylize bundle --guide guide.exr -o out.png
  done
}

@test "an empty file" {
  bring_all
  touch empty.{exr,png,obj,ply,off,stl,json}
  swap_every_input 3 empty
  swap 3 guide.exr empty.exr info guide.exr
}

@test "text in place of pictures, meshes and manifests" {
  bring_all
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
  bring_all
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

# cut_everywhere FILE END COMMAND...: FILE, which the command calls cut.*, is cut
# every 64 bytes and around its end; END bytes are an end mark behind all pixels.
cut_everywhere() {
  local file=$1 end=$2 size length cut
  shift 2
  size=$(stat -c %s "$file")
  cut=cut.${file##*.}
  cp "$file" "$cut"
  prove "$@" || return 1
  for length in $(seq 0 64 $((size - end - 1))) 1 8 33 $((size - end - 5)) $((size - end - 1)); do
    head -c "$length" "$file" >"$cut"
    beside refuse 3 "$cut" "$@"
  done
  wait
}

@test "a truncated EXR guide" {
  bring_all
  cut_everywhere guide.exr 0 lut cut.exr -s 8 -o out.exr
}

@test "a truncated PNG guide" {
  bring_all
  cut_everywhere guide.png 12 lut cut.png -s 8 -o out.exr
}

@test "a truncated exemplar" {
  bring_all
  sed 's/exemplar\.png/cut.png/' manifest.json >cut.json
  cut_everywhere exemplar.png 12 pack cut.json -o out.bundle
}

@test "a truncated EXR table" {
  bring_all
  cut_everywhere lut.exr 0 check cut.exr --guide guide.exr
}

@test "a truncated PNG table" {
  bring_all
  cut_everywhere lut.png 12 check cut.png --guide guide.exr
}

@test "a PNG without its end mark is refused, or read as the whole picture it is" {
  bring guide.png
  accept lut guide.png -s 8 --no-history -o whole.exr
  local size lost
  size=$(stat -c %s guide.png)
  for lost in 1 5 8 12; do
    head -c $((size - lost)) guide.png >cut.png
    if "$STYLUT" lut cut.png -s 8 --no-history -o out.exr >/dev/null 2>&1; then
      expect_same out.exr whole.exr
      rm out.exr
    else
      refuse 3 cut.png lut cut.png -s 8 --no-history -o out.exr
    fi
  done
}

@test "truncated meshes" {
  local size length
  head -c 100000 "$exemplars/creature.ply" >cut.ply
  size=$(stat -c %s "$exemplars/creature.ply")
  prove guide scene "$exemplars/creature.ply" -s 8 -o out.exr
  for length in 0 1 3 64 128 200 300 320 1000 100000 400000 $((size - 13)) $((size - 1)); do
    head -c "$length" "$exemplars/creature.ply" >cut.ply
    refuse 3 cut.ply guide scene cut.ply -s 8 -o out.exr
  done
}

# ---- meshes ----

@test "meshes without faces" {
  bring 'mesh.*'
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' >bad.obj
  sed -e 's/^element face 1/element face 0/' -e '$d' mesh.ply >bad.ply
  sed -e 's/^3 1 0/3 0 0/' -e '$d' mesh.off >bad.off
  printf 'solid a\nendsolid a\n' >bad.stl
  swap_every_mesh
}
swap_every_mesh() { # [NAMED]: mesh.* for bad.*
  local ending
  for ending in obj ply off stl; do
    [ ! -e bad.$ending ] || swap 3 mesh.$ending bad.$ending guide scene mesh.$ending -s 8 -o out.exr
  done
}

@test "meshes with a coordinate that is no number" {
  bring 'mesh.*'
  local value ending
  for value in nan -nan inf -inf 1e39; do
    for ending in obj ply off stl; do
      sed "s/1 0 0$/$value 0 0/" mesh.$ending >bad.$ending
      ! cmp -s mesh.$ending bad.$ending
    done
    swap_every_mesh
  done
}

@test "meshes with a vertex index out of range" {
  bring 'mesh.*'
  local index
  for index in 4 0 -4 2147483648; do
    sed "s/^f 1 2 3/f 1 2 $index/" mesh.obj >bad.obj
    swap_every_mesh
  done
  rm bad.obj
  for index in 3 -1 2147483647 4294967295; do
    sed "s/^3 0 1 2/3 0 1 $index/" mesh.ply >bad.ply
    sed "s/^3 0 1 2/3 0 1 $index/" mesh.off >bad.off
    swap_every_mesh
  done
}

@test "meshes whose faces have no area" {
  bring 'mesh.*'
  sed 's/^v 0 1 0/v 2 0 0/' mesh.obj >bad.obj
  sed 's/^0 1 0/2 0 0/' mesh.ply >bad.ply
  sed 's/^0 1 0/2 0 0/' mesh.off >bad.off
  sed 's/vertex 0 1 0/vertex 2 0 0/' mesh.stl >bad.stl
  swap_every_mesh
  sed 's/^f 1 2 3/f 1 1 1/' mesh.obj >bad.obj
  sed 's/^3 0 1 2/3 0 1 1/' mesh.ply >bad.ply
  sed 's/^3 0 1 2/3 1 1 1/' mesh.off >bad.off
  rm bad.stl
  swap_every_mesh
}

# ---- guides ----

# A guide nothing is in: a bigger sphere guide's corner.
make_empty_guide() {
  oiiotool guide64.exr --cut 4x4+0+0 -o empty.exr
  oiiotool --no-autopremult guide64.png --cut 4x4+0+0 -o empty.png
}

@test "a guide without a covered pixel: no table, an empty picture" {
  bring_all
  accept guide sphere -s 64 -o guide64.exr
  accept guide sphere -s 64 -o guide64.png
  make_empty_guide
  local ending
  for ending in exr png; do
    swap 3 guide.$ending empty.$ending lut guide.$ending -s 8 -o out.exr
    accept_warned "empty.$ending: found no covered pixel" stylize bundle --guide empty.$ending -o out.png --nnf out.nnf.png --chunks out.chunks.png --format json
    expect covered "$(json - r.covered <<<"$output")" 0
    expect pixels "$(dump out.png R,G,B,A 255 | cut -d' ' -f3- | sort -u)" '0 0 0 0'
    expect 'covered in the field' "$(dump out.nnf.png A 255 | cut -d' ' -f3- | sort -u)" 0
  done
  rm out.*
  sed -e 's/guide\.exr/empty.exr/' manifest.json >bad.json
  oiiotool --no-autopremult exemplar.png --cut 4x4+0+0 -o exemplar.png
  refuse 3 empty.exr pack bad.json -o out.bundle
}

@test "a guide of one pixel works" {
  accept guide sphere -s 1 -o one.exr
  accept guide sphere -s 1 -o one.png
  accept lut one.exr -s 16 -o lut.exr
  accept check lut.exr --guide one.exr --min-coverage 0 --format json
  expect background "$(json - r.background <<<"$output")" 0
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "one.png"}]}' >manifest.json
  accept pack manifest.json -o bundle
  accept validate bundle
  accept stylize bundle --guide one.exr -o out.png
  expect pixel "$(dump out.png R,G,B,A 255)" "$(dump one.png R,G,B,A 255)"
}

@test "a guide with a value that is no number names its pixel" {
  bring_all
  local value
  oiiotool guide.exr --ch A --chnames Y -o coverage.exr
  oiiotool --create 8x8 1 --fill:color=0 8x8 --box:color=1:fill=1 3,4,3,4 --ch 0 --mulc 3e38 --mulc 3e38 -d float --dup --sub coverage.exr --add --chnames A -o coverage.exr
  oiiotool guide.exr --ch normal.X,normal.Y,normal.Z coverage.exr --chappend -d float -o holed.exr
  refuse 3 'holed.exr: found A = nan at pixel (3, 4)' lut holed.exr -s 8 -o out.exr
  refuse 3 'holed.exr: found A = nan at pixel (3, 4)' stylize bundle --guide holed.exr -o out.png
  refuse 3 'holed.exr: found A = nan at pixel (3, 4)' match guide.exr holed.exr -o out.exr
  oiiotool guide.exr --ch A,normal.X,normal.Y,normal.Z --chnames R,G,B,A -o parts.exr
  for value in nan inf; do
    oiiotool guide.exr --ch normal.X --chnames Y -o plane.exr
    # The sum with 0/0 or 1/0 in one pixel of a copy.
    oiiotool --create 8x8 1 --fill:color=0 8x8 --box:color=1:fill=1 3,4,3,4 --ch 0 -o mark.exr
    if [ $value = nan ]; then
      oiiotool mark.exr --mulc 3e38 --mulc 3e38 -d float --dup --sub -o odd.exr
    else
      oiiotool mark.exr -d float --mulc 3e38 --mulc 3e38 -o odd.exr
    fi
    oiiotool -i plane.exr -i odd.exr --add --chnames normal.X -i guide.exr --ch A,normal.Y,normal.Z --chappend -d float -o bad.exr
    swap 3 guide.exr bad.exr lut guide.exr -s 8 -o out.exr
    refuse 3 '(3, 4)' lut bad.exr -s 8 -o out.exr
  done
}

@test "a picture without normals" {
  bring_all
  oiiotool guide.exr --ch A,depth.Z -o bad.exr
  swap 3 guide.exr bad.exr lut guide.exr -s 8 -o out.exr
  swap 3 guide.exr bad.exr stylize bundle --guide guide.exr -o out.png
}

@test "a guide and an exemplar of differing sizes: both names, both sizes" {
  bring_all
  prove pack manifest.json -o out.bundle
  accept guide sphere -s 12x10 -o other.exr
  sed 's/guide\.exr/other.exr/' manifest.json >bad.json
  local part
  for part in other.exr exemplar.png 12x10 8x8 first; do beside refuse 3 $part pack bad.json -o out.bundle; done
  wait
}

@test "exemplars of differing sizes: both names, both sizes" {
  bring_all
  accept guide sphere -s 12x10 -o other.png
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "exemplar.png"}, {"name": "b", "exemplar": "%s"}]}' \
    exemplar.png >good.json
  prove pack good.json -o out.bundle
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "exemplar.png"}, {"name": "b", "exemplar": "%s"}]}' \
    other.png >bad.json
  local part
  for part in other.png exemplar.png 12x10 8x8; do beside refuse 3 $part pack bad.json -o out.bundle; done
  wait
}

@test "a table for another guide" {
  bring_all
  accept guide sphere -s 9 -o other.exr
  swap 3 guide.exr other.exr check lut.exr --guide guide.exr
  beside refuse 3 9x9 check lut.exr --guide other.exr
  beside refuse 3 8x8 check lut.exr --guide other.exr
  wait
}

@test "what is hardly a guide, or hardly this guide's table, is warned of" {
  bring_all
  # The same size, another file.
  accept guide sphere -s 8 -c normal -o same.exr
  accept lut guide.exr -s 8 -o own.exr
  accept_warned 'own.exr: found that it was made of another file' check own.exr --guide same.exr
  accept check own.exr --guide guide.exr
  # Without a history nobody can tell.
  accept lut guide.exr -s 8 --no-history -o silent.exr
  accept check silent.exr --guide same.exr
  # In a bundle, too.
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "exemplar.png", "guide": "same.exr", "lut": "own.exr"}]}' >own.json
  accept_warned 'own.exr: found that it was made of another file' pack own.json -o own.bundle
  # A painting's colours, and normals five times too long.
  oiiotool --pattern constant:color=0.95,0.9,0.1 16x16 3 -d uint8 -o painting.png
  accept_warned 'painting.png: found normals of other lengths than 1 in 100 %' lut painting.png -s 8 -o out.exr
  oiiotool guide.exr --ch normal.X,normal.Y,normal.Z --mulc 5 guide.exr --ch A --chappend -d float -o long.exr
  oiiotool guide.exr --ch normal.X,normal.Y,normal.Z --mulc -1 guide.exr --ch A --chappend -d float -o away.exr
  accept_warned 'away.exr: found normals facing away' lut away.exr -s 8 -o out.exr
  accept_warned 'away.exr: found normals facing away' check own.exr --guide guide.exr --frames away.exr
  accept_warned 'long.exr: found normals of other lengths than 1' lut long.exr -s 8 -o out.exr
  accept_warned 'long.exr: found normals of other lengths than 1' match guide.exr long.exr -o out.exr
  # A sphere on opaque white, and one whose z was stored as it is.
  accept guide sphere -s 40 -c normal -o ball.png
  oiiotool --create 40x40 4 --fill:color=1,1,1,1 40x40 -d uint8 -o white.png
  oiiotool ball.png white.png --over -d uint8 -o on_white.png
  oiiotool ball.png --mulc 1,1,2,1 --addc 0,0,-1,0 -d uint8 -o stored.png
  accept_warned 'on_white.png: found normals of other lengths than 1' lut on_white.png -s 8 -o out.exr
  accept_warned 'stored.png: found normals of other lengths than 1' lut stored.png -s 8 -o out.exr
  # Frames that show nothing.
  oiiotool guide.exr --mulc 0 -o nothing.exr
  accept_warned 'nothing.exr: found no covered pixel' stylize bundle --guide nothing.exr -o out.png
  accept_warned 'nothing.exr: found no covered pixel' match guide.exr nothing.exr -o out.exr
}

@test "a table or a field in place of a guide" {
  bring_all
  accept match guide.exr guide.exr --channels normal -o field.png
  beside refuse 3 'stylut:kind = lut' lut lut.png -s 8 -o out.exr
  beside refuse 3 'stylut:kind = lut' lut lut.exr -s 8 -o out.exr
  beside refuse 3 'stylut:kind = field' stylize bundle --guide field.png -o out.png
  wait
}

# ---- outputs ----

# Every command that writes, as 'command... -o OUT'.
each_output() { # FUNCTION ARGUMENT...
  "$@" guide sphere -s 8 -o out.exr
  "$@" guide sphere -s 8 -o out.png
  "$@" guide scene mesh.obj -s 8 -o out.exr
  "$@" lut guide.exr -s 8 -o out.exr
  "$@" lut guide.exr -s 8 -o out.png
  "$@" pack manifest.json -o out.bundle
  "$@" stylize bundle --guide guide.exr -o out.png
  "$@" stylize bundle --guide guide.exr --nnf second.png -o out.png
  "$@" stylize bundle --guide guide.exr --chunks second.png -o out.png
}
# The last argument, or second.png where the command has it, is put in FOLDER.
put_output() { # FOLDER COMMAND...
  local folder=$1 argument last arguments=()
  shift
  last=${!#}
  [[ " $* " != *" second.png "* ]] || last=second.png
  for argument in "$@"; do
    if [ "$argument" = "$last" ]; then arguments+=("$folder/$argument"); else arguments+=("$argument"); fi
  done
  beside refuse 2 "$folder/$last" "${arguments[@]}"
}

@test "an output in a folder that isn't there" {
  bring_all
  each_output beside prove
  wait
  rm -f second.png
  each_output put_output nowhere
  each_output put_output guide.exr
  wait
}

@test "an output in a folder that can't be written to" {
  bring_all
  each_output beside prove
  wait
  rm -f second.png
  local folder=/proc
  mkdir frozen
  if chattr +i frozen 2>/dev/null; then
    folder=$PWD/frozen
  elif [ "$(id -u)" != 0 ]; then
    folder=$PWD/frozen
    chmod a-w frozen
  fi
  each_output put_output "$folder"
  wait
  chattr -i frozen 2>/dev/null || chmod u+w frozen
}

@test "an output whose name is a folder's" {
  bring_all
  mkdir out.exr out.png
  touch out.exr/kept out.png/kept
  refuse 2 out.exr guide sphere -s 8 -o out.exr
  refuse 2 out.png guide sphere -s 8 -o out.png
  refuse 2 out.exr lut guide.exr -s 8 -o out.exr
  refuse 2 out.png lut guide.exr -s 8 -o out.png
  refuse 2 out.png stylize bundle --guide guide.exr -o out.png
}

@test "a folder that isn't a bundle is never replaced" {
  bring_all
  prove pack manifest.json -o out.bundle
  cp -r bundle mine
  mkdir mine/more
  echo 'my notes' >mine/more/notes.txt
  refuse 2 "mine: found 'more'" pack manifest.json -o mine
  refuse 2 "mine: found 'more'" pack manifest.json -o mine/
  refuse 2 "mine: found 'more'" pack manifest.json -o mine --dry-run
  refuse 2 "mine: found 'more'" params mine --set radius=1
  refuse 2 "mine: found 'more'" params mine --set radius=1 --dry-run
  expect notes "$(cat mine/more/notes.txt)" 'my notes'
  mkdir notes
  echo 'my notes' >notes/notes.txt
  refuse 2 notes pack manifest.json -o notes
  expect notes "$(ls notes)" notes.txt
  mkdir other
  mkdir other/bundle.json
  refuse 2 other pack manifest.json -o other
  touch file
  refuse 2 file pack manifest.json -o file
  ln -s bundle link
  refuse 2 link pack manifest.json -o link
  refuse 2 . pack manifest.json -o .
}

@test "an unknown ending of the output" {
  bring_all
  local ending
  for ending in jpg exr.gz ''; do
    beside refuse 1 "out.$ending" guide sphere -s 8 -o "out.$ending"
    beside refuse 1 "out.$ending" lut guide.exr -s 8 -o "out.$ending"
    beside refuse 1 "out.$ending" stylize bundle --guide guide.exr -o "out.$ending"
  done
  wait
}

# ---- full disks ----

# fill_disk LAST-ARGUMENT-NAME COMMAND...: the command passes where there is
# room, writes more than the disk holds, and is refused there.
fill_disk() {
  local name=$1 roomy=() full=() argument
  shift
  for argument in "$@"; do
    if [ "$argument" = "$name" ]; then
      roomy+=("out.$name") full+=("disk/$name")
    else
      roomy+=("$argument") full+=("$argument")
    fi
  done
  accept "${roomy[@]}" || return 1
  expect_less "room for $name" 65536 "$(du -sb "out.$name" | cut -f1)"
  rm -rf out.*
  refuse 2 "disk/$name" "${full[@]}"
  # An older file of this name stays what it was.
  if [[ $name == *.* ]]; then
    echo old >"disk/$name"
    refuse 2 "disk/$name" "${full[@]}"
    expect "disk/$name" "$(cat "disk/$name")" old
    rm "disk/$name"
  fi
}

@test "a full disk: guides and tables" {
  small_disk 64k
  fill_disk guide.exr guide sphere -s 256 -o guide.exr
  fill_disk guide.png guide sphere -s 512 --bits 16 -o guide.png
  oiiotool --create 128x128 3 --noise:type=uniform:min=0:max=1:seed=1 -d uint8 -o noise.png
  fill_disk lut.exr lut noise.png -s 256 -q -o lut.exr
  fill_disk lut.png lut noise.png -s 256 -q -o lut.png
}

@test "a full disk: bundles and pictures" {
  bring_all
  small_disk 64k
  fill_disk bundle pack manifest.json -o bundle
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "%s/spheres/pencil.png"}]}' "$exemplars" >pencil.json
  accept pack pencil.json --allow-outside -o pencil
  accept guide scene "$exemplars/creature.ply" -s 400 -o frame.exr
  fill_disk picture.png stylize pencil --guide frame.exr -o picture.png
  fill_disk nnf.png stylize pencil --guide frame.exr -o out.first.png --nnf nnf.png
  fill_disk chunks.png stylize pencil --guide frame.exr -o out.first.png --chunks chunks.png
}

@test "a full disk behind stdout" {
  bring_all
  beside full_stdout guide sphere -s 8 -o out.exr
  beside full_stdout lut guide.exr -s 8 -o out.exr
  beside full_stdout check lut.exr --guide guide.exr
  beside full_stdout pack manifest.json -o out.bundle
  beside full_stdout stylize bundle --guide guide.exr -o out.png
  beside full_stdout info guide.exr
  beside full_stdout info bundle
  beside full_stdout validate bundle
  beside full_stdout guide sphere -s 8 -o out.exr --dry-run
  beside full_stdout --help
  beside full_stdout --version
  beside full_stdout guide --help
  wait
}
full_stdout() {
  local said status format formats=(text json)
  [[ $1 != -* && $2 != -* ]] || formats=('')
  for format in "${formats[@]}"; do
    status=0
    said=$("$STYLUT" "$@" ${format:+--format $format} 2>&1 >/dev/full) || status=$?
    expect "'$*' $format: exit" $status 2
    expect_match "'$*' $format" "$said" '^stylut: error: standard output: [^
]*$'
  done
  rm -rf out.*
}

# ---- command lines ----

@test "no command and unknown commands" {
  refuse 1 command
  refuse 1 command ''
  refuse 1 paint paint
  refuse 1 "--guide" --guide
  refuse 1 "guidee" guidee sphere
  refuse 1 "'giude', expected a command that 'stylut --help' lists; did you mean 'guide'?" giude sphere
  refuse 1 "did you mean 'scene'?" guide scnee mesh.obj -o out.exr
  refuse 1 "did you mean 'strokes'?" guide stroke picture.png -o out.exr
  refuse 1 "guide sphere: found behind options, expected 'stylut guide sphere' and then those" guide -s 8 sphere -o out.exr
  local said
  for command in paint x guidance; do
    said=$("$STYLUT" $command 2>&1) || true
    [[ $said != *'did you mean'* ]] || complain "$command: $said"
  done
}

# What is wrong in options of a kind.
bad_values() {
  case $1 in
    whole) printf '%s\n' junk 1x ' 1' '1 ' -1 1.5 1e2 +1 nan inf 0x10 99999999999999999999 '' ;;
    count) printf '%s\n' 0 && bad_values whole ;;
    size) printf '%s\n' 0 8x x8 8x8x8 8X8 0x8 8x0 -8x8 8,8 70000 8x70000 65536x65536 && bad_values whole ;;
    number) printf '%s\n' junk 1x ' 1' '1 ' -1 1,5 +1 nan -nan inf -inf 0x10 1e999 1e9 . - e '' ;;
    choice) printf '%s\n' junk 0 -1 1 nan '' AUTO ' ' ;;
  esac
}

# refuse_values OPTION KIND MORE-VALUES COMMAND...: each bad value is refused by
# the option's name.
refuse_values() {
  local option=$1 kind=$2 more=$3 value
  shift 3
  local before after
  before=$(list_files)
  while IFS= read -r value; do
    complain_unless_refused 1 "$option" "$@" "$option=$value"
  done < <(bad_values "$kind" && if [ -n "$more" ]; then printf '%s\n' $more; fi)
  complain_unless_refused 1 "$option" "$@" "$option" ''
  complain_unless_refused 1 "$option" "$@" "$option" junk
  complain_unless_refused 1 "$option" "$@" "$option"
  after=$(list_files)
  expect "files after wrong values of $option" "$after" "$before"
}

refuse_common_values() {
  refuse_values --threads count '1025' "$@"
  refuse_values --format choice 'xml JSON text,json' "$@"
  refuse_values --progress choice 'xml bars' "$@"
}

@test "wrong option values: guide" {
  bring mesh.obj
  prove guide sphere -s 8x9 -c normal -j 1 --format json --progress none -o out.exr
  prove guide sphere -s 8 --bits 16 -o out.png
  local sphere=(guide sphere -o out.exr) scene=(guide scene mesh.obj -o out.exr -s 8)
  refuse_values --size size '' "${sphere[@]}"
  refuse_values --channels choice 'normal,junk normal, ,normal normal,,depth NORMAL normal.X all,junk' "${sphere[@]}"
  refuse_values --bits choice '32 08 8.0 16x 24' "${sphere[@]}"
  refuse_common_values "${sphere[@]}"
  prove "${scene[@]}" --view 30,-20 --camera perspective --fov 50 --margin 0.1 --crease 30
  prove "${scene[@]}" --flat
  refuse_values --view choice 'Front back 30 30, ,30 30,91 30,-91 361,0 30,20,10 30;20 nan,0 0,inf 1e9,0 0x10,0 three_quarter' \
    "${scene[@]}"
  refuse_values --camera choice 'ortho Perspective' "${scene[@]}"
  refuse_values --fov number '0 0.5 171 180' "${scene[@]}"
  refuse_values --margin number '0.46 0.5 1' "${scene[@]}"
  refuse_values --crease number '181 360' "${scene[@]}"
}

@test "wrong option values: lut and check" {
  bring guide.exr lut.exr
  prove lut guide.exr -s 8 -e brute --sampling unorm8 --encoding f32 -o out.exr
  local lut=(lut guide.exr -o out.exr)
  refuse_values --size count '8193 8x8' "${lut[@]}"
  refuse_values --engine choice 'Brute flann brute,analytic' "${lut[@]}"
  refuse_values --sampling choice 'center Centre' "${lut[@]}"
  refuse_values --encoding choice 'F32 f16 rg16x2' "${lut[@]}"
  refuse 1 --encoding lut guide.exr --encoding rg16 -o out.exr
  refuse 1 --encoding lut guide.exr --encoding f32 -o out.png
  refuse_common_values "${lut[@]}"
  local check=(check lut.exr --guide guide.exr) option
  prove "${check[@]}" --tolerance 2 --max-mean 180 --max-p99 180 --max-error 180 --min-coverage 0
  for option in --max-mean --max-p99 --max-error; do refuse_values $option number '181' "${check[@]}"; done
  refuse_values --min-coverage number '1.01 2 100' "${check[@]}"
  refuse_values --tolerance number '256' "${check[@]}"
  refuse_common_values "${check[@]}"
}

@test "wrong option values: pack, stylize, info, validate" {
  bring_all
  prove pack manifest.json --seed 7 -o out.bundle
  refuse_values --seed whole '9223372036854775808' pack manifest.json -o out.bundle
  refuse_common_values pack manifest.json -o out.bundle
  prove stylize bundle --guide guide.exr --style 1 --bits 16 -o out.png
  refuse_values --bits choice '32 08' stylize bundle --guide guide.exr -o out.png
  local value
  for value in 0 2 -1 First '' nan 1x; do beside refuse 1 --style stylize bundle --guide guide.exr -o out.png --style "$value"; done
  wait
  refuse_common_values stylize bundle --guide guide.exr -o out.png
  refuse_common_values info guide.exr
  refuse_common_values validate bundle
}

@test "empty file names" {
  bring_all
  refuse 1 --output guide sphere -s 8 -o ''
  refuse 1 --output lut guide.exr -o ''
  refuse 1 --output pack manifest.json -o ''
  refuse 1 --output stylize bundle --guide guide.exr -o ''
  refuse 1 --guide stylize bundle --guide '' -o out.png
  refuse 1 --guide check lut.exr --guide ''
  refuse 1 --nnf stylize bundle --guide guide.exr --nnf '' -o out.png
  refuse 1 --chunks stylize bundle --guide guide.exr --chunks '' -o out.png
}

@test "unknown options, and arguments too many or too few" {
  bring_all
  local line command
  while read -r line; do
    read -ra command <<<"$line"
    prove "${command[@]}"
    refuse 1 "'--junk'" "${command[@]}" --junk
    refuse 1 "'--junk=3'" "${command[@]}" --junk=3
    refuse 1 "'-X'" "${command[@]}" -X
    refuse 1 "'-qX'" "${command[@]}" -qX
    refuse 1 "'-XYq'" "${command[@]}" -XYq
    refuse 1 "'-qXY'" "${command[@]}" -v -qXY
    refuse 1 "'--junk'" "${command[@]}" --junk -XY
    refuse 1 "'more'" "${command[@]}" more
    refuse 1 "'-'" "${command[@]}" -
    refuse 1 --quiet "${command[@]}" --quiet=1
  done <<'EOF'
guide sphere -s 8 -o out.exr
guide scene mesh.obj -s 8 -o out.exr
lut guide.exr -s 8 -o out.exr
check lut.exr --guide guide.exr
pack manifest.json -o out.bundle
stylize bundle --guide guide.exr -o out.png
info guide.exr
validate bundle
EOF
  for command in guide lut check pack stylize info validate; do refuse 1 expected $command; done
  refuse 1 --output guide sphere
  refuse 1 mesh guide scene -o out.exr
  refuse 1 --output lut guide.exr
  refuse 1 --output pack manifest.json
  refuse 1 --output stylize bundle --guide guide.exr
  refuse 1 --guide stylize bundle -o out.png
  refuse 1 --guide check lut.exr
}

@test "options that don't go together" {
  local option
  bring guide.exr mesh.obj
  for option in '--trees 5' '--trees 4' '--checks 9' '--precision 0.5'; do
    # shellcheck disable=SC2086
    refuse 1 "${option%% *}" lut guide.exr -s 8 -o out.exr $option
  done
  refuse 1 --precision lut guide.exr -s 8 -e flann-forest --precision 0.5 -o out.exr
  # A guide behind the frames: with several of them nobody can tell which is which.
  accept guide sphere -s 9 -o frame.exr
  prove lut --frames frame.exr guide.exr -s 8 --resolve frames -o out.exr
  refuse 1 frame.exr lut --frames frame.exr frame.exr guide.exr -s 8 --resolve frames -o out.exr
  refuse 1 flann-forest lut guide.exr -s auto --max-p99 30 -e flann-forest -o out.exr
  refuse 1 "'-o'" lut guide.exr -s 8 --resolve frames --frames -o out.exr
  for option in '--view front' '--camera perspective' '--fov 30' '--margin 0' '--crease 3' --flat; do
    # shellcheck disable=SC2086
    refuse 1 "${option%% *}" guide sphere -s 8 -o out.exr $option
  done
  prove guide sphere -s 8 -c normal -o out.png
  refuse 1 'found depth for out.png, which holds normals only' guide sphere -s 8 -c depth -o out.png
  refuse 1 'found all for out.png' guide sphere -s 8 -c all -o out.png
  refuse 1 'found normal,depth for out.png' guide scene mesh.obj -s 8 -c normal,depth -o out.png
  refuse 1 --crease guide scene mesh.obj -s 8 --flat --crease 30 -o out.exr
}

# need EXPECTED OPTION... -- COMMAND...: the option is refused where it would change nothing.
need() {
  local expected=$1 option=("$2")
  shift 2
  while [ "$1" != -- ]; do
    option+=("$1")
    shift
  done
  shift
  prove "$@"
  beside refuse 1 "${option[0]}: found where it changes nothing, expected it with $expected" "$@" "${option[@]}"
}

@test "options that would change nothing" {
  bring guide.exr guide.png mesh.obj
  printf '{ "schema": "stylut-scene/1", "spheres": [ {} ] }' >scene.json
  local scene=(guide scene mesh.obj -s 8 -o out.exr) option name
  need 'an output that ends in .png' --bits 16 -- guide sphere -s 8 -o out.exr
  need 'an output that ends in .png' --bits 8 -- "${scene[@]}"
  need 'an output that ends in .png' --bits 16 -- guide import guide.png --as png -o out.exr
  need 'an output that ends in .png' --bits 16 -- guide flow guide.png guide.png -o out.exr
  need 'an output that ends in .png' --display 3 -- guide flow guide.png guide.png -o out.exr
  need 'an output that ends in .exr' --previous mesh.obj -- guide scene mesh.obj -s 8 -o out.png
  for name in depth position,object,style uv albedo curvature luma full; do
    need 'the channel normal or contour' --flat -- "${scene[@]}" -c $name
    need 'the channel normal or contour' --frame ray -- "${scene[@]}" --camera perspective -c $name
  done
  for name in depth position,object,style uv albedo; do
    need 'the channel normal, contour, curvature or luma' --crease 30 -- "${scene[@]}" -c $name
  done
  need 'the channel contour' --contour-depth 2 -- "${scene[@]}"
  need 'the channel contour' --contour-normal 2 -- "${scene[@]}" -c depth
  need 'the channel albedo or luma, or one of light paths' --texture-filter bilinear -- "${scene[@]}"
  need 'a channel of light paths: full' --spp 4 -- "${scene[@]}" -c all
  need 'a channel of light paths: full' --seed 4 -- "${scene[@]}" -c all
  need '--simplify auto' --max-error 2 -- "${scene[@]}"
  need '--camera perspective' --fov 30 -- "${scene[@]}"
  need '--camera perspective' --frame ray -- "${scene[@]}"
  for option in '--view front' '--up z' '--camera perspective' '--margin 0' '--fov 30'; do
    # shellcheck disable=SC2086
    need 'a mesh: scene files have a camera' $option -- guide scene scene.json -s 8 -o out.exr
  done
  wait
  # What they act on is enough.
  for name in normal contour curvature luma full; do accept "${scene[@]}" --crease 30 -c $name; done
  for name in albedo luma LIE; do accept "${scene[@]}" --texture-filter nearest -c $name; done
  accept "${scene[@]}" --camera perspective --frame ray -c contour
  accept guide scene scene.json -s 8 --frame ray -c normal -o out.exr
  accept "${scene[@]}" --seed 1 --spp 2 -c LDE
}

@test "a sphere stands still" {
  refuse 1 "found motion for the sphere, which stands still, expected it of 'stylut guide scene' with --previous" guide sphere -s 8 -c motion -o out.exr
  refuse 1 "'--seed'" guide sphere -s 8 --seed 3 -o out.exr
}

@test "control characters in names are not echoed as they are" {
  bring_all
  local name=$'bad\e[31m\a\r\nname'
  local commands said status
  for commands in 'guide scene NAME.obj -o out.exr' 'lut NAME.exr -o out.exr' 'info NAME.exr' 'validate NAME' \
    'stylize NAME --guide guide.exr -o out.png' 'stylize bundle --guide NAME -o out.png' 'pack NAME.json -o out.bundle' \
    'guide sphere --size NAME -o out.exr' 'NAME' 'guide NAME -o out.exr' 'guide sphere --NAME -o out.exr' \
    'guide sphere -s 8 -o NAME/out.exr' 'lut guide.exr -e NAME -o out.exr' 'check lut.exr --guide NAME.exr' \
    'stylize bundle --guide guide.exr --style NAME -o out.png' 'guide sphere -s 8 -o NAME'; do
    local arguments=() word
    for word in $commands; do arguments+=("${word//NAME/$name}"); done
    status=0
    said=$("$STYLUT" "${arguments[@]}" 2>&1 >/dev/null) || status=$?
    [ $status != 0 ] || complain "'$commands' passed"
    [[ $said == 'stylut: error: '* && $said != *[[:cntrl:]]* ]] ||
      complain "'$commands' said $(printf %q "$said"), expected one line without control characters"
  done
  # Findings and names inside manifests go to the terminal too.
  said=$("$STYLUT" validate "$name" 2>/dev/null | tr -d '\n') || true
  [[ $said != *[[:cntrl:]]* ]] || complain "validate printed $(printf %q "$said")"
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a\\u001b[31m", "exemplar": "no\\u001b\\n.png"}]}' >bad.json
  said=$("$STYLUT" pack bad.json -o out.bundle 2>&1) || true
  [[ $said != *[[:cntrl:]]* ]] || complain "pack said $(printf %q "$said")"
  sed 's/"first"/"a\\u001b[31mb\\n"/' manifest.json >odd.json
  if "$STYLUT" pack odd.json -o odd -q 2>/dev/null; then
    said=$("$STYLUT" info odd | tr -d '\n')
    [[ $said != *[[:cntrl:]]* ]] || complain "info printed $(printf %q "$said")"
  fi
}

# ---- manifests ----

# refuse_manifest KEY OLD NEW: the manifest with OLD replaced by NEW is refused
# with the line and column of the new value, and the way to it.
refuse_manifest() {
  local key=$1 old=$2 new=$3 text line column path
  cp manifest.json bad.json
  edit bad.json "\"$key\": $old" "\"$key\": $new"
  line=$(grep -nF "\"$key\": $new" bad.json | head -n 1 | cut -d: -f1)
  text=$(sed -n "${line}p" bad.json)
  text=${text%%"\"$key\": $new"*}
  column=$((${#text} + ${#key} + 5))
  case $key in
    schema | jitter) path=$key ;;
    size | engine | sampling | resolve) path=styles[0].lut.$key ;;
    name | exemplar | guide) path=styles[0].$key ;;
    *) path=styles[0].params.$key ;;
  esac
  complain_unless_refused 3 "bad.json:$line:$column: $path: " pack bad.json -o out.bundle
  [ ! -e out.bundle ] || complain "'$key': $new: wrote a bundle"
}

@test "manifests: values of the wrong type, each with its place" {
  bring_all
  prove pack manifest.json -o out.bundle
  local value
  for value in 1 1.5 true null '[]' '{}' '""'; do
    refuse_manifest schema '"stylut-bundle/1"' "$value"
    refuse_manifest name '"first"' "$value"
    refuse_manifest exemplar '"exemplar.png"' "$value"
    refuse_manifest guide '"guide.exr"' "$value"
    refuse_manifest engine '"auto"' "$value"
    refuse_manifest sampling '"unorm8"' "$value"
    refuse_manifest resolve '"nearest"' "$value"
    refuse_manifest jitter '"jitter.png"' "$value"
  done
  for value in '"1"' 1.5 true null '[]' '{}' -1 1e3 99999999; do
    refuse_manifest size 16 "$value"
    refuse_manifest threshold 24 "$value"
    refuse_manifest top_level 6 "$value"
    refuse_manifest radius 1 "$value"
  done
  for value in 0 1 8193; do refuse_manifest size 16 $value; done
  refuse_manifest threshold 24 767
  refuse_manifest top_level 6 13
  refuse_manifest radius 1 9
  for value in '"1"' true null '[]' '{}' -1 1e31; do refuse_manifest depth_tolerance 0 "$value"; done
  refuse_manifest schema '"stylut-bundle/1"' '"stylut-bundle/2"'
  refuse_manifest engine '"auto"' '"junk"'
  refuse_manifest sampling '"unorm8"' '"junk"'
  refuse_manifest resolve '"nearest"' '"junk"'
}

# refuse_text OLD NEW NAMED: not a single value: NEW for OLD
refuse_text() {
  perl -0pe "s/$1/$2/s" manifest.json >bad.json
  ! cmp -s manifest.json bad.json
  refuse 3 "bad.json:" pack bad.json -o out.bundle
  refuse 3 "$3" pack bad.json -o out.bundle
}

@test "manifests: objects and lists of the wrong type" {
  bring_all
  prove pack manifest.json -o out.bundle
  local value
  for value in 1 null '"x"' '[]' '{}'; do
    refuse_text '"styles": \[.*\]' "\"styles\": $value" styles
    [ "$value" = '{}' ] || refuse_text '"params": \{.*?\}' "\"params\": $value" params
    [[ $value == '{}' || $value == '"x"' ]] || refuse_text '"lut": \{.*?\}' "\"lut\": $value" lut
  done
  refuse_text '"styles": \[.*\]' '"styles": [1]' 'styles[0]'
  refuse_text '\A.*\Z' '[]' object
  refuse_text '\A.*\Z' '1' 1:1:
}

@test "manifests: unknown, missing and double keys" {
  bring_all
  prove pack manifest.json -o out.bundle
  local key
  for key in schema name size threshold; do refuse_text "\"$key\"" "\"junk\": 1, \"$key\"" junk; done
  refuse_text '"name"' '"Name": "x", "name"' Name
  refuse_text '"schema": "stylut-bundle.1",' '' schema
  refuse_text '"name": "first",' '' name
  refuse_text '"exemplar": "exemplar.png",' '' exemplar
  refuse_text '"guide"' '"name": "second", "guide"' name
  refuse_text '"size": 16' '"size": 16, "file": "lut.exr"' size
}

@test "manifests: broken JSON, with its place" {
  bring_all
  prove pack manifest.json -o out.bundle
  local length size
  size=$(($(stat -c %s manifest.json) - 2))
  for length in $(seq 1 16 $size) $size; do
    head -c "$length" manifest.json >bad.json
    refuse 3 'bad.json:' pack bad.json -o out.bundle
  done
  refuse_text '"guide": ' '"guide" ' 'bad.json:7:'
  refuse_text '16,' '016,' 'bad.json:9:'
  refuse_text '16,' 'NaN,' 'bad.json:9:'
  refuse_text '16,' '16,,' 'bad.json:9:'
  refuse_text '\Z' 'x' 'bad.json:2'
  refuse_text 'first' "fir\nst" 'bad.json:5:'
  refuse_text 'first' '\xff\xfe' 'bad.json:'
  { cat manifest.json && head -c 17M /dev/zero | tr '\0' ' '; } >bad.json
  refuse 3 bad.json pack bad.json -o out.bundle
}

@test "manifests: 0 and 257 styles, two of one name" {
  bring_all
  list_styles 256 >manifest.json
  list_styles 0 >bad.json
  refuse 3 bad.json:1: pack bad.json -o out.bundle
  list_styles 257 >bad.json
  refuse 3 bad.json:1: pack bad.json -o out.bundle
  refuse 3 256 pack bad.json -o out.bundle
  list_styles 3 >good.json
  prove pack good.json -o out.bundle
  sed 's/"s3"/"s1"/' good.json >bad.json
  refuse 3 "bad.json:1:$(awk 'match($0, /"s1".*"s1"/) { print RSTART + RLENGTH - 4 }' bad.json):" pack bad.json -o out.bundle
  refuse 3 's1' pack bad.json -o out.bundle
}
list_styles() { # COUNT
  local i
  printf '{"schema": "stylut-bundle/1", "styles": ['
  for ((i = 1; i <= $1; i++)); do printf '%s{"name": "s%d", "exemplar": "exemplar.png"}' "${separator:-}" $i && separator=', '; done
  printf ']}\n'
  separator=
}

@test "manifests: a table for another source size, and jitter of another size" {
  bring_all
  perl -0pe 's/"lut": \{.*?\}/"lut": "lut.exr"/s' manifest.json >good.json
  prove pack good.json -o out.bundle
  accept guide sphere -s 9 -o nine.exr
  local ending
  for ending in exr png; do
    accept lut nine.exr -s 16 -o nine.lut.$ending
    sed "s/lut\.exr/nine.lut.$ending/" good.json >bad.json
    beside refuse 3 nine.lut.$ending pack bad.json -o out.bundle
    beside refuse 3 9x9 pack bad.json -o out.bundle
    beside refuse 3 8x8 pack bad.json -o out.bundle
  done
  wait
  accept guide sphere -s 255x256 -o odd.png
  sed 's/jitter\.png/odd.png/' manifest.json >bad.json
  refuse 3 odd.png pack bad.json -o out.bundle
  refuse 3 255x256 pack bad.json -o out.bundle
}

@test "manifests: tables of differing sizes in one bundle" {
  bring_all
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "exemplar.png", "lut": {"size": 16}}, {"name": "b", "exemplar": "exemplar.png", "lut": {"size": 16}}]}' >good.json
  prove pack good.json -o out.bundle
  sed 's/16}}\]/17}}]/' good.json >bad.json
  local part
  for part in 16 17 "'a'" "'b'"; do beside refuse 3 "$part" pack bad.json -o out.bundle; done
  wait
}

# ---- damaged bundles ----

# refuse_bundle CODE NUMBERS NAMED: ./bad is refused by stylize, info and validate,
# the latter with a finding of one of the numbers that holds NAMED.
refuse_bundle() {
  local code=$1 numbers=$2 named=$3 findings
  refuse "$code" bad stylize bad --guide guide.exr -o out.png
  refuse "$code" bad info bad
  refuse "$code" bad validate bad
  findings=$("$STYLUT" validate bad 2>/dev/null || true)
  expect_match "findings on $named" "$findings" "(^|
)B[$numbers] error: "
  expect_holds findings "$findings" "$named"
  findings=$("$STYLUT" validate bad --format json 2>/dev/null || true)
  expect_match 'findings as JSON' "$findings" '"valid": false'
  expect_match 'findings as JSON' "$findings" "\"number\": [$numbers],"
}

# flip FILE OFFSET
flip() { perl -e 'open my $f, "+<:raw", $ARGV[0] or die; seek $f, $ARGV[1], 0; read $f, my $b, 1; seek $f, $ARGV[1], 0; print $f chr(ord($b) ^ 1)' "$1" "$2"; }

@test "bundles: one byte changed in a texture" {
  bring_all
  prove validate bundle
  prove stylize bundle --guide guide.exr -o out.png
  prove info bundle
  local file size offset
  for file in exemplars guides luts params jitter; do
    size=$(stat -c %s bundle/$file.ktx2)
    for offset in 0 12 21 33 $((size / 2)) $((size - 1)); do
      rm -rf bad
      cp -r bundle bad
      flip bad/$file.ktx2 "$offset"
      beside refuse_bundle 3 4 $file.ktx2
    done
  done
  wait
}

@test "bundles: a texture too short or too long" {
  bring_all
  local file
  for file in exemplars guides luts params jitter; do
    rm -rf bad
    cp -r bundle bad
    truncate -s -1 bad/$file.ktx2
    beside refuse_bundle 3 3 $file.ktx2
    cp bundle/$file.ktx2 bad
    printf 'x' >>bad/$file.ktx2
    beside refuse_bundle 3 3 $file.ktx2
    : >bad/$file.ktx2
    beside refuse_bundle 3 35 $file.ktx2
  done
  wait
}

@test "bundles: one byte changed in the index" {
  bring_all
  local offset
  for offset in $(seq 0 23 $(($(stat -c %s bundle/bundle.json) - 3))); do
    rm -rf bad
    cp -r bundle bad
    flip bad/bundle.json "$offset"
    beside refuse_bundle 3 134 ''
  done
  wait
}

@test "bundles: an index of the wrong shape" {
  bring_all
  local change
  for change in 's/"schema": "stylut-bundle-index.1"/"schema": "stylut-bundle-index\/2"/' 's/"schema"/"scheme"/' 's/"files": \[/"files": [1, /' \
    's/"files"/"file"/' 's/"styles": \[.*\]/"styles": []/s' 's/"styles": \[/"styles": [{}, /' 's/"styles"/"style"/' 's/\A.*\Z/[]/s' 's/\A.*\Z//s' \
    's/"bytes": (\d+)/"bytes": "$1"/' 's/"sha256": "/"sha256": "0/'; do
    rm -rf bad
    cp -r bundle bad
    perl -0pi -e "$change" bad/bundle.json
    ! cmp -s bundle/bundle.json bad/bundle.json || complain "'$change' changes nothing"
    beside refuse_bundle 3 1348 ''
  done
  wait
}

@test "bundles: a file missing" {
  bring_all
  local file
  for file in exemplars.ktx2 guides.ktx2 luts.ktx2 params.ktx2 jitter.ktx2 bundle.json; do
    rm -rf bad
    cp -r bundle bad
    rm bad/$file
    beside refuse_bundle 2 2 $file
    mkdir bad/$file
    beside refuse_bundle 2 2 $file
  done
  wait
}

@test "bundles: files of another bundle" {
  bring_all
  sed 's/"size": 16/"size": 17/' manifest.json >other.json
  list_styles 2 >two.json
  accept pack other.json -o other
  accept pack two.json -o two
  cp -r bundle bad
  cp other/luts.ktx2 bad
  refuse_bundle 3 3 luts.ktx2
  # With an index that fits, the textures themselves must.
  cp -r two/. bad
  cp bundle/exemplars.ktx2 bundle/params.ktx2 bad
  local file
  for file in exemplars params; do
    OLD=$(sha256sum two/$file.ktx2 | cut -d' ' -f1) NEW=$(sha256sum bad/$file.ktx2 | cut -d' ' -f1) \
      SIZE=$(stat -c %s two/$file.ktx2) NOW=$(stat -c %s bad/$file.ktx2) \
      perl -0pi -e 's/$ENV{OLD}/$ENV{NEW}/; s/("bytes": )$ENV{SIZE}/$1$ENV{NOW}/' bad/bundle.json
  done
  refuse_bundle 3 67 ktx2
}

@test "an input is never written over" {
  bring guide.exr
  cp guide.exr own.exr
  cp guide.exr copy.exr
  refuse 1 --output lut own.exr -o own.exr
  refuse 1 --output lut own.exr -o ./own.exr
  expect_same own.exr copy.exr
}
