#!/usr/bin/env bats
# The same bytes on any number of threads, in every run, from every compiler.
load helpers

# write_scene FILE HEIGHT AZIMUTH: several objects and spheres, a texture, lights of both kinds with shadows.
# The creature stands HEIGHT above the floor.
write_scene() {
  printf 'v %s\n' '-3 -1 -3' '3 -1 -3' '3 -1 3' '-3 -1 3' >floor.obj
  printf 'vt %s\n' '0 0' '3 0' '3 3' '0 3' >>floor.obj
  echo 'f 4/4 3/3 2/2 1/1' >>floor.obj
  cat >"$1" <<END
{ "schema": "stylut-scene/1", "camera": { "type": "perspective", "position": [$3, 1.5, 6], "target": [0, -0.1, 0], "fov": 30 },
  "objects": [
    { "mesh": "art/creature.ply", "style": 1, "color": [0.6, 0.5, 0.3], "transform": [1,0,0,0, 0,1,0,$2, 0,0,1,0, 0,0,0,1] },
    { "mesh": "art/creature.ply", "style": 2, "transform": [0.5,0,0,-1.3, 0,0.5,0,-0.5, 0,0,0.5,0.4, 0,0,0,1] },
    { "mesh": "floor.obj", "texture": "flat.png" } ],
  "spheres": [ { "center": [1.2, -0.6, 0.6], "radius": 0.4, "style": 3, "color": [0.2, 0.4, 0.7], "specular": 0.5 },
               { "center": [-1, 0.7, -0.5], "radius": 0.3 } ],
  "lights": [ { "type": "directional", "direction": [-1, -2, -1] }, { "type": "point", "position": [0, 3, 2], "intensity": 8 } ],
  "ambient": 0.1, "shadows": true }
END
}

# make_guides STYLUT OPTION...: of a scene in the light, light paths, motion, and what isn't traced.
make_guides() {
  local stylut=$1
  shift
  write_scene now.json 0 0.4
  write_scene before.json 0.05 0
  "$stylut" guide scene now.json -s 97x80 -c all -q "$@" -o lit.exr || return 1
  "$stylut" guide scene now.json -s 97x80 -c motion --previous before.json -q "$@" -o moved.exr || return 1
  "$stylut" guide scene now.json -s 64x50 -c paths --spp 4 --seed 7 -q "$@" -o paths.exr || return 1
  "$stylut" guide scene before.json -s 97x80 -q "$@" -o before.png || return 1
  "$stylut" guide scene now.json -s 97x80 -q "$@" -o now.png || return 1
  "$stylut" guide flow now.png before.png -q "$@" -o flow.exr || return 1
  "$stylut" guide strokes now.png --levels all -q "$@" -o strokes.exr || return 1
  "$stylut" guide warp art/warp.json -s 150x171 -q "$@" -o warp.exr || return 1
  "$stylut" guide import flat.png --as png --flip-y -q "$@" -o imported.exr || return 1
}

# make_bundle STYLUT OPTION...: with all that a manifest may ask for, changed, unpacked and put to use.
make_bundle() {
  local stylut=$1
  shift
  cat >all.json <<END
{ "schema": "stylut-bundle/1", "styles": [
  { "name": "lit", "exemplars": [ { "image": "art/spheres/oil.png", "luma": 0.2 }, { "image": "art/spheres/pencil.png", "luma": 0.8 } ],
    "base": 3, "lut": { "budget": { "p99": 3 } } },
  { "name": "calm", "exemplar": "flat.png", "guide": "other.exr", "lut": { "resolve": "both", "frames": "before.png" }, "params": { "scatter": 9 } } ] }
END
  "$stylut" pack all.json --allow-outside --fit resize --jitter-frames 2 --jitter-noise blue --seed 3 -q "$@" -o all || return 1
  "$stylut" params all --set calm.radius=3 "$@" >params.txt || return 1
  "$stylut" unpack all -q "$@" -o unpacked || return 1
  "$stylut" stylize all --guide lit.exr --style lit --flat where.png --measure measure.json -q "$@" -o all.png || return 1
  "$stylut" stylize all --guide lit.exr --style calm --resolution half --set scale=2 --anchor object -q "$@" -o half.png || return 1
  "$stylut" toon --guide lit.exr --texture hatch -q "$@" -o toon.png || return 1
  "$stylut" outline --guide lit.exr --wobble 2 --over toon.png -q "$@" -o outline.png || return 1
}

