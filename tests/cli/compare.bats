#!/usr/bin/env bats
# stylut compare: figures, thresholds, heat map.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 20x16 --no-history -q -o a.exr
  "$STYLUT" guide sphere -s 20x16 --no-history -q -o a.png
  "$STYLUT" guide sphere -s 20x16 --no-history -q --bits 16 -o a16.png
  # Three pixels of channel G brighter by 16, 32 and 64 of 255.
  oiiotool --create 20x16 3 --fill:color=0.2,0.4,0.6 20x16 -d uint8 -o plain.png
  paint plain.png 3,2 $((102 + 16)) marks.png
  paint marks.png 7,9 $((102 + 32)) marks.png
  paint marks.png 8,9 $((102 + 64)) marks.png
  write_exr plain.exr 0 1 2 3 4 5
}

# paint FROM X,Y GREEN TO: one pixel
paint() { oiiotool "$1" --box:color="0.2,$(awk "BEGIN { print $3 / 255 }"),0.6":fill=1 "$2,$2" -d uint8 -o "$4"; }

# write_exr FILE VALUE...: a row of one float channel Y, written by hand, so that it
# may hold what no tool writes.
write_exr() { node -e "$exr_writer" "$@"; }
# shellcheck disable=SC2016 # it is JavaScript
exr_writer='
const [file, ...values] = process.argv.slice(1), n = values.length
const int = v => { const b = Buffer.alloc(4); b.writeInt32LE(v); return b }
const float = v => { const b = Buffer.alloc(4); b.writeFloatLE({ nan: NaN, inf: Infinity, "-inf": -Infinity }[v] ?? Number(v)); return b }
const text = s => Buffer.from(s + "\0", "latin1")
const attribute = (name, type, data) => Buffer.concat([text(name), text(type), int(data.length), data])
const box = Buffer.concat([int(0), int(0), int(n - 1), int(0)])
const header = Buffer.concat([int(20000630), int(2),
  attribute("channels", "chlist", Buffer.concat([text("Y"), int(2), int(0), int(1), int(1), Buffer.alloc(1)])),
  attribute("compression", "compression", Buffer.alloc(1)), attribute("dataWindow", "box2i", box),
  attribute("displayWindow", "box2i", box), attribute("lineOrder", "lineOrder", Buffer.alloc(1)),
  attribute("pixelAspectRatio", "float", float(1)), attribute("screenWindowCenter", "v2f", Buffer.alloc(8)),
  attribute("screenWindowWidth", "float", float(1)), Buffer.alloc(1)])
const table = Buffer.alloc(8)
table.writeBigUInt64LE(BigInt(header.length + 8))
require("fs").writeFileSync(file, Buffer.concat([header, table, int(0), int(4 * n), ...values.map(float)]))
'

# differ COMMAND...: exit 7 and one line on stderr, which becomes $said; stdout becomes $output.
differ() {
  local status=0
  output=$("$STYLUT" "$@" 2>said.txt) || status=$?
  said=$(cat said.txt)
  rm said.txt
  expect "exit of '$*'" $status 7
  [[ $said == 'stylut: error: '* && $said != *$'\n'* ]] || complain "'$*': said '$said', expected one line"
}

