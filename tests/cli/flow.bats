#!/usr/bin/env bats
# stylut guide flow: motion between two pictures.
load helpers

# cut_out FILE OUT X Y [WxH]: a piece of a picture, whose place is the motion.
cut_out() { oiiotool --no-autopremult "$1" --cut "${5:-160x120}+$3+$4" -o "$2"; }

# truth OUT U V [WxH]: the same motion everywhere.
truth() { oiiotool --pattern constant:color=1,"$2","$3" "${4:-160x120}" 3 --chnames A,motion.U,motion.V -d float -o "$1"; }

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  cut_out "$exemplars/spheres/charcoal.png" now.png 170 190
  cut_out "$exemplars/spheres/charcoal.png" before.png 165 193
  oiiotool now.png --ch R,G,B -d uint16 -o now16.png
  oiiotool before.png --ch R,G,B -d float -o before.exr
  truth truth.exr 5 -3
}

# A grey picture of 96x64 by an awk expression of x and y, 0..255.
draw_grey() { # OUT EXPRESSION
  awk "BEGIN { print \"P2 96 64 255\"; for (y = 0; y < 64; y++) for (x = 0; x < 96; x++) print int($2) }" >grey.pgm
  oiiotool grey.pgm -d uint8 -o "$1"
  rm grey.pgm
}

