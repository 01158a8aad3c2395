#!/usr/bin/env bats
# stylut lut --resolve: the choice among nearly equal source pixels, and what it
# makes of frames.
load helpers

# The creature from one side, and turning slowly as seen from another.
setup_file() {
  local k
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 40 -q -o sphere.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" --view 30,15 -s 384 -c normal -q -o guide.png
  for k in 1 2 3 4 5; do
    "$STYLUT" guide scene "$exemplars/creature.ply" --view $((2 * k - 8)),5 -s 384 -c normal -q -o frame.$k.png
  done
  "$STYLUT" guide scene "$exemplars/creature.ply" --view 30,15 -s 256 -c normal -q -o coarse.png
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 200x120 -q -o small.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 64 -c depth -q -o flat.exr
}

# count_jumps TABLE [GUIDE]
count_jumps() {
  accept check "$1" --guide "${2:-guide.png}" --format json || return 1
  json - r.jumps <<<"$output"
}

# wear TABLE GUIDE FRAME...: a line per frame of how the guide's picture lies on it,
# as tests/bench/pieces says.
wear() {
  local table=$1 guide=$2 frame fields=()
  shift 2
  printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "own", "exemplar": "%s", "guide": "%s",
    "lut": { "file": "%s" } } ] }\n' "$guide" "$guide" "$table" >own.json
  rm -rf own
  accept pack own.json -q -o own || return 1
  for frame in "$@"; do
    accept stylize own --guide "$frame" -o worn.png --nnf "$table.$(basename "$frame")" || return 1
    fields+=("$table.$(basename "$frame")")
  done
  "$STYLUT_BUILD/tests/bench/pieces" "${fields[@]}" | tail -n +2
}

# mean_piece: of the lines of `wear` on stdin.
mean_piece() { awk -F, '{ sum += $3 } END { print sum / NR }'; }

