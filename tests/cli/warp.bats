#!/usr/bin/env bats
# stylut guide warp: displacement fields from pairs of points.
load helpers

write_pairs() { # [FILE]
  cat >"${1:-pairs.json}" <<'END'
{
  "schema": "stylut-pairs/1",
  "kind": "rigid",
  "alpha": 1.5,
  "units": "pixels",
  "pairs": [
    { "from": [10.5, 8.5], "to": [12.5, 9.5] },
    { "from": [30.5, 8.5], "to": [29.5, 7.5] },
    { "from": [20.5, 30.5], "to": [20.5, 28.5] }
  ]
}
END
}

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  write_pairs
}

@test "the field meets its pairs, by any kind" {
  bring pairs.json
  local kind
  for kind in affine similarity rigid; do
    accept guide warp pairs.json -s 40x36 --kind $kind -o $kind.exr --format json
    expect kind "$(json - r.kind <<<"$output")" $kind
    expect schema "$(json - r.schema <<<"$output")" stylut-guide-warp/1
    expect_less "residual of $kind" "$(json - r.residual.max <<<"$output")" 1e-4
    dump $kind.exr A,motion.U,motion.V >pixels.txt
    expect_near "$kind at (12, 9)" "$(sed -n 's/^12 9 //p' pixels.txt)" '1 -2 -1' 2e-6
    expect_near "$kind at (29, 7)" "$(sed -n 's/^29 7 //p' pixels.txt)" '1 1 1' 2e-6
    expect_near "$kind at (20, 28)" "$(sed -n 's/^20 28 //p' pixels.txt)" '1 0 2' 2e-6
    expect "misses of $kind that move" "$(awk '$3 == 0 && ($4 != 0 || $5 != 0)' pixels.txt)" ''
  done
  expect_other affine.exr rigid.exr
  accept guide warp pairs.json -s 40x36 -o file.exr --no-history
  accept guide warp pairs.json -s 40x36 --kind rigid --alpha 1.5 -o said.exr --no-history
  expect_same file.exr said.exr
}

# The picture bent by the field, with another tool.
@test "a picture turned by pairs is the picture turned" {
  cat >turn.json <<'END'
{ "schema": "stylut-pairs/1", "units": "normalized",
  "pairs": [ { "from": [0, 0], "to": [1, 0] }, { "from": [1, 0], "to": [1, 1] }, { "from": [0, 1], "to": [0, 0] } ] }
END
  accept guide warp turn.json -s 16 -o turn.exr --format json
  expect_near 'stretch and compression' "$(json - 'r.stretch.max + " " + r.compression.max + " " + r.inside + " " + r.folded' <<<"$output")" '1 1 1 0' 1e-9
  oiiotool --pattern fill:topleft=0,0.1,0.2:topright=0.9,0.3,0.5:bottomleft=0.4,1,0.7:bottomright=0.3,0.3,0.1 16x16 3 -d float -o picture.exr
  oiiotool picture.exr --rotate90 -o expected.exr
  join <(dump turn.exr motion.U,motion.V | awk '{ print int($1 + $3 + 0.5) "_" int($2 + $4 + 0.5), $1 "_" $2 }' | sort) \
    <(dump picture.exr R,G,B | awk '{ print $1 "_" $2, $3, $4, $5 }' | sort) | awk '{ print $2, $3, $4, $5 }' | sort >found.txt
  dump expected.exr R,G,B | awk '{ print $1 "_" $2, $3, $4, $5 }' | sort >expected.txt
  expect pixels "$(wc -l <found.txt)" 256
  expect_same found.txt expected.txt
}

@test "the same bytes on any number of threads" {
  bring pairs.json
  local kind
  for kind in affine similarity rigid; do
    accept guide warp pairs.json -s 200x170 --kind $kind -j 1 -o one.exr --no-history
    accept guide warp pairs.json -s 200x170 --kind $kind -j 3 -o three.exr --no-history
    expect_same one.exr three.exr
  done
}