# Percent of the pixels 12 from the border and more whose motion isn't U V, or off it by more than a pixel,
# of a flow of 160x120.
count_wrong() { dump "$1" motion.U,motion.V | awk -v u="$2" -v v="$3" '
  $1 >= 12 && $1 < 148 && $2 >= 12 && $2 < 108 { n++; d = ($3 - u) ^ 2 + ($4 - v) ^ 2; wrong += d > 0; far += d > 1 }
  END { printf "%.2f %.2f", 100 * wrong / n, 100 * far / n }'; }
check_wrong() { # FILE U V MOST MOST-BY-A-PIXEL
  local found
  found=$(count_wrong "$1" "$2" "$3")
  expect_less "$1: percent of wrong pixels" "${found% *}" "$4"
  expect_less "$1: percent off by a pixel" "${found#* }" "$5"
}

@test "how painted strokes moved is found to the pixel, in every format" {
  bring '*.png' '*.exr'
  local pair style
  for pair in 'now.png before.png' 'now16.png before.png' 'now.png before.exr'; do
    # shellcheck disable=SC2086
    accept guide flow $pair -o flow.exr
    check_wrong flow.exr 5 -3 1.5 1
  done
  accept info flow.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" A,motion.U,motion.V,origin.I,residual.Y
  expect size "$(json - 'r.size' <<<"$output")" '[160,120]'
  # The other way round.
  accept guide flow before.png now.png -o back.exr
  check_wrong back.exr -5 3 1.5 1
  # Oil is the hardest: all strokes, hardly anything larger.
  for style in oil pencil stipple watercolour; do
    cut_out "$exemplars/spheres/$style.png" a.png 170 190
    cut_out "$exemplars/spheres/$style.png" b.png 165 193
    accept guide flow a.png b.png -o $style.exr
    check_wrong $style.exr 5 -3 12 10
  done
}

@test "the report: figures of the flow, and its error against the true motion" {
  bring '*.png' '*.exr'
  accept guide flow now.png before.png --motion truth.exr --consistency -o flow.exr --format json
  expect schema "$(json - r.schema <<<"$output")" stylut-flow/1
  expect keys "$(json - 'Object.keys(r).sort().join()' <<<"$output")" ambiguous,channels,consistency,covered,error,inherited,levels,matched,method,motion,peak_bytes,radius,residual_levels,schema,size,time_ms,unknown,untextured
  expect 'keys of the error' "$(json - 'Object.keys(r.error).sort().join()' <<<"$output")" above_1,above_3,angular_degrees,end_point,mean_truth,pixels,relative,truth
  expect 'how' "$(json - '[r.method, r.levels, r.radius, r.channels, r.covered].join()' <<<"$output")" coarse-to-fine,5,2,R,G,B,19200
  expect 'sum of shares' "$(json - '(r.matched + r.inherited + r.unknown).toFixed(9)' <<<"$output")" 1.000000000
  expect_near 'true motion' "$(json - r.error.mean_truth <<<"$output")" 5.8309519 1e-6
  expect_near 'median error' "$(json - 'r.error.end_point.p50 + " " + r.error.angular_degrees.p50' <<<"$output")" '0 0' 1e-9
  expect_less 'mean error' "$(json - r.error.end_point.mean <<<"$output")" 0.5
  expect_near relative "$(json - 'r.error.relative - r.error.end_point.mean / r.error.mean_truth' <<<"$output")" 0 1e-9
  expect_less 'inconsistent' "$(json - r.consistency.inconsistent <<<"$output")" 0.08
  # The figures are those of the file.
  expect 'error, as the file has it' "$(json - 'r.error.end_point.mean.toFixed(4) + " " + r.error.above_1.toFixed(6)' <<<"$output")" \
    "$(dump flow.exr motion.U,motion.V | awk '{ d = sqrt(($3 - 5) ^ 2 + ($4 + 3) ^ 2); s += d; a += d > 1 } END { printf "%.4f %.6f", s / NR, a / NR }')"
  expect 'inconsistent, as the file has it' "$(json - 'r.consistency.inconsistent.toFixed(6)' <<<"$output")" \
    "$(dump flow.exr consistency.Y | awk '$3 >= 0 { n++; i += $3 > 1 } END { printf "%.6f", i / n }')"
  accept guide flow now.png before.png --motion truth.exr --consistency -o flow.exr
  local part
  for part in 'flow.exr: 160x120, 100.0 % covered; coarse-to-fine, 5 levels, radius 2, by R,G,B' 'motion      mean 5.' 'ambiguous   ' \
    'consistency mean ' 'against truth.exr: 19200 pixels, mean motion 5.8310 pixels' 'end-point   mean 0.' 'angular     mean '; do
    expect_holds report "$output" "$part"
  done
  accept guide flow now.png before.png -o flow.exr -q
  expect 'quiet report' "$output" ''
}

@test "rest, and what looks like it: pictures of one colour, stripes along themselves, turning circles" {
  bring '*.png'
  accept guide flow now.png now.png -o rest.exr --format json
  expect 'longest motion at rest' "$(json - 'r.motion.max + " " + r.residual_levels' <<<"$output")" '0 0'
  draw_grey one.png 100
  draw_grey stripes.png '127.5 + 100 * sin(y * 3.14159265 / 8) + 0.5'
  draw_grey up.png '127.5 + 100 * sin((y + 3) * 3.14159265 / 8) + 0.5'
  draw_grey circles.png '127.5 + 100 * sin(sqrt((x - 47.5) ^ 2 + (y - 31.5) ^ 2) * 3.14159265 / 8) + 0.5'
  truth across.exr 3 0 96x64
  accept guide flow one.png one.png --motion across.exr -o flow.exr
  expect_holds 'one colour' "$output" 'ambiguous   100.00 %, of which without texture 100.00 %'
  expect_holds 'one colour' "$output" 'nowhere 100.00 %'
  expect_holds 'one colour' "$output" 'relative 100.00 %'
  expect 'motion of one colour' "$(dump flow.exr motion.U count) $(dump flow.exr motion.V count) $(dump flow.exr origin.I count)" '0 0 0'
  # Stripes along themselves give the very picture again, and rest is all that anyone can see.
  accept guide flow stripes.png stripes.png --motion across.exr -o flow.exr --format json
  expect 'stripes along' "$(json - '[r.error.relative, r.ambiguous, r.untextured, r.motion.max].join()' <<<"$output")" 1,1,0,0
  # Across, motion is found, and still a pixel to the left or right would do.
  truth down.exr 0 3 96x64
  accept guide flow up.png stripes.png --motion down.exr -o flow.exr --format json
  expect 'stripes across' "$(json - '[r.error.end_point.p50.toFixed(1), r.ambiguous].join()' <<<"$output")" 0.0,1
  # So do circles around their centre: here nothing even warns of it.
  oiiotool --pattern constant:color=1,2,2 96x64 3 --chnames A,motion.U,motion.V -d float -o turn.exr
  accept guide flow circles.png circles.png --motion turn.exr -o flow.exr --format json
  expect 'circles' "$(json - 'r.error.relative.toFixed(6) + " " + r.motion.max' <<<"$output")" '1.000000 0'
  expect_less 'ambiguous circles' "$(json - r.ambiguous <<<"$output")" 0.3
}

@test "guides: coverage, layers, and channels by name" {
  accept guide scene "$exemplars/creature.ply" -s 100x90 -c normal,depth,luma -o g.exr
  cut_out g.exr now.exr 2 0 90x90
  cut_out g.exr before.exr 0 0 90x90
  accept guide flow now.exr before.exr -o flow.exr --format json
  expect 'default of guides' "$(json - r.channels <<<"$output")" luma.Y
  accept guide flow now.exr before.exr -c normal -o flow.exr --format json
  expect 'a layer' "$(json - r.channels <<<"$output")" normal.X,normal.Y,normal.Z
  expect 'covered, as the file has it' "$(dump flow.exr A count)" "$(dump now.exr A count)"
  expect 'covered' "$(json - r.covered <<<"$output")" "$(dump now.exr A count)"
  dump flow.exr A,motion.U,motion.V,residual.Y,origin.I | awk '
    $3 == 0 { if ($4 || $5 || $6 || $7) { print "moves: " $0; exit } }
    $3 == 1 { n++; right += $4 == 2 && $5 == 0 }
    END { if (right < 0.97 * n) print right " of " n " are right" }' >wrong.txt
  expect 'wrong' "$(cat wrong.txt)" ''
  accept guide flow now.exr before.exr -c normal,luma.Y -o flow.exr
  refuse 1 'more than 4' guide flow now.exr before.exr -c normal,depth,luma -o out.exr
  # Infinite depth where nothing is covered does no harm; without coverage it's an error.
  accept guide flow now.exr before.exr -c depth.Z -o flow.exr
  oiiotool now.exr --ch depth.Z -o depth.exr
  refuse 3 'depth.exr: found inf at pixel (0, 0)' guide flow depth.exr depth.exr -c depth.Z -o out.exr
}

@test "methods and options" {
  bring '*.png' truth.exr
  accept guide flow now.png before.png --motion truth.exr --method published -o published.exr --format json
  expect 'how' "$(json - '[r.method, r.radius].join()' <<<"$output")" published,1
  expect_less 'published: relative' "$(json - r.error.relative <<<"$output")" 1
  expect_less 'published: relative' 0.3 "$(json - r.error.relative <<<"$output")"
  accept guide flow now.png before.png --motion truth.exr --levels 1 --radius 3 -o short.exr --format json
  expect 'levels and radius' "$(json - 'r.levels + " " + r.radius' <<<"$output")" '1 3'
  expect_less 'one level reaches few pixels' "$(json - r.motion.max <<<"$output")" 8
  # Nothing matches within no difference but what is equal; all is ambiguous within 255 levels.
  accept guide flow now.png before.png --tolerance 255 -o flow.exr --format json
  expect 'within 255 levels' "$(json - 'r.ambiguous + " " + r.untextured + " " + r.unknown' <<<"$output")" '1 1 1'
  accept guide flow now.png before.png --threshold 0 -o flow.exr --format json
  expect_less 'within no difference' "$(json - r.matched <<<"$output")" 1
}

@test "the same bytes for any number of threads, from run to run" {
  bring '*.png'
  local threads method
  for method in coarse-to-fine published; do
    accept guide flow now.png before.png --method $method --consistency --no-history -j 1 -o one.exr
    for threads in 2 3 1; do
      accept guide flow now.png before.png --method $method --consistency --no-history -j $threads -o more.exr
      expect_same one.exr more.exr
    done
  done
}

@test "motion as a picture" {
  bring '*.png'
  accept guide flow now.png before.png --display 10 -o flow.png
  expect_holds report "$output" 'shown       rest as one half, 10 pixels as 0 or 1'
  expect 'a pixel' "$(dump flow.png R,G,B,A 255 | grep '^80 60 ')" '80 60 191 89 128 255'
  accept guide flow now.png now.png --bits 16 -o rest.png
  expect 'a pixel at rest' "$(dump rest.png R,G,B,A 65535 | grep '^80 60 ')" '80 60 32768 32768 32768 65535'
}

@test "history, --dry-run and --help" {
  bring '*.png' '*.exr'
  accept guide flow now.png before.png --radius 1 -o flow.exr
  accept info flow.exr --format json
  expect command "$(json - 'r.attributes["stylut:command"]' <<<"$output")" 'stylut guide flow --radius=1 now.png before.png'
  expect hashes "$(json - 'r.attributes["stylut:input1"] + " " + r.attributes["stylut:input2"]' <<<"$output")" \
    "$(sha256sum now.png before.png | cut -d' ' -f1 | paste -sd' ')"
  rm flow.exr
  accept guide flow now.png before.png -o flow.exr --dry-run
  expect 'dry run' "$output" 'would write flow.exr: 160x120 pixels, 5 levels, by R,G,B'
  expect 'files' "$(ls flow* 2>/dev/null)" ''
  refuse 3 truth.exr guide flow now.png truth.exr -o flow.exr --dry-run
  accept guide flow --help
  expect_match help "$output" '^Usage: stylut guide flow '
  local option
  for option in $(grep -oE -- '--[a-z0-9-]+' <<<"$output" | sort -u); do
    [ "$option" != --help ] || continue
    said=$("$STYLUT" guide flow "$option=" 2>&1 >/dev/null) || true
    [[ $said != *"expected an option that"* ]] || complain "guide flow $option: $said"
  done
  accept guide --help
  expect_holds 'guide --help' "$output" 'flow A B'
}

@test "what is wrong is said in a line" {
  bring '*.png' '*.exr'
  local good=(guide flow now.png before.png --motion truth.exr)
  cut_out "$exemplars/spheres/oil.png" wide.png 0 0 161x120
  truth wide.exr 5 -3 161x120
  head -c 2000 now.png >short.png
  : >empty.png
  echo text >text.png
  mkdir folder.png
  oiiotool truth.exr --ch A,motion.U -o half.exr
  oiiotool truth.exr --ch A=0,motion.U,motion.V -o none.exr
  oiiotool --pattern constant:color=1,1e9,0 160x120 3 --chnames A,motion.U,motion.V -d float -o far.exr
  swap 2 now.png missing.png "${good[@]}" -o out.exr
  swap 2 before.png folder.png "${good[@]}" -o out.exr
  swap 3 before.png short.png "${good[@]}" -o out.exr
  swap 3 now.png empty.png "${good[@]}" -o out.exr
  swap 3 now.png text.png "${good[@]}" -o out.exr
  swap 3 truth.exr half.exr "${good[@]}" -o out.exr
  swap 3 truth.exr none.exr "${good[@]}" -o out.exr
  swap 3 truth.exr far.exr "${good[@]}" -o out.exr
  swap 3 truth.exr wide.exr "${good[@]}" -o out.exr
  swap 2 truth.exr missing.exr "${good[@]}" -o out.exr
  wait
  refuse 3 'now.png: found 160x120 pixels, and wide.png has 161x120' guide flow now.png wide.png -o out.exr
  refuse 3 'wide.png: found 161x120 pixels, and now.png has 160x120' guide flow wide.png now.png -o out.exr
  refuse 3 'no channels in common' guide flow now.png truth.exr -o out.exr
  refuse 1 'expected this frame' guide flow -o out.exr
  refuse 1 'the previous frame' guide flow now.png -o out.exr
  refuse 1 wide.png guide flow now.png before.png wide.png -o out.exr
  refuse 1 --output guide flow now.png before.png
  refuse 1 before.png guide flow now.png before.png -o before.png
  refuse 1 truth.exr "${good[@]}" -o truth.exr
  refuse 1 out.jpg "${good[@]}" -o out.jpg
  refuse 2 none/out.exr "${good[@]}" -o none/out.exr
  local option
  for option in --levels=0 --levels=13 --radius=0 --radius=5 --threshold=-1 --threshold=nan --tolerance=x --method=fast --display=0 --bits=9 --junk; do
    refuse 1 "${option%%=*}" "${good[@]}" "$option" -o out.exr
  done
  refuse 3 depth guide flow now.png before.png -c depth -o out.exr
  for option in R,,G ,R R,; do
    refuse 1 "channels: found an empty name in '$option'" guide flow now.png before.png -c "$option" -o out.exr
  done
  oiiotool truth.exr --cut 8x8+0+0 -o small.exr
  refuse 3 'small.exr: found 8x8 pixels, and now.png has 160x120' guide flow now.png before.png --motion small.exr -o out.exr
}

@test "small pictures" {
  bring '*.png'
  local size
  for size in 1x1 2x1 1x7 3x3 17x5; do
    cut_out now.png a.png 40 40 $size
    cut_out before.png b.png 40 40 $size
    accept guide flow a.png b.png --consistency -o flow.exr
    expect_holds "$size" "$output" "$size, 100.0 % covered"
    ! dump flow.exr motion.U,motion.V,residual.Y,consistency.Y | grep -qE 'nan|inf' || complain "$size: found what isn't finite"
  done
  accept guide flow a.png a.png --progress json -o flow.exr --dry-run
}
