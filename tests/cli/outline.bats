#!/usr/bin/env bats
# stylut outline: lines around and inside what a frame shows.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 96 -c normal -q -o sphere.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 180x200 -c normal,depth,luma,object -q -o creature.exr
  "$STYLUT" guide scene "$exemplars/lit/lit.json" -s 240x213 -c normal,depth,object -q -o lit.exr
  "$STYLUT" toon --guide creature.exr -q -o toon.png
  "$STYLUT" toon --guide creature.exr --bits 16 -q -o toon16.png
}

# drawn FILE: pixels that have some line
drawn() { dump "$1" A count; }

@test "a sphere has one ring, half outside, as wide as was asked for" {
  bring sphere.exr
  local width
  for width in 0.5 1 2.5 7 64; do
    accept outline --guide sphere.exr --width $width -o out.png
    expect report "$output" 'out.png: 96x96, 7232 pixels covered'
    dump out.png A 255 >alpha.txt
    # The rim's pixels are 47.5 from the middle at most; those that touch the background a bit less. None is known where
    # the sphere touches the frame.
    awk -v w=$width '$1 > 7 && $1 < 88 && $2 > 7 && $2 < 88 { r = sqrt(($1 - 47.5) ^ 2 + ($2 - 47.5) ^ 2); near = r - 47.2; if (near < 0) near = -near
      if (near > w / 2 + 1.6 && $3 > 0) { print "stray", $0; bad = 1 }
      if (near < w / 2 - 1.6 && $3 < 255) { print "hole", $0; bad = 1 } } END { exit bad }' alpha.txt >wrong.txt ||
      complain "width $width: $(head -n 3 wrong.txt)"
  done
}

@test "without options: the creature's lines, thin, and by more than its silhouette" {
  bring creature.exr
  accept outline --guide creature.exr --format json -o out.png
  expect report "$(json - '[r.schema, r.size].join()' <<<"$output")" stylut-outline/1,180,200
  accept outline --guide creature.exr --object 0 --normal 0 --depth 0 -o rim.png
  expect_less 'rim alone' "$(drawn rim.png)" "$(drawn out.png)"
  accept outline --guide creature.exr --silhouette 0 -o inner.png
  expect_less 'inner lines alone' "$(drawn inner.png)" "$(drawn out.png)"
  expect_less 'lines are lines' "$(drawn out.png)" 7000
}

@test "a grazing floor is no line; what stands on it has one" {
  bring lit.exr
  accept outline --guide lit.exr --silhouette 0 --object 0 --normal 0 -o depth.png
  # Bottom right: floor alone.
  expect floor "$(dump depth.png A 255 | awk '$1 > 195 && $2 > 170 && $3 > 0' | wc -l)" 0
  expect_less 'lines of depth' 100 "$(drawn depth.png)"
  accept outline --guide lit.exr --silhouette 0 --depth 0 --normal 0 -o objects.png
  expect floor "$(dump objects.png A 255 | awk '$1 > 195 && $2 > 170 && $3 > 0' | wc -l)" 0
  expect_less 'lines between objects' 300 "$(drawn objects.png)"
}

@test "over a picture: beyond what it shows or inside alone" {
  bring creature.exr toon.png toon16.png
  accept outline --guide creature.exr --over toon.png --width 5 --colour 3060c0 -o out.png
  accept outline --guide creature.exr --over toon.png --width 5 --colour 3060c0 --inside -o inside.png
  expect 'alpha inside' "$(dump inside.png A 255 | sha256sum)" "$(dump toon.png A 255 | sha256sum)"
  expect_less 'alpha beyond' "$(drawn inside.png)" "$(drawn out.png)"
  expect 'line colour' "$(dump out.png R,G,B,A 255 | grep -c ' 48 96 192 255$' | awk '{ print ($1 > 500) }')" 1
  accept outline --guide creature.exr --over toon16.png --width 5 --colour 3060c0 -o from16.png
  paste -d' ' <(dump out.png R,G,B,A 255) <(dump from16.png R,G,B,A 65535) |
    awk '{ for (c = 3; c < 7; c++) { d = $(c + 6) - 257 * $c; if (d > 129 || d < -129) bad++; fine += d != 0 } }
      END { exit bad > 0 || fine < 100 }' || complain 'in 16 bits the picture is another one, or no finer'
  # Without alpha all is there; grey is grey in all three.
  oiiotool toon16.png --ch R -d uint16 -o grey16.png
  accept outline --guide creature.exr --over grey16.png --colour 00000000 -o grey.png
  expect grey "$(dump grey.png R,G,B,A 65535)" "$(dump grey16.png Y 65535 | awk '{ print $1, $2, $3, $3, $3, 65535 }')"
  # A colour that isn't there leaves the picture as it is.
  accept outline --guide creature.exr --over toon.png --colour 00000000 -o none.png
  expect pixels "$(dump none.png R,G,B,A 255 | sha256sum)" "$(dump toon.png R,G,B,A 255 | sha256sum)"
}