@test "folds, and pairs beside the picture, are warned of" {
  bring pairs.json
  sed 's/"to": \[12.5, 9.5\]/"to": [35.5, 9.5]/' pairs.json >folded.json
  accept_warned folded guide warp folded.json -s 40x36 -o out.exr
  expect_match report "$output" 'folded +[1-9][0-9.]* %'
  accept_warned 'found 2 of 3 pairs outside the picture, the first pairs[1] from (30.5, 8.5) to (29.5, 7.5), expected them in 30x29' \
    guide warp pairs.json -s 30x29 -o out.exr
  accept guide warp pairs.json -s 30x29 -o out.exr --format json -q
  expect 'pairs outside' "$(json - r.outside <<<"$output")" 2
  sed 's/\.5, /0000, /g' pairs.json >far.json
  rm out.exr
  refuse 3 "found none of 3 pairs inside the picture, the first 'to' at (120000, 9.5) of 40x36 pixels" guide warp far.json -s 40x36 -o out.exr
}

@test "report, history, help" {
  bring pairs.json
  accept guide warp pairs.json -s 40x36 -o out.exr
  expect_match report "$output" '^out\.exr: 40x36, rigid, 3 pairs, alpha 1\.5; [0-9.]+ % come from inside the picture
residual .*
stretch .*
compression .*
folded +0\.00 %'
  accept info out.exr --format json
  expect command "$(json - 'r.attributes["stylut:command"]' <<<"$output")" 'stylut guide warp --size=40x36 pairs.json'
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" A,motion.U,motion.V
  rm out.exr
  accept guide warp pairs.json -o out.exr --dry-run
  [ ! -e out.exr ] || complain 'a dry run wrote out.exr'
  accept guide warp pairs.json -o out.exr -q
  expect 'quiet report' "$output" ''
  accept guide warp --help
  expect_match help "$output" '^Usage: stylut guide warp '
  accept guide --help
  expect_holds help "$output" 'warp PAIRS.json'
  expect_holds help "$output" 'strokes IMAGE'
}

# wrong OLD NEW NAMED: the file with one thing changed is refused by its place.
wrong() {
  sed "s|$1|$2|" pairs.json >wrong.json
  ! cmp -s pairs.json wrong.json || complain "'$1' isn't in pairs.json"
  refuse 3 "$3" guide warp wrong.json -s 40 -o out.exr
}

@test "files that are wrong, each with its place" {
  bring pairs.json
  prove guide warp pairs.json -s 40 -o out.exr || return 1
  wrong 'pairs/1' 'pairs/2' wrong.json:2:13
  wrong '"rigid"' '"floppy"' wrong.json:3:11
  wrong '1.5,' '77,' wrong.json:4:12
  wrong '"pixels"' '"miles"' wrong.json:5:12
  wrong '"units"' '"unit"' wrong.json:5:11
  wrong '\[12.5, 9.5\]' '[12.5]' wrong.json:7:34
  wrong '\[12.5, 9.5\]' '[12.5, 1e7]' wrong.json:7:41
  wrong '\[12.5, 9.5\]' '[12.5, NaN]' wrong.json:7
  wrong '\[12.5, 9.5\]' '[29.5, 7.5]' wrong.json:8:34
  wrong '\[30.5, 8.5\]' '[10.5, 8.5]' wrong.json:8:15
  wrong '"from": \[30.5, 8.5\], ' '' wrong.json:8:5
  head -c 150 pairs.json >short.json
  refuse 3 short.json guide warp short.json -o out.exr
  printf '{ "schema": "stylut-pairs/1", "pairs": [] }' >none.json
  refuse 3 '1 to 4096' guide warp none.json -o out.exr
  : >empty.json
  refuse 3 empty.json guide warp empty.json -o out.exr
}

