#!/usr/bin/env bats
# stylut toon: frames in steps of light.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 96 -c normal -q -o sphere.exr
  "$STYLUT" guide sphere -s 96 -q -o sphere.png
  "$STYLUT" guide scene "$exemplars/lit/lit.json" -s 160x142 -c normal,depth,luma,object,albedo -q -o lit.exr
  oiiotool --pattern checker:width=4:height=4 8x8 3 -d uint8 -o checker.png
}

# colours FILE: the colours in a picture, each once, as R.G.B.A
colours() { dump "$1" R,G,B,A 255 | awk '{ print $3 "." $4 "." $5 "." $6 }' | sort -u | tr '\n' ' '; }

@test "a sphere in three greys, lit from the upper left, without options" {
  bring sphere.exr
  accept toon --guide sphere.exr -o out.png
  expect report "$output" 'out.png: 96x96, 7232 pixels covered'
  expect colours "$(colours out.png)" '0.0.0.0 170.170.170.255 255.255.255.255 85.85.85.255 '
  dump out.png R 255 | awk '{ v[$1 "," $2] = $3 } END { exit !(v["30,25"] == 255 && v["78,70"] == 85) }' ||
    complain 'the light comes from elsewhere than the upper left'
  accept toon --guide sphere.exr -o other.png --light=-40,40 --format json
  expect report "$(json - '[r.schema, r.size, r.covered].join()' <<<"$output")" stylut-toon/1,96,96,7232
  expect pixels "$(dump other.png R,G,B,A 255 | sha256sum)" "$(dump out.png R,G,B,A 255 | sha256sum)"
}

@test "bands are where the cosine says, in the colours that were named" {
  bring sphere.exr
  accept toon --guide sphere.exr --light 0,0 --bands 0.5,0.8 --colours 102030,ff000080,0A0B0C --no-history -o out.png
  paste -d' ' <(dump sphere.exr normal.Z,A) <(dump out.png R,A 255) >all.txt
  awk '$4 == 1 { l = int($3 * 255 + 0.5); want = l < 128 ? "16 255" : l < 204 ? "255 128" : "10 255"
    if ($7 " " $8 != want) { print; bad = 1 } } END { exit bad }' all.txt >wrong.txt || complain "$(head -n 3 wrong.txt)"
  # A normal map of bytes will do.
  bring sphere.png
  accept toon --guide sphere.png --light 0,0 --bands 0.5 --colours 000000,ffffff -o two.png
  expect colours "$(colours two.png)" '0.0.0.0 0.0.0.255 255.255.255.255 '
}

@test "luma.Y lights, without what the surface's own colour did to it; albedo colours" {
  bring lit.exr
  accept toon --guide lit.exr -o out.png
  accept toon --guide lit.exr --albedo 0 -o grey.png
  expect 'greys alone' "$(colours grey.png)" '0.0.0.0 170.170.170.255 255.255.255.255 85.85.85.255 '
  # Lit floor is white between dark and light tiles alike: bottom right.
  expect 'lit floor' "$(dump grey.png R 255 | awk '$1 > 130 && $2 > 125 { print $3 }' | sort -u)" 255
  # White bands of full albedo are the albedo, as sRGB.
  oiiotool lit.exr --ch albedo.R,albedo.G,albedo.B --chnames R,G,B --colorconvert linear sRGB -d uint8 -o albedo.png
  accept toon --guide lit.exr --bands 0.5 --colours ffffff,ffffff -o white.png
  paste -d' ' <(dump albedo.png R,G,B 255) <(dump white.png R,G,B,A 255) >all.txt
  awk '$11 > 0 { for (c = 3; c < 6; c++) { d = $c - $(c + 5); if (d * d > 1) bad++ } } END { exit bad > 0 }' all.txt ||
    complain 'white bands differ from the albedo'
}

@test "patterns: the builtin ones, a picture; flat and in cells; seeds; 16 bits; threads" {
  bring sphere.exr checker.png
  local k
  for k in 'texture=hatch' 'texture=noise' 'texture=checker.png' 'texture=hatch --orient=flat' 'texture=hatch --cell=8' \
    'texture=hatch --jitter=0.2' 'texture=hatch --strength=0.4' 'texture=hatch --seed=7'; do
    # shellcheck disable=SC2086
    accept toon --guide sphere.exr --$k --no-history -o "$k.png"
  done
  expect 'distinct pictures' "$(sha256sum -- *=*.png | cut -d' ' -f1 | sort -u | wc -l)" 8
  accept toon --guide sphere.exr --texture checker.png -o out.png
  accept info out.png
  expect_holds history "$output" "stylut:input2 = $(sha256sum checker.png | cut -d' ' -f1)"
  accept toon --guide sphere.exr --texture hatch --no-history -j 1 -o one.png
  expect_same one.png texture=hatch.png
  accept toon --guide sphere.exr --texture hatch --no-history --bits 16 -o wide.png
  expect 'same in 16 bits' "$(dump wide.png R,G,B,A 65535 | awk '{ print $3 / 257, $6 / 257 }' | sha256sum)" \
    "$(dump one.png R,G,B,A 255 | awk '{ print $3, $6 }' | sha256sum)"
}

@test "what is wrong is said in one line" {
  bring sphere.exr checker.png lit.exr
  local good=(toon --guide sphere.exr -o out.png)
  accept "${good[@]}"
  rm out.png
  refuse 1 "'--guide'" toon -o out.png
  refuse 1 -o toon --guide sphere.exr
  refuse 1 out.exr toon --guide sphere.exr -o out.exr
  refuse 1 more "${good[@]}" more
  refuse 2 missing.exr toon --guide missing.exr -o out.png
  refuse 2 missing.png "${good[@]}" --texture missing.png
  refuse 1 'luminances that grow' "${good[@]}" --bands 0.5,0.2
  refuse 1 --bands "${good[@]}" --bands 0.5,
  refuse 1 'at most 7' "${good[@]}" --bands .1,.2,.3,.4,.5,.6,.7,.8
  refuse 1 'one per band' "${good[@]}" --colours ff0000
  refuse 1 "'ff00'" "${good[@]}" --colours ff00,000000,ffffff
  refuse 1 --light "${good[@]}" --light 30
  refuse 1 --cell "${good[@]}" --texture hatch --cell 33
  refuse 1 --orient "${good[@]}" --texture hatch --orient up
  refuse 1 --texture "${good[@]}" --strength 0.5
  refuse 1 --texture "${good[@]}" --orient flat
  refuse 1 cells "${good[@]}" --texture hatch --orient flat --cell 8
  refuse 3 albedo.R "${good[@]}" --albedo 0.5
  cp checker.png out.png
  refuse 1 out.png "${good[@]}" --texture out.png
  oiiotool --create 8x8 4 -d uint8 -o empty.png
  accept_warned 'empty.png: found no covered pixel' toon --guide empty.png -o none.png
  accept toon --guide sphere.exr --dry-run -o never.png
  [ ! -e never.png ] || complain 'a dry run wrote'
}