@test "a picture and itself" {
  bring 'a*' plain.exr
  local file
  for file in a.exr a.png a16.png plain.exr; do
    cp $file copy.${file##*.}
    accept compare $file copy.${file##*.}
    expect_match "$file" "$output" "^$file and copy.*: equal
differing  0 pixels \(0 %\)
failing    0 pixels \(0 %\), by more than 0
difference mean 0  RMS 0  largest 0$"
    accept compare $file $file --hardfail 0 --format json
    expect "$file" "$(json - '[r.schema, r.verdict, r.comparison.differing.pixels, r.comparison.largest].join()' <<<"$output")" \
      'stylut-compare/1,equal,0,'
  done
  accept compare a.exr a.exr -q
  expect 'quiet' "$output" ''
}

@test "figures are what an independent reader finds" {
  bring 'a*'
  dump a.png R,G,B,A 65535 >8.txt
  dump a16.png R,G,B,A 65535 >16.txt
  differ compare a.png a16.png --format json
  paste -d' ' 8.txt 16.txt | awk '{
    far = 0
    for (c = 3; c <= 6; c++) {
      d = $c - $(c + 6); if (d < 0) d = -d
      sum += d; squares += d * d; n++
      if (d > far) far = d
      if (d > max) { max = d; at = c - 3 "," $1 "," $2 }
    }
    differing += far > 0; failing += far > 65
  } END { printf "%d %d %s %.9f %.9f %.9f\n", differing, failing, at, sum / n / 65535, sqrt(squares / n) / 65535, max / 65535 }' >expected.txt
  local counts
  read -ra counts <expected.txt
  expect differing "$(json - r.comparison.differing.pixels <<<"$output")" "${counts[0]}"
  expect_near share "$(json - r.comparison.differing.share <<<"$output")" "$(awk "BEGIN { print ${counts[0]} / 320 }")" 1e-6
  expect 'place of the largest' "$(json - '(l => ["RGBA".indexOf(l.channel), ...l.pixel].join())(r.comparison.largest)' <<<"$output")" "${counts[2]}"
  expect_near 'mean, RMS, largest' "$(json - '[r.comparison.mean, r.comparison.rms, r.comparison.largest.difference].join(" ")' <<<"$output")" "${counts[*]:3}" 1e-9
  differ compare a.png a16.png --fail 0.001 --format json
  expect failing "$(json - r.comparison.failing.pixels <<<"$output")" "${counts[1]}"
  # The other way round it is the same.
  differ compare a.png a16.png --format json
  local one=$output
  differ compare a16.png a.png --format json
  expect 'the other way round' "$(json - 'r.comparison.largest.values.reverse(), r.comparison' <<<"$output")" "$(json - r.comparison <<<"$one")"
}

@test "text, JSON and the line on stderr agree" {
  bring plain.png marks.png
  differ compare plain.png marks.png
  expect line "$said" 'stylut: error: plain.png and marks.png: found 3 pixels (0.9375 %) that differ by more than 0, the largest by 0.25098 in channel G at (8, 9), expected at most 0 %'
  expect_holds text "$output" 'plain.png and marks.png: 20x16 pixels, channels R G B: different'
  expect_holds text "$output" 'differing  3 pixels (0.9375 %)'
  expect_holds text "$output" 'largest 0.25098, in channel G at (8, 9): 0.400000006 and 0.650980413'
  differ compare plain.png marks.png --format json
  expect facts "$(json - '(c => [r.verdict, c.differing.pixels, c.failing.pixels, c.largest.channel, c.largest.pixel, r.thresholds.hardfail].join())(r.comparison)' <<<"$output")" \
    different,3,3,G,8,9,
  differ compare plain.png marks.png -q
  expect quiet "$output" ''
}

@test "thresholds: just kept and just broken" {
  bring plain.png marks.png
  # One level is 1/255; the marks differ by 16, 32 and 64 levels of 255, in 3 of 320 pixels.
  accept compare plain.png marks.png --fail 0.251
  expect_holds text "$output" ': within thresholds'
  expect_holds text "$output" 'failing    0 pixels'
  differ compare plain.png marks.png --fail 0.2509
  expect_holds line "$said" 'found 1 pixels (0.3125 %) that differ by more than 0.2509'
  accept compare plain.png marks.png --failpercent 0.9375
  differ compare plain.png marks.png --failpercent 0.9374
  accept compare plain.png marks.png --fail 0.1 --failpercent 0.625
  differ compare plain.png marks.png --fail 0.1 --failpercent 0.6249
  expect_holds line "$said" 'expected at most 0.6249 %'
  accept compare plain.png marks.png --failpercent 100 --hardfail 0.251
  differ compare plain.png marks.png --failpercent 100 --hardfail 0.2509
  expect_holds line "$said" 'the largest by 0.25098 in channel G at (8, 9), expected at most 100 % and none by more than 0.2509'
  differ compare plain.png marks.png --failpercent 100 --hardfail 0.2509 --format json
  expect 'hard failing' "$(json - r.comparison.hard_failing.pixels <<<"$output")" 1
}

@test "values that are no numbers" {
  bring plain.exr
  accept compare plain.exr plain.exr
  write_exr odd.exr nan inf -inf nan inf -0
  accept compare odd.exr odd.exr
  expect_holds 'odd values and themselves' "$output" ': equal'
  # Minus zero is zero.
  write_exr zero.exr 0 0
  write_exr minus.exr -0 0
  accept compare zero.exr minus.exr
  local pair
  for pair in 'nan 1' '1 nan' 'nan inf' 'inf nan' 'inf -inf' 'inf 1' '1 -inf'; do
    write_exr one.exr "${pair% *}" 1
    write_exr other.exr "${pair#* }" 1.5
    differ compare one.exr other.exr --fail 1e38
    expect_holds "$pair" "$said" 'found 1 pixels (50 %) that differ by more than 1e+38, the largest by inf in channel Y at (0, 0)'
    expect_holds "$pair" "$output" 'difference mean 0.5  RMS 0.5  largest inf, in channel Y at (0, 0)'
    expect_holds "$pair" "$output" 'infinite   1 values'
    differ compare one.exr other.exr --failpercent 100 --hardfail 1e39
    accept compare one.exr other.exr --failpercent 100
    accept compare one.exr other.exr --failpercent 100 -o heat.png --format json
    expect "$pair" "$(json - '[r.comparison.infinite_values, r.comparison.largest.difference, r.comparison.mean, r.heat.top].join()' <<<"$output")" 1,,0.5,0.5
    expect "heat of $pair" "$(dump heat.png R,G,B 255)" '0 0 255 255 255
1 0 253 231 37'
  done
  # Numbers as far apart as there are.
  write_exr one.exr 3.4e38
  write_exr other.exr -3.4e38
  differ compare one.exr other.exr --hardfail 1e39
  expect_holds 'far apart' "$said" 'the largest by 6.8e+38'
}

@test "the heat map" {
  bring plain.png marks.png
  differ compare plain.png marks.png -o heat.png
  # Ramp: black; a quarter, a half, the whole of the largest.
  expect 'where they differ' "$(dump heat.png R,G,B 255 | grep -v ' 0 0 0$')" '3 2 33 145 140
7 9 75 192 108
8 9 253 231 37'
  expect_holds text "$output" 'heat.png: black where equal, violet just above 0, teal at 0.0627451, yellow at 0.25098 (by the square root)'
  expect_holds history "$("$STYLUT" info heat.png)" 'stylut:command = stylut compare plain.png marks.png'
  accept compare plain.png plain.png -o black.png
  expect 'of equal pictures' "$(dump black.png R,G,B 255 | cut -d' ' -f3- | sort -u)" '0 0 0'
  expect_holds text "$output" 'black.png: black where equal'
  # The same bytes on any number of threads.
  differ compare plain.png marks.png -j 3 --no-history -o three.png
  differ compare plain.png marks.png -j 1 --no-history -o one.png
  expect_same three.png one.png
  differ compare plain.png marks.png -o not.png --dry-run
  expect_holds 'dry run' "$output" 'would write not.png'
  [ ! -e not.png ] || complain "--dry-run wrote"
}

@test "channels are paired by name, whatever their order and file" {
  bring a.exr a.png
  oiiotool a.exr --ch normal.Z,normal.Y,A,normal.X,depth.Z -o turned.exr
  accept compare a.exr turned.exr
  accept compare a.png a.png
  oiiotool --no-autopremult a.png -o a.tif
  accept compare a.png a.tif
  # 8 bits and the same values in 16.
  oiiotool --no-autopremult a.png -d uint16 -o wide.png
  accept compare a.png wide.png
}

@test "other sizes and other channels differ" {
  bring 'a*' plain.png
  prove compare a.exr a.exr
  oiiotool a.exr --cut 19x16 -o narrow.exr
  refuse 7 'a.exr and narrow.exr: found 20x16 and 19x16 pixels' compare a.exr narrow.exr
  refuse 7 'narrow.exr and a.exr: found 19x16 and 20x16 pixels' compare narrow.exr a.exr -o heat.png
  oiiotool a.exr --ch A,normal.X,normal.Y,normal.Z -o fewer.exr
  refuse 7 'found channel depth.Z in the first only' compare a.exr fewer.exr
  refuse 7 'found channel depth.Z in the second only' compare fewer.exr a.exr
  refuse 7 'found channel A in the first only' compare a.png plain.png
  refuse 7 'a.exr and a.png' compare a.exr a.png --fail 1000 --failpercent 100
  differ compare a.exr narrow.exr --format json
  expect sizes "$(json - '[r.verdict, r.sizes, r.comparison, r.heat].join()' <<<"$output")" different,20,16,19,16,,
  differ compare a.exr fewer.exr
  expect text "$output" ''
}

@test "arguments that make no sense" {
  bring 'a*'
  local good=(compare a.exr a.exr --fail 0.5 --failpercent 1.5 --hardfail 2)
  prove "${good[@]}"
  local bad
  for bad in -1 nan inf x 1x '' 0x1 1e40 ' 1'; do
    swap 1 0.5 "$bad" "${good[@]}"
    swap 1 2 "$bad" "${good[@]}"
    swap 1 1.5 "$bad" "${good[@]}"
  done
  swap 1 1.5 101 "${good[@]}"
  swap 1 --fail --nofail "${good[@]}"
  refuse 1 'two pictures' compare
  refuse 1 'a second picture' compare a.exr
  refuse 1 a16.png compare a.exr a.exr a16.png
  refuse 1 --guide compare a.exr a.exr --guide
  refuse 1 --seed compare a.exr a.exr --seed 1
  wait
}

@test "inputs that can't be read" {
  bring a.exr a.png
  mkdir folder.exr
  touch empty.exr
  printf 'no picture' >text.exr
  head -c 600 a.exr >cut.exr
  cp a.exr b.exr
  local bad
  for bad in missing.exr folder.exr; do
    swap 2 a.exr $bad compare a.exr b.exr
    swap 2 b.exr $bad compare a.exr b.exr
  done
  for bad in empty.exr text.exr cut.exr; do
    swap 3 a.exr $bad compare a.exr b.exr
    swap 3 b.exr $bad compare a.exr b.exr
  done
  wait
}

@test "outputs that can't be written" {
  bring a.png
  cp a.png b.png
  mkdir folder.png
  swap 1 out.png b.png compare a.png b.png -o out.png
  swap 1 out.png a.png compare a.png b.png -o out.png
  swap 1 out.png out.exr compare a.png b.png -o out.png
  swap 1 out.png out.jpg compare a.png b.png -o out.png
  swap 1 out.png out compare a.png b.png -o out.png
  swap 2 out.png nowhere/out.png compare a.png b.png -o out.png
  swap 2 out.png folder.png compare a.png b.png -o out.png
  wait
}
