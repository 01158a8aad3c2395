#!/usr/bin/env bats
# The same bytes on any number of threads, in every run, from every compiler.
load helpers

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
  rm art
}

same_folders() {
  diff -rq "$1" "$2" >different.txt || complain "$1 and $2: $(tr '\n' ' ' <different.txt)"
  expect "files of $2" "$(find "$2" -type f | wc -l)" "$(find "$1" -type f | wc -l)"
  expect 'files compared' "$(find "$2" -type f | wc -l)" 25
}

setup_file() { (make_everything "$STYLUT" "$BATS_FILE_TMPDIR/one" -j 1); }

@test "two and three threads give what one gives" {
  (make_everything "$STYLUT" two -j 2) 3>&- &
  (make_everything "$STYLUT" three -j 3)
  wait
  same_folders "$BATS_FILE_TMPDIR/one" two
  same_folders "$BATS_FILE_TMPDIR/one" three
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
  env -u CC -u CXX make -s -j 2 -C "$STYLUT_ROOT" CC=$compiler CGAL=0 config="$STYLUT_CONFIG" "build/${other##*/}/stylut" "build/${other##*/}/libstylut_oiio.so" \
    >make.log 2>&1 || { complain "make CC=$compiler: $(tail -n 5 make.log)"; return 1; }
  (make_everything "$other/stylut" other)
  same_folders "$BATS_FILE_TMPDIR/one" other
}
