#!/usr/bin/env bats
# stylut stylize: sequences, methods, resolutions, flicker, measures.
load helpers

# Six frames of the creature turning, a bundle of two styles with four jitter tables' worth of room, all small.
setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  local i
  printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "oil", "exemplar": "oil.png" } ] }\n' >styles.json
  cp "$STYLUT_ROOT/exemplars/spheres/oil.png" .
  "$STYLUT" pack styles.json -o bundle -q
  for i in 1 2 3 4 5 6; do
    "$STYLUT" guide scene "$STYLUT_ROOT/exemplars/creature.ply" --view "$((10 + i)),10" -s 160 -c normal,depth,object \
      -o "f.$(printf %04d "$i").exr" -q
  done
}

# take: the frames and the bundle, as links.
take() { ln -s "$BATS_FILE_TMPDIR"/f.*.exr "$BATS_FILE_TMPDIR/bundle" .; }

@test "one frame of a sequence, pixels as of the picture, and what is asked for in vain" {
  take
  accept stylize bundle --guide 'f.%04d.exr' --frames 3 -o 'a.%04d.png'
  expect frames "$(ls a.*.png)" a.0003.png
  accept stylize bundle --guide f.0001.exr -o full.png --format json
  local full=$output
  printf '%s\n' "$full" >full.json
  printf '%s\n' "$("$STYLUT" stylize bundle --guide f.0001.exr -o small.png --resolution double --format json)" >small.json
  expect size "$(json small.json 'r.size.join()')" 80,80
  expect_less 'a quarter of the pixels, or nearly' "$(json full.json "Math.abs(r.covered / 4 - $(json small.json r.covered))")" 200
  refuse 1 "expected a style's name ('oil') or a number from 1 to 1" stylize bundle --guide f.0001.exr -o x.png --style olive
  refuse 1 'expected it with --method styleblit or brute' stylize bundle --guide f.0001.exr -o x.png --method lit-sphere --chunks c.png
  refuse 3 "found a scene, expected a guide, as 'stylut guide scene' makes of one" stylize bundle --guide "$STYLUT_ROOT/exemplars/creature.ply" -o x.png
  refuse 1 "'hash', expected hatch, noise or a picture's name" toon --guide f.0001.exr --texture hash -o x.png
  refuse 1 "expected no place for a number: one frame's guide" toon --guide 'f.%04d.exr' -o x.png
  refuse 1 "expected no place for a number: one frame's guide" outline --guide 'f.%04d.exr' -o x.png
  accept outline --guide f.0001.exr --colour '#ff0000' --no-history -o a.png
  accept outline --guide f.0001.exr --colour ff0000 --no-history -o b.png
  expect_same a.png b.png
}

@test "a sequence is its frames, whatever the threads" {
  take
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --chunks 'c.%d.png' --nnf 'n.%02d.png' -j 1 -q
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' -j 2 --no-history -q
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'e.%04d.png' -j 1 --no-history -q
  for i in 1 2 3 4 5 6; do
    "$STYLUT" stylize bundle --guide "f.000$i.exr" -o single.png --no-history -q
    expect_same "b.000$i.png" single.png
    expect_same "b.000$i.png" "e.000$i.png"
    "$STYLUT" compare "a.000$i.png" single.png -q || complain "frame $i differs from the one drawn alone"
    [ -s "c.$i.png" ] || complain "no chunks of frame $i"
    [ -s "n.0$i.png" ] || complain "no field of frame $i"
  done
  expect_other b.0001.png b.0002.png
}