@test "pairs that a kind can't go by" {
  bring pairs.json
  sed '/30.5, 8.5/d' pairs.json >two.json
  accept guide warp two.json -s 40 -o out.exr
  rm out.exr
  refuse 3 'on one line' guide warp two.json -s 40 --kind affine -o out.exr
  sed 's/29.5, 7.5/16.5, 19/' pairs.json >line.json
  accept guide warp line.json -s 40 --kind similarity -o out.exr -q
  rm out.exr
  refuse 3 'on one line' guide warp line.json -s 40 --kind affine -o out.exr
  # All but on one line, and a line that a plane would have to come from.
  sed 's/12.5, 9.5/12.5, 9.501/' line.json >thin.json
  refuse 3 "points 'to' on one line" guide warp thin.json -s 40 --kind affine -o out.exr
  sed 's/10.5, 8.5/25.5, 19.5/' pairs.json >source.json
  refuse 3 "points 'from' on one line" guide warp source.json -s 40 --kind affine -o out.exr
  sed 's/12.5, 9.5/12.5, 10.5/' line.json >wide.json
  accept guide warp wide.json -s 40 --kind affine -o out.exr -q
}

@test "options that are wrong" {
  bring pairs.json
  swap 1 40 0 guide warp pairs.json -s 40 -o out.exr
  swap 1 40 40x guide warp pairs.json -s 40 -o out.exr
  swap 1 rigid bent guide warp pairs.json --kind rigid -s 40 -o out.exr
  swap 1 2 0.2 guide warp pairs.json --alpha 2 -s 40 -o out.exr
  swap 1 2 nan guide warp pairs.json --alpha 2 -s 40 -o out.exr
  swap 1 out.exr out.png guide warp pairs.json -s 40 -o out.exr
  swap 2 out.exr none/out.exr guide warp pairs.json -s 40 -o out.exr
  swap 2 pairs.json none.json guide warp pairs.json -s 40 -o out.exr
  refuse 1 --size guide warp pairs.json -s 65536 -o out.exr
  refuse 1 --output guide warp pairs.json
  refuse 1 argument guide warp -o out.exr
  refuse 1 more.json guide warp pairs.json more.json -o out.exr
  refuse 1 --level guide warp pairs.json --level 3 -o out.exr
  refuse 1 'stylut guide warp' guide -q warp pairs.json -o out.exr
  refuse 1 'strokes, warp' guide bend pairs.json -o out.exr
  wait
}

@test "the README's way to bend a picture" {
  mkdir -p exemplars/pictures
  cp "$exemplars/warp.json" exemplars/
  # A picture that shows its own places.
  oiiotool --pattern fill:topleft=0.00111,0.00098:topright=0.99889,0.00098:bottomleft=0.00111,0.99902:bottomright=0.99889,0.99902 \
    450x512 3 -d uint16 -o exemplars/pictures/oil.png
  accept guide warp exemplars/warp.json -s 450x512 -o warp.exr
  sed -n '/^oiiotool exemplars\/pictures\/oil.png/,/bent.png$/p' "$STYLUT_ROOT/README.md" >bend.sh
  expect_less 'lines in the README' 1 "$(wc -l <bend.sh)"
  sed -i 's/-o bent.png/-d float -o bent.exr/' bend.sh
  bash bend.sh
  dump bent.exr R,G >bent.txt
  dump warp.exr motion.U,motion.V,A >field.txt
  # Well inside the picture, where the filter has all its pixels.
  expect_less 'pixels' 150000 "$(paste -d ' ' bent.txt field.txt | awk '$9 && $5 == $1 && $6 == $2' | wc -l)"
  expect 'pixels off by more than half' "$(paste -d ' ' bent.txt field.txt | awk '
    { u = $1 + 0.5 + $7; v = $2 + 0.5 + $8; du = 450 * $3 - u; dv = 512 * $4 - v }
    $9 && u > 5 && v > 5 && u < 445 && v < 507 && (du * du > 0.25 || dv * dv > 0.25)' | wc -l)" 0
}