@test "noise, wobble, seeds, tolerances; the same for any number of threads" {
  bring creature.exr toon.png
  local k
  for k in noise=3 'noise=3 --texture=hatch' 'noise=3 --texture=toon.png' wobble=3 'wobble=3 --seed=5' 'noise=3 --seed=5' \
    angle=5 gap=0.2 width=3; do
    # shellcheck disable=SC2086
    accept outline --guide creature.exr --$k --no-history -o "$k.png"
  done
  expect 'distinct pictures' "$(sha256sum -- *=*.png | cut -d' ' -f1 | sort -u | wc -l)" 9
  accept outline --guide creature.exr --wobble 3 --no-history -j 1 -o one.png
  expect_same one.png wobble=3.png
  accept outline --guide creature.exr -o plain.png
  accept outline --guide creature.exr --over toon.png --noise 3 --texture toon.png -o out.png
  accept info out.png
  expect_holds history "$output" "stylut:input3 = $(sha256sum toon.png | cut -d' ' -f1)"
  expect_less 'noise breaks lines up' "$(drawn noise=3.png)" "$(drawn plain.png)"
}

@test "settings as an engine takes them" {
  bring creature.exr
  "$STYLUT" outline --guide creature.exr -o o.png --width 3 --gap 0.15 --depth 0.5 --format json >said.json
  expect settings "$(json said.json '[r.runtime.StyLine.width, r.runtime.StyOutline.depth_tolerance, r.runtime.StyOutline.depth_weight, r.runtime.StyOutline.threshold].join()')" 768,0.15,128,255
  "$STYLUT" toon --guide creature.exr -o t.png --colours 102030,ffffff80 --bands 0.5 --format json >said.json
  expect settings "$(json said.json '[r.runtime.StyToon.band_count, r.runtime.StyToon.thresholds, r.runtime.StyToon.colours].join()')" 2,128,16,32,48,255,255,255,255,128
}

@test "what is wrong is said in one line" {
  bring sphere.exr creature.exr toon.png
  local good=(outline --guide sphere.exr -o out.png)
  refuse 1 "'--guide'" outline -o out.png
  refuse 1 -o outline --guide sphere.exr
  refuse 1 out.tif outline --guide sphere.exr -o out.tif
  refuse 1 more "${good[@]}" more
  refuse 2 missing.exr outline --guide missing.exr -o out.png
  refuse 2 missing.png "${good[@]}" --over missing.png
  refuse 3 '180x200 pixels, expected 96x96' "${good[@]}" --over toon.png
  refuse 1 toon.png outline --guide creature.exr --over toon.png -o toon.png
  refuse 1 toon.png outline --guide creature.exr --noise 3 --texture toon.png -o toon.png
  refuse 1 --over "${good[@]}" --inside
  refuse 1 --width "${good[@]}" --width 0.4
  refuse 1 --width "${good[@]}" --width 65
  refuse 1 "'red'" "${good[@]}" --colour red
  refuse 1 --noise "${good[@]}" --texture hatch
  refuse 1 --wobble "${good[@]}" --seed 3
  refuse 1 --normal "${good[@]}" --normal 0 --angle 5
  refuse 1 --depth "${good[@]}" --depth 0 --object 0 --normal 0 --gap 5
  refuse 3 object.I "${good[@]}" --object 1
  refuse 3 depth.Z "${good[@]}" --depth 1
  refuse 3 depth.Z "${good[@]}" --gap 1
  oiiotool --create 8x8 4 -d uint8 -o empty.png
  accept_warned 'empty.png: found no covered pixel' outline --guide empty.png -o none.png
  expect 'no lines' "$(drawn none.png)" 0
  accept outline --guide sphere.exr --dry-run -o never.png
  [ ! -e never.png ] || complain 'a dry run wrote'
}