# expect_slack NEAREST TABLE LEVELS: no texel is farther than that beyond the nearest, and some are farther at all.
expect_slack() {
  local paid
  paid=$(paste -d' ' <(dump "$1" error) <(dump "$2" error) |
    awk -v most="$3" '{ paid = ($6 - $3) * 255 / 2 } paid > most + 1e-4 { beyond++ } paid > 0 { some++ }
      END { print beyond + 0, (some > 0) }')
  expect "texels of $2 beyond the slack, and any within" "$paid" '0 1'
}

@test "a coherent table is calmer and pays no more than its slack" {
  bring guide.png coarse.png sphere.exr
  accept lut guide.png -s 96 -o nearest.exr
  accept lut guide.png -s 96 --resolve coherent --slack 2 --no-history -o coherent.exr
  accept lut guide.png -s 96 --resolve coherent --slack 2 --no-history -j 1 -o again.exr
  expect_same coherent.exr again.exr
  expect_less 'jumps of the coherent table' "$(count_jumps coherent.exr)" "$(awk -v j="$(count_jumps nearest.exr)" 'BEGIN { print j / 5 }')"
  accept check coherent.exr --guide guide.png --max-jumps 0.15
  expect_slack nearest.exr coherent.exr 2
  # The file says what it was made with, and audits hold it to that.
  accept check coherent.exr --guide guide.png --format json
  expect 'slack, texels beyond it' "$(json - '[(r.slack * 255 / 2).toFixed(4), r.beyond_slack, r.optimal < 1].join()' <<<"$output")" 2.0000,0,true
  accept check nearest.exr --guide guide.png --format json
  expect 'slack of the nearest' "$(json - '[r.slack, r.beyond_slack].join()' <<<"$output")" 0,0
  accept report coherent.exr --guide guide.png -o r.html
  expect_match verdict "$output" '^Chosen: every texel holds a pixel within the slack of 2 levels, [0-9.]+ degrees more'
  ! grep -q 'An exact table of this guide would err' <<<"$output" || complain 'the report advises against what was asked for'
  # Here the first patches that are tried are a few texels each.
  accept lut coarse.png -s 128 --resolve coherent -o coarse.exr
  expect_less 'jumps of the coarse table' "$(count_jumps coarse.exr coarse.png)" 0.3
  # A sphere is left alone.
  accept lut sphere.exr -s 48 --no-history -o a.exr
  accept lut sphere.exr -s 48 --resolve coherent --no-history -o b.exr
  expect_same a.exr b.exr
}

@test "frames and both: larger pieces on frames that weren't given" {
  bring guide.png 'frame.*'
  local kind jumps nearest given=(frame.1.png frame.2.png frame.4.png frame.5.png)
  accept lut guide.png -s 96 -o nearest.exr
  jumps=$(count_jumps nearest.exr)
  nearest=$(wear nearest.exr guide.png frame.3.png | mean_piece)
  for kind in frames both; do
    accept lut guide.png -s 96 --resolve $kind --frames "${given[@]}" --no-history -o $kind.exr
    accept lut guide.png -s 96 --resolve $kind --frames "${given[@]}" --no-history -j 1 -o again.exr
    expect_same $kind.exr again.exr
    accept lut guide.png -s 96 --resolve $kind --frames "${given[@]}" --no-history -j 2 -o again.exr
    expect_same $kind.exr again.exr
    expect_slack nearest.exr $kind.exr 2
    expect_less "jumps of $kind" "$(count_jumps $kind.exr)" "$jumps"
    expect_less "twice the nearest's pieces" "$(awk -v p="$nearest" 'BEGIN { print 2 * p }')" \
      "$(wear $kind.exr guide.png frame.3.png | mean_piece)"
  done
  expect_less 'jumps of both' "$(count_jumps both.exr)" "$(awk -v j="$jumps" 'BEGIN { print j / 5 }')"
  # The slack is heeded, too, and the frames matter.
  accept lut guide.png -s 64 -o nearest.exr
  accept lut guide.png -s 64 --resolve frames --slack 0.5 --frames frame.1.png --no-history -o one.exr
  accept lut guide.png -s 64 --resolve frames --slack 0.5 --frames frame.5.png --no-history -o other.exr
  expect_slack nearest.exr one.exr 0.5
  expect_other one.exr other.exr
}

@test "frames of any size and kind, and those that can't be" {
  bring guide.png 'frame.*' small.exr flat.exr
  accept lut guide.png -s 32 --resolve frames --frames small.exr frame.1.png -o mixed.exr --format json
  expect resolve "$(json - r.resolve <<<"$output")" frames
  # What it paid is said, and what it was made from is kept.
  expect 'paid within two levels, and something' \
    "$(json - 'r.max_paid <= 4 / 255 && r.max_paid >= r.mean_paid && r.mean_paid > 0' <<<"$output")" true
  accept info mixed.exr
  expect_holds 'inputs of the table' "$output" stylut:input3
  accept lut --resolve both --frames small.exr --slack 1 -s 32 -o first.exr guide.png
  prove lut guide.png -s 32 --resolve frames --frames small.exr -o out.exr
  refuse 3 flat.exr lut guide.png -s 32 --resolve frames --frames flat.exr -o none.exr
  refuse 3 flat.exr lut guide.png -s 32 --resolve both --frames small.exr flat.exr -o none.exr
  refuse 2 missing.png lut guide.png -s 32 --resolve frames --frames missing.png -o none.exr
}

@test "choices and options that don't go together" {
  bring guide.png frame.1.png
  prove lut guide.png -s 32 --resolve frames --frames frame.1.png -o out.exr
  refuse 1 --frames lut guide.png -s 32 --resolve frames -o none.exr
  refuse 1 --frames lut guide.png -s 32 --resolve both -o none.exr
  refuse 1 --frames lut guide.png -s 32 --resolve coherent --frames frame.1.png -o none.exr
  refuse 1 --frames lut guide.png -s 32 --frames frame.1.png -o none.exr
  refuse 1 --slack lut guide.png -s 32 --slack 2 -o none.exr
  refuse 1 auto lut guide.png -s auto --max-p99 5 --resolve coherent -o none.exr
  refuse 1 flann-forest lut guide.png -s 32 --resolve coherent -e flann-forest -o none.exr
  refuse 1 --slack lut guide.png -s 32 --resolve nearest --slack 0 -o none.exr
  refuse 1 -1 lut guide.png -s 32 --resolve coherent --slack -1 -o none.exr
  refuse 1 cohesive lut guide.png -s 32 --resolve cohesive -o none.exr
  cp frame.1.png frame.png
  refuse 1 frame.png lut guide.png -s 32 --resolve frames --frames frame.png --encoding rg16 -o frame.png
  expect_same frame.1.png frame.png
}

@test "the golem: what was aimed at" {
  need_data frames/golem.00{1,2,3,4,5,6}.png frames/golem.045.png
  local frames=$data/frames given kind
  given=("$frames"/golem.00{1,2,5,6}.png)
  cp "$frames/golem.045.png" guide.png
  accept lut "$frames/golem.001.png" --resolve coherent --slack 2 -o coherent.001.exr
  expect_less 'jumps of golem.001' "$(count_jumps coherent.001.exr "$frames/golem.001.png")" 0.055
  for kind in nearest coherent frames; do
    case $kind in
      nearest) accept lut guide.png -o nearest.exr ;;
      coherent) accept lut guide.png --resolve coherent --slack 2 -o coherent.exr ;;
      frames) accept lut guide.png --resolve frames --slack 2 --frames "${given[@]}" -o frames.exr ;;
    esac
    wear $kind.exr guide.png "$frames"/golem.00{3,4}.png >$kind.csv
  done
  expect_less 'jumps of golem.045' "$(count_jumps coherent.exr)" 0.045
  expect_less 'flicker of the coherent' "$(awk -F, 'NR == 2 { print $4 }' coherent.csv)" 0.07
  expect_less 'flicker that there was' 0.4 "$(awk -F, 'NR == 2 { print $4 }' nearest.csv)"
  expect_less "the nearest's pieces" "$(mean_piece <nearest.csv)" "$(mean_piece <coherent.csv)"
  expect_less "1.2 times the nearest's pieces" "$(mean_piece <nearest.csv | awk '{ print 1.2 * $1 }')" "$(mean_piece <frames.csv)"
}