@test "what is there is kept, what is missing, changed or of another command is drawn" {
  take
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' -q
  sha256sum a.*.png >sums
  rm a.0003.png
  expect_holds 'after one is gone' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png')" '1 frame drawn, 5 kept'
  sha256sum --quiet -c sums || complain 'the frame drawn anew is another'
  rm f.0002.exr && cp f.0001.exr f.0002.exr
  expect_holds 'after a guide changed' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png')" '1 frame drawn, 5 kept'
  expect_holds 'another command' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --resolution half)" '6 frames drawn, 0 kept'
  expect_holds 'forced' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --resolution half --force)" '6 frames drawn, 0 kept'
  : >a.0004.png
  expect_holds 'after one was cut off' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --resolution half)" '1 frame drawn, 5 kept'
}

@test "what is written is no input, nothing else that is written, and kept only for what it shows" {
  take
  cp f.0001.exr frame.exr
  "$STYLUT" guide sphere -q -s 32 -o n.0001.png
  cp n.0001.png n.0002.png
  sha256sum n.* bundle/* >before
  local name
  for name in 'n.%04d.png' './n.%04d.png' 'n.%d.png' "$PWD/n.%04d.png"; do
    refuse 1 'which is an input' stylize bundle --guide 'n.%04d.png' -o "$name"
    refuse 1 "'--nnf': found $name, which is an input" stylize bundle --guide 'n.%04d.png' -o 'o.%04d.png' --nnf "$name"
  done
  for name in bundle.json luts.ktx2 import-settings.json; do
    refuse 1 "'--measure': found bundle/$name, which is an input" stylize bundle --guide frame.exr -o o.png --measure "bundle/$name"
  done
  refuse 1 'twice' stylize bundle --guide frame.exr -o o.png --measure o.png
  refuse 1 'twice' stylize bundle --guide frame.exr -o o.png --chunks ./o.png
  sha256sum --check --quiet before
  accept stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --chunks 'c.%04d.png'
  expect_holds 'chunks are no picture' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'c.%04d.png')" '6 frames drawn, 0 kept'
  expect_holds 'nor flat areas' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --flat 'c.%04d.png')" '6 frames drawn, 0 kept'
  expect_holds 'which are kept then' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --flat 'c.%04d.png')" '0 frames drawn, 6 kept'
}

@test "a run that is killed goes on to the same bytes" {
  take
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' -q
  for delay in 0.05 0.15 0.3; do
    "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' -j 1 -q &
    sleep "$delay"
    kill -9 $! 2>/dev/null || true
    wait $! 2>/dev/null || true
  done
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' -q
  for i in 1 2 3 4 5 6; do
    "$STYLUT" compare "a.000$i.png" "b.000$i.png" -q || complain "frame $i differs after kills"
  done
}

@test "ranges, gaps and frames that are missing" {
  take
  rm f.0004.exr
  refuse 2 f.0004.exr stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png'
  expect_holds 'skipping' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --skip-missing)" '5 frames drawn, 0 kept, 1 missing'
  expect_holds 'a range' "$("$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --frames 1-5x2)" '3 frames drawn'
  expect 'files of the range' "$(echo b.*.png)" 'b.0001.png b.0003.png b.0005.png'
  refuse 2 f.0007.exr stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --frames 5-9
  refuse 2 'g.%d.exr' stylize bundle --guide 'g.%d.exr' -o 'b.%04d.png'
  refuse 1 6-5 stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --frames 6-5
  refuse 1 1-5x0 stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --frames 1-5x0
  refuse 1 one.png stylize bundle --guide 'f.%04d.exr' -o one.png
  refuse 1 'b.%d.png' stylize bundle --guide f.0001.exr -o 'b.%d.png'
  refuse 1 'f.%s.exr' stylize bundle --guide 'f.%s.exr' -o 'b.%d.png'
  refuse 1 frames stylize bundle --guide f.0001.exr -o b.png --frames 1-2
  refuse 1 'at most 1000000' stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --frames 0-999999999 --skip-missing
  mkdir d0001
  ln -s "$BATS_FILE_TMPDIR/f.0001.exr" d0001/f.exr
  refuse 1 'expected --frames then' stylize bundle --guide 'd%04d/f.exr' -o 'e.%04d.png'
  accept stylize bundle --guide 'd%04d/f.exr' -o 'e.%04d.png' --frames 1-1
  expect_holds 'one frame' "$output" '1 frame drawn'
}

@test "nothing flickers unless asked for, and then as often as asked for" {
  take
  rm f.*.exr
  for i in 1 2 3 4 5 6; do cp "$BATS_FILE_TMPDIR/f.0001.exr" "f.000$i.exr"; done
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --no-history -q
  for i in 2 3 4 5 6; do expect_same a.0001.png "a.000$i.png"; done
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --no-history --flicker 12 2>said >text
  expect_same a.0001.png b.0001.png
  "$STYLUT" pack "$BATS_FILE_TMPDIR/styles.json" --jitter-frames 4 -q -o four
  "$STYLUT" stylize four --guide 'f.%04d.exr' -o 'd.%04d.png' --no-history --flicker 12 -q
  expect_same d.0002.png d.0003.png
  expect_same d.0004.png d.0005.png
  expect 'drawings of six frames' "$(sha256sum d.000?.png | cut -d ' ' -f 1 | sort -u | wc -l)" 4
  expect_holds 'flicker with one table' "$(cat said)" "style 'oil': found a jitter_period and one jitter table"
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'c.%04d.png' --no-history --flicker 0 2>said >text
  expect 'what is said of none' "$(cat said)" ''
  expect_same a.0001.png c.0006.png
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'c.%04d.png' --set luma_weight=1 2>said >text
  expect_holds 'light and one exemplar' "$(cat said)" 'found a luma_weight and one exemplar'
  refuse 1 7 stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --flicker 7
  refuse 1 fps stylize bundle --guide 'f.%04d.exr' -o 'b.%04d.png' --fps 12
  refuse 1 flicker stylize bundle --guide f.0001.exr -o b.png --flicker 12
}

# overall KEY FILE: the mean of a measure over all frames.
overall() { sed -n '/overall/,$p' "$2" | grep -o "\"$1\": [0-9.e-]*" | head -1; }

@test "measures of a still sequence and of a turning one" {
  take
  rm f.*.exr
  for i in 1 2 3; do
    for kind in still turning; do
      printf '{ "schema": "stylut-scene/1",
        "camera": { "type": "orthographic", "position": [%s,0,3], "target": [0,0,0], "height": 2.2 },
        "spheres": [ { "center": [0,0,0], "radius": 0.9 }, { "center": [0.4,0,0.6], "radius": 0.4 } ] }' \
        "$([ $kind = still ] && echo 0 || echo "0.0$i")" >"$kind.$i.json"
      "$STYLUT" guide scene "$kind.$i.json" --previous "$kind.$((i > 1 ? i - 1 : 1)).json" -s 160 \
        -c normal,depth,object,motion -q -o "$kind.$i.exr"
    done
  done
  "$STYLUT" stylize bundle --guide 'turning.%d.exr' -o 'a.%d.png' --measure turning.json >text 2>said
  for figure in warp_mean warp_rms jumps ssim flip chunk_mean chunk_weighted fallback flat; do
    grep -q "^$figure " text || complain "no $figure in the text"
    [ -n "$(overall "$figure" turning.json)" ] || complain "no $figure in the file"
  done
  expect 'what is said of a whole sequence' "$(cat said)" ''
  expect 'frames measured' "$(grep -c '"frame":' turning.json)" 3
  "$STYLUT" stylize bundle --guide 'still.%d.exr' -o 's.%d.png' --measure still.json -q
  for key in warp_mean flip jumps; do expect "$key of a still sequence" "$(overall $key still.json)" "\"$key\": 0.0"; done
  # Motion is known to the frame before alone.
  "$STYLUT" stylize bundle --guide 'turning.%d.exr' -o 'a.%d.png' --measure steps.json --frames 1-3x2 2>said >text
  expect_holds 'what is said of a frame left out' "$(cat said)" 'found 0 of 2 frames with motion.U'
  expect 'jumps over a gap' "$(overall jumps steps.json)" ''
  refuse 1 measure stylize bundle --guide 'still.%d.exr' -o 'a.%d.png' --resolution double --measure m.json
  refuse 1 m.%d.json stylize bundle --guide 'still.%d.exr' -o 'a.%d.png' --measure m.%d.json
}

@test "without motion nothing is said of it; what many frames lack is said once" {
  take
  "$STYLUT" stylize bundle --guide 'f.%04d.exr' -o 'a.%04d.png' --measure m.json --set colour_weight=0.5 2>said >text
  expect 'jumps' "$(overall jumps m.json)" ''
  expect 'warnings' "$(cat said)" "stylut: warning: f.0001.exr: found no channel albedo, which colours, expected it for style 'oil'
stylut: warning: f.%04d.exr: found no albedo in 5 more frames
stylut: warning: f.%04d.exr: found 0 of 6 frames with motion.U and motion.V and the frame before, expected them of all but the first for warp_mean, warp_rms and jumps"
}

@test "methods and resolutions" {
  take
  "$STYLUT" stylize bundle --guide f.0001.exr -o full.png --no-history -q
  "$STYLUT" stylize bundle --guide f.0001.exr -o half.png --no-history -q --resolution half
  "$STYLUT" stylize bundle --guide f.0001.exr -o double.png --no-history -q --resolution double
  "$STYLUT" stylize bundle --guide f.0001.exr -o sphere.png --no-history -q --method lit-sphere
  "$STYLUT" stylize bundle --guide f.0001.exr -o brute.png --no-history -q --method brute
  expect_other full.png half.png
  expect_other full.png sphere.png
  expect_other full.png brute.png
  expect_holds 'size at half resolution' "$("$STYLUT" info half.png)" 160x160
  expect_holds 'size at double resolution' "$("$STYLUT" info double.png)" 80x80
  for unit in plain avx2 avx512; do
    STYLUT_VECTOR=$unit "$STYLUT" stylize bundle --guide f.0001.exr -o "$unit.png" --no-history -q
    expect_same full.png "$unit.png"
  done
  refuse 1 resolution stylize bundle --guide f.0001.exr -o b.png --method brute --resolution half
  "$STYLUT" guide sphere -s 301x300 -o odd.exr -q 2>/dev/null || "$STYLUT" guide sphere -s 301 -o odd.exr -q
  refuse 3 odd.exr stylize bundle --guide odd.exr -o b.png --resolution double
  "$STYLUT" guide sphere -s 1024 -o large.exr -q
  refuse 3 large.exr stylize bundle --guide large.exr -o b.png --method brute
}

# paint CHANNEL VALUE: a frame of six by six pixels with one more channel, all of that value.
paint() {
  oiiotool --create 6x6 4 --fill:color=0,0,1,1 6x6 --chnames normal.X,normal.Y,normal.Z,A \
    --create 6x6 1 --addc "$2" --chnames "$1" --chappend -d float -o painted.exr
}

@test "values that no frame can have" {
  take
  for channel in style.I object.I luma.Y; do
    paint $channel nan
    refuse 3 "found nan in $channel at (0, 0)" stylize bundle --guide painted.exr -o a.png
  done
  for id in 300 -1 1.5 256; do
    paint style.I $id
    accept_warned 'found 36 pixels whose style.I the bundle has no style for' stylize bundle --guide painted.exr -o a.png
    paint object.I $id
    [ $id = 300 ] || [ $id = 256 ] || accept_warned 'found 36 pixels whose object.I is no whole number' stylize bundle --guide painted.exr -o a.png
  done
  paint object.I 70000
  accept_warned 'found 36 pixels whose object.I is no whole number' stylize bundle --guide painted.exr -o a.png
  STYLUT_VECTOR=nonsense refuse 1 nonsense stylize bundle --guide painted.exr -o b.png
}