# make_everything STYLUT FOLDER [OPTION...]: one of each kind of output. The names
# inside are the same everywhere, since files tell how they were made.
make_everything() {
  local stylut=$1 engine
  mkdir "$2"
  cd "$2" || return 1
  shift 2
  ln -s "$exemplars" art
  "$stylut" guide scene art/creature.ply -s 203x170 -c all --view three-quarter -q "$@" -o frame.exr || return 1
  "$stylut" guide scene art/creature.ply -s 90 -c all --view -50,10 --camera perspective --crease 40 -q "$@" -o other.exr || return 1
  "$stylut" guide scene art/creature.ply -s 90 --bits 16 --flat -q "$@" -o flat.png || return 1
  make_guides "$stylut" "$@" || return 1
  "$stylut" guide sphere -s 60 -q "$@" -o sphere.exr || return 1
  for engine in brute analytic flann-single auto; do
    "$stylut" lut sphere.exr -s 70 -e $engine -q "$@" -o sphere.$engine.exr || return 1
  done
  for engine in brute flann-single; do
    "$stylut" lut other.exr -s 70 -e $engine -q "$@" -o other.$engine.exr || return 1
  done
  "$stylut" lut flat.png -s 40 --sampling unorm8 -q "$@" -o flat.lut.png || return 1
  "$stylut" match sphere.exr other.exr --channels normal,depth.Z:0.1 -q "$@" -o field.exr || return 1
  "$stylut" match sphere.exr flat.png -q "$@" -o field.png || return 1
  "$stylut" lut other.exr --channels normal -s 12 -q "$@" -o cube.exr || return 1
  "$stylut" check other.brute.exr --guide other.exr --format json "$@" >check.json || return 1
  "$stylut" pack art/styles.json -q "$@" -o bundle || return 1
  "$stylut" stylize bundle --guide frame.exr --style oil --nnf nnf.png --chunks chunks.png -q "$@" -o oil.png || return 1
  "$stylut" stylize bundle --guide other.exr --style 1 --bits 16 -q "$@" -o pencil.png || return 1
  make_bundle "$stylut" "$@" || return 1
  rm art
}

same_folders() {
  diff -rq "$1" "$2" >different.txt || complain "$1 and $2: $(tr '\n' ' ' <different.txt)"
  expect "files of $2" "$(find "$2" -type f | wc -l)" "$(find "$1" -type f | wc -l)"
  expect 'files compared' "$(find "$2" -type f | wc -l)" 63
}

setup_file() { (make_everything "$STYLUT" "$BATS_FILE_TMPDIR/one" -j 1); }

@test "two and four threads give what one gives" {
  (make_everything "$STYLUT" two -j 2) 3>&- &
  (make_everything "$STYLUT" four -j 4)
  wait
  same_folders "$BATS_FILE_TMPDIR/one" two
  same_folders "$BATS_FILE_TMPDIR/one" four
}

@test "what is compared isn't empty: light, shadow, texture, motion" {
  local one=$BATS_FILE_TMPDIR/one channel
  for channel in luma.Y albedo.G curvature.Y contour.Y uv.U style.I; do
    expect_less "pixels with $channel" 500 "$(dump "$one/lit.exr" $channel count)"
  done
  expect_less 'pixels that moved' 2000 "$(dump "$one/moved.exr" motion.V count)"
  expect_less 'pixels with bounced light' 500 "$(dump "$one/paths.exr" LIE.R count)"
  expect_less 'pixels that flow' 500 "$(dump "$one/flow.exr" motion.U count)"
}

@test "a second run, a second later, gives the same" {
  # setup_file was the first.
  sleep 1
  (make_everything "$STYLUT" again)
  same_folders "$BATS_FILE_TMPDIR/one" again
}

@test "another compiler gives the same, with and without CGAL" {
  local compiler=clang other
  [[ ${STYLUT_BUILD##*/} != *clang* ]] || compiler=gcc
  command -v $compiler >/dev/null || skip "no $compiler"
  other=$STYLUT_ROOT/build/$STYLUT_CONFIG$([ $compiler = gcc ] || echo -clang)-nocgal
  env -u CC -u CXX make -s -j 2 -C "$STYLUT_ROOT" CC=$compiler CGAL=0 config="$STYLUT_CONFIG" "build/${other##*/}/stylut" >make.log 2>&1 || { complain "make CC=$compiler: $(tail -n 5 make.log)"; return 1; }
  expect "warnings of $compiler" "$(grep -m 3 -F warning: make.log)" ''
  (make_everything "$other/stylut" other)
  same_folders "$BATS_FILE_TMPDIR/one" other
}
