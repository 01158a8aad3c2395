#!/usr/bin/env bats
# Memory that runs out: in any one place of any command, and for all of it.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  oiiotool --no-autopremult "$exemplars/spheres/oil.png" --resize 24x24 -d uint8 -o oil.png
  "$STYLUT" guide sphere -s 24 -q --no-history -c normal,position -o guide.exr
  "$STYLUT" guide sphere -s 24 -q --no-history --bits 8 -o guide.png
  "$STYLUT" lut guide.exr -s 16 -q -o lut.exr
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "oil", "exemplar": "oil.png", "base": 2, "lut": {"size": 16}}]}\n' >m.json
  "$STYLUT" pack m.json -q -o bundle
  printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >spike.obj
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": "spike.obj"}], "spheres": [{"center": [0, 0, 0], "radius": 1}],
    "lights": [{"type": "directional", "direction": [0, -1, -1]}]}\n' >scene.json
  printf '{"schema": "stylut-pairs/1", "pairs": [{"from": [0, 0], "to": [0.1, 0]}, {"from": [1, 0], "to": [0.9, 1]}, {"from": [0, 1], "to": [0, 0.8]}]}\n' >pairs.json
}

# Sanitizers have allocators, and address spaces, of their own.
setup() {
  [ "$STYLUT_CONFIG" != sanitize ] || skip 'not with a sanitizer'
  cd "$(mktemp -d "$BATS_TEST_TMPDIR/desk.XXXXXX")" || return 1
}

bring_all() { bring oil.png guide.exr guide.png lut.exr m.json bundle spike.obj scene.json pairs.json; }

# Of the places where a command asks for memory, this many are tried, evenly spread; STYLUT_FAULTS=0: all of them.
places=${STYLUT_FAULTS:-16}

# starve COMMAND...: it fails in one line, with nothing left, wherever memory isn't given; or does without.
starve() {
  local library=$STYLUT_BUILD/tests/faults/fail_allocation.so before count step k status
  before=$(find . | sort)
  FAIL_COUNT=$BATS_TEST_TMPDIR/count LD_PRELOAD=$library "$STYLUT" "$@" -j 1 >/dev/null 2>&1 ||
    complain "'stylut $*' fails with memory enough"
  count=$(cat "$BATS_TEST_TMPDIR/count")
  rm -rf made made.*
  expect_less "places where 'stylut $*' asks for memory" 1 "$count"
  step=1
  [ "$places" = 0 ] || step=$(((count + places - 1) / places))
  for ((k = 1 + RANDOM % step; k <= count; k += step)); do
    status=0
    FAIL_ALLOCATION=$k LD_PRELOAD=$library "$STYLUT" "$@" -j 1 >out 2>said || status=$?
    if [ $status = 0 ]; then
      grep -q error said && complain "'stylut $*', allocation $k: passes, and says $(cat said)"
    else
      [ $status = 4 ] || complain "'stylut $*', allocation $k of $count: exit $status, $(cat said)"
      [ "$(grep -c '^stylut: error: ' said)" = 1 ] || complain "'stylut $*', allocation $k: said '$(cat said)'"
      [ -e made ] || [ -e made.exr ] || [ -e made.png ] || [ -e made.html ] && complain "'stylut $*', allocation $k: leaves its output"
    fi
    rm -rf out said made made.*
    [ "$(find . | sort)" = "$before" ] ||
      complain "'stylut $*', allocation $k: left $(diff <(echo "$before") <(find . | sort) | grep '^>' | tr '\n' ' ')"
  done
}

@test "allocations that fail: guides" {
  bring_all
  starve guide sphere -s 12 -o made.exr
  starve guide scene scene.json -s 12 -c normal,depth,object,luma -o made.exr
  starve guide scene spike.obj -s 12 --repair --simplify 2 -o made.exr
  starve guide import guide.png --as png -o made.exr
  starve guide strokes oil.png -o made.exr
  starve guide warp pairs.json -o made.exr
  starve guide flow oil.png oil.png -o made.exr
}

@test "allocations that fail: tables" {
  bring_all
  starve lut guide.exr -s 16 -o made.exr
  starve lut guide.exr -s 16 -e brute --resolve coherent -o made.exr
  starve check lut.exr --guide guide.exr
  starve report lut.exr --guide guide.exr -o made.html
  starve probe lut.exr --guide guide.exr 0.1 0.2
  starve match guide.exr guide.exr --channels normal -o made.exr
  starve compare guide.exr guide.exr
}

@test "allocations that fail: bundles and pictures" {
  bring_all
  starve pack m.json -o made
  starve params bundle --set radius=2 --dry-run
  starve unpack bundle -o made
  starve validate bundle
  starve info bundle
  starve info guide.exr
  starve stylize bundle --guide guide.exr -o made.png
  starve stylize bundle --guide guide.exr --resolution half -o made.png
  starve toon --guide guide.exr --texture hatch -o made.png
  starve outline --guide guide.exr -o made.png
}

# press COMMAND...: however little room there is for addresses, it passes or says so in one line.
press() {
  local megabytes status passed=0
  for megabytes in 60 70 76 80 90 100 150 200 300 400 500 600 700 800 900 1000 1200 1500 2000 4000; do
    status=0
    (ulimit -v $((megabytes * 1000)) && exec "$STYLUT" "$@" -q) >out 2>said || status=$?
    rm -rf made made.*
    case $status in
      0) passed=$((passed + 1)) ;;
      4)
        [ "$(grep -c '^stylut: error: ' said)" = 1 ] && [ "$(wc -l <said)" = 1 ] ||
          complain "'stylut $*' in $megabytes MB: said '$(cat said)'"
        ;;
      127) [ $passed = 0 ] || complain "'stylut $*' in $megabytes MB: can't be loaded" ;; # the loader's word, before our first
      *) complain "'stylut $*' in $megabytes MB: exit $status, $(cat said)" ;;
    esac
  done
  expect_less "limits under which 'stylut $*' passes" 0 $passed
}

@test "addresses that run out (ulimit -v)" {
  bring_all
  press guide sphere -s 256 -o made.exr
  press guide scene "$exemplars/creature.ply" -s 200 -o made.exr
  press guide scene scene.json -s 100 -o made.exr
  press lut guide.exr -s 512 -o made.exr
  press lut guide.exr -s 64 -e flann-single -o made.exr
  press check lut.exr --guide guide.exr
  press pack m.json -o made
  press params bundle
  press stylize bundle --guide guide.exr -o made.png
  press batch m.json -o made
}
