#!/usr/bin/env bats
# stylut stylize --anchor: pieces that ride on objects.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" pack "$exemplars/styles.json" -o bundle -q
  # All in eighths, so that a move by whole pixels changes no bit of what is traced.
  awk 'BEGIN {
    for (i = 0; i < 17; i++) for (k = 0; k < 17; k++) {
      x = i / 2 - 4; y = k / 2 - 4
      printf "v %g %g %g\n", x, y, int((32 - x * x - y * y) / 8 * 8 + 0.5) / 8
    }
    for (i = 0; i < 16; i++) for (k = 1; k < 17; k++) {
      a = i * 17 + k
      printf "f %d %d %d %d\n", a, a + 17, a + 18, a + 1
    } }' >dome.obj
  draw start 0 0 9
  draw moved 5 -3 9
  draw beside 5 -3 5
  draw behind 5 -3 1.5
}

# draw NAME DX DY X: the dome (object 1) so many pixels from its place, the ball (object 2) at X; two small balls hold the
# scene's bounds.
draw() {
  awk -v dx="$2" -v dy="$3" -v at="$4" 'BEGIN {
    printf "{ \"schema\": \"stylut-scene/1\","
    printf "  \"camera\": { \"type\": \"orthographic\", \"position\": [0,0,32], \"target\": [0,0,0], \"height\": 16 },"
    printf "  \"objects\": [ { \"mesh\": \"dome.obj\", \"transform\": [1,0,0,%g, 0,1,0,%g, 0,0,1,0, 0,0,0,1] } ],", dx / 8 - 3, -dy / 8
    printf "  \"spheres\": [ { \"center\": [%g,0.5,-4], \"radius\": 3 },", at
    printf "    { \"center\": [-15,-7,-15], \"radius\": 1 }, { \"center\": [15,7,15], \"radius\": 1 } ] }" }' >"$1.json"
  "$STYLUT" guide scene "$1.json" -s 256x128 -c normal,depth,object -o "$1.exr" -q
}

# wear NAME OPTION...: NAME.png, NAME.16.png and NAME.nnf.png
wear() {
  accept stylize bundle --style oil --guide "$1.exr" --nnf "$1.nnf.png" -o "$1.png" "${@:2}"
  accept stylize bundle --style oil --guide "$1.exr" --bits 16 -o "$1.16.png" "${@:2}"
}

# list NAME FILE CHANNELS DX DY [WITHIN]: the values of FILE where NAME.exr shows the dome, moved back; at least WITHIN
# pixels from other objects.
list() {
  paste -d' ' <(dump "$1.exr" object.I) <(dump "$2" "$3" | cut -d' ' -f3-) | awk -v dx="$4" -v dy="$5" -v within="${6:-0}" '
    { id[$1, $2] = $3; line[$1, $2] = substr($0, index($0, $4)) }
    function is_apart(x, y,   i, k) {
      for (i = -within; i <= within; i++) for (k = -within; k <= within; k++) if (id[x + i, y + k] > 1) return 0
      return 1
    }
    END { for (y = 0; y < 128; y++) for (x = 0; x < 256; x++)
      if (id[x, y] == 1 && is_apart(x, y)) print x - dx, y - dy, line[x, y] }'
}

# count_others A B: lines of B that A lacks.
count_others() { sort "$1" >sorted.a; sort "$2" | comm -13 sorted.a - | wc -l; }

# expect_moved NAME WITHIN: start's pixels and matches, moved.
expect_moved() {
  local file
  for file in exr png 16.png nnf.png; do
    local channels=R,G,B,A within=0
    [ $file = exr ] && channels=A,normal.X,normal.Y,normal.Z,depth.Z
    [[ $file = *png && $file != nnf.png ]] && within=$2
    list start "start.$file" $channels 0 0 >start.txt
    list "$1" "$1.$file" $channels 5 -3 "$within" >"$1.txt"
    expect_less "$1.$file: pixels compared" 2500 "$(wc -l <"$1.txt")"
    expect "$1.$file: pixels that differ" "$(count_others start.txt "$1.txt")" 0
  done
}

@test "pivots in the metadata of a scene's guide" {
  bring '*'
  # 8 pixels a unit, from (128, 64); the dome's middle is where it was put.
  accept info start.exr
  expect_holds start "$output" 'stylut:pivots = 1 104 64; 2 200 60; 3 8 120; 4 248 8'
  accept info moved.exr
  expect_holds moved "$output" 'stylut:pivots = 1 109 61; 2 200 60;'
  accept guide scene start.json -s 64 -c normal,depth -o plain.exr
  accept info plain.exr
  [[ $output != *pivots* ]] || complain 'a guide without objects has pivots'
  accept guide scene start.json -s 64 -c normal,object --no-history -o bare.exr
  accept info bare.exr
  expect_holds 'without history' "$output" 'stylut:pivots = 1'
}

@test "an object that moves by whole pixels takes its pieces along" {
  bring '*'
  local name
  for name in start moved beside behind; do wear $name --anchor object; done
  expect_moved moved 0
  expect_moved beside 0
  expect_moved behind 1 # blending mixes colours across the border
}

@test "toon's cells ride along as well" {
  bring '*'
  local name
  for name in start moved; do
    accept toon --guide $name.exr --texture hatch --cell 16 --anchor object -o $name.toon.png
    accept toon --guide $name.exr --texture hatch --cell 16 -o $name.still.png
  done
  list start start.toon.png R,G,B,A 0 0 >start.txt
  list moved moved.toon.png R,G,B,A 5 -3 >moved.txt
  expect_less 'pixels compared' 2500 "$(wc -l <moved.txt)"
  expect 'pixels that differ' "$(count_others start.txt moved.txt)" 0
  list start start.still.png R,G,B,A 0 0 >start.txt
  list moved moved.still.png R,G,B,A 5 -3 >moved.txt
  expect_less 'pixels that differ on the screen' 100 "$(count_others start.txt moved.txt)"
  printf '{ "schema": "stylut-pivots/1", "pivots": { "1": [104, 64], "2": [200, 60], "3": [8, 120], "4": [248, 8] } }' >own.json
  accept toon --guide start.exr --texture hatch --cell 16 --anchor object --pivots own.json --no-history -o json.png
  accept toon --guide start.exr --texture hatch --cell 16 --anchor object --no-history -o own.png
  expect_same json.png own.png
  refuse 1 --anchor toon --guide start.exr --anchor object -o out.png
  refuse 1 --pivots toon --guide start.exr --texture hatch --pivots own.json -o out.png
}

@test "on the screen it swims" {
  bring '*'
  local name
  for name in start moved; do wear $name; done
  list start start.nnf.png R,G 0 0 >start.txt
  list moved moved.nnf.png R,G 5 -3 >moved.txt
  expect_less 'matches that differ' 500 "$(count_others start.txt moved.txt)"
  accept stylize bundle --style oil --guide start.exr --anchor screen --nnf screen.png -o out.png --no-history
  accept stylize bundle --style oil --guide start.exr --nnf plain.png -o out.png --no-history
  expect_same plain.png screen.png
}

@test "pivots from JSON, rounded half up" {
  bring '*'
  wear_with() { # NAME PIVOTS
    printf '{ "schema": "stylut-pivots/1", %s }' "$2" >"$1.json"
    accept stylize bundle --style oil --guide start.exr --anchor object --pivots "$1.json" --nnf "$1.png" -o out.png --no-history
  }
  accept stylize bundle --style oil --guide start.exr --anchor object --nnf own.png -o out.png --no-history
  wear_with same '"pivots": { "2": [200, 60], "1": [104, 64], "4": [248, 8], "3": [8, 120] }'
  expect_same own.png same.png
  wear_with half '"frames": { "1": {}, "0": { "1": [103.5, 63.5], "2": [200.499, 59.5], "3": [8, 120], "4": [248, 8] } }'
  expect_same own.png half.png
  wear_with less '"pivots": { "1": [103.499, 64], "2": [200, 60], "3": [8, 120], "4": [248, 8] }'
  expect_other own.png less.png
  wear_with none '"pivots": {}'
  expect_other own.png none.png
}

@test "pans and turns in perspective" {
  bring bundle
  local k turn names=()
  for k in 0 1 2; do
    turn=$(awk -v k=$k 'BEGIN { c = cos(k / 57.3); s = sin(k / 57.3); printf "%.6f,0,%.6f,%.6f, 0,1,0,0, %.6f,0,%.6f,0", c, s, k * 0.01, -s, c }')
    printf '{ "schema": "stylut-scene/1", "camera": { "type": "perspective", "position": [0,0,5], "target": [0,0,0] },
      "objects": [ { "mesh": "%s/creature.ply", "transform": [%s, 0,0,0,1] } ], "spheres": [ { "center": [1,1,9], "radius": 1 } ] }' \
      "$exemplars" "$turn" >"$k.json"
    accept guide scene $k.json -s 160x120 -c normal,depth,object -o "$k.exr"
    accept stylize bundle --guide "$k.exr" --anchor object -o "$k.png"
    accept info "$k.exr"
    names+=("$(sed -n 's/.*pivots = //p' <<<"$output")")
  done
  expect_match 'the first pivot, without the sphere behind the camera' "${names[0]}" '^1 [-0-9.]+ [-0-9.]+$'
  expect 'pivots in all' "$(printf '%s\n' "${names[@]}" | sort -u | wc -l)" 3
}

@test "wrong anchors" {
  bring bundle start.exr
  accept guide scene "$exemplars/creature.ply" -s 64 -c normal -o plain.exr
  printf '{ "schema": "stylut-pivots/1", "pivots": { "1": [5, 6] } }' >p.json
  printf '{ "schema": "stylut-pivots/1", "frames": { "3": { "1": [5, 6] } } }' >frames.json
  printf '{ "schema": "stylut-pivots/1",\n  "pivots": { "1": [5] } }' >bad.json
  local stylize=(stylize bundle --guide start.exr -o out.png)
  refuse 1 --anchor "${stylize[@]}" --anchor sky
  refuse 1 --pivots "${stylize[@]}" --pivots p.json
  refuse 1 --pivots "${stylize[@]}" --anchor screen --pivots p.json
  refuse 2 missing.json "${stylize[@]}" --anchor object --pivots missing.json
  refuse 3 'bad.json:2:20: pivots.1: found a list of 1' "${stylize[@]}" --anchor object --pivots bad.json
  refuse 3 'frames.json: found no frame 0, expected the pivots of start.exr' "${stylize[@]}" --anchor object --pivots frames.json
  refuse 3 'plain.exr: found no channel object.I' stylize bundle --guide plain.exr -o out.png --anchor object --pivots p.json
  oiiotool start.exr --eraseattrib stylut:pivots -o bare.exr
  refuse 3 "bare.exr: found no objects' pivots" stylize bundle --guide bare.exr -o out.png --anchor object
  oiiotool start.exr --attrib stylut:pivots '1 x' -o odd.exr
  refuse 3 "odd.exr: found '1 x' in stylut:pivots" stylize bundle --guide odd.exr -o out.png --anchor object
}
