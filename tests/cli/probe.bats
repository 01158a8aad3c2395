#!/usr/bin/env bats
# stylut probe: one value's way through a table.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 31x24 --no-history -q -o wide.exr
  "$STYLUT" lut wide.exr -s 20 --no-history -q -o wide.lut.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -q -o creature.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -q -o creature8.png
  "$STYLUT" lut creature.exr -s 32 --no-history -q -o creature.lut.exr
  # Three islands of one value in a sea of another: 2x2, 3x1 and 1x1 that touches the second by a corner.
  oiiotool --create 12x10 3 --fill:color=0.2,0.5,0.9 12x10 --fill:color=0.8,0.5,0.9 2x2+1+1 \
    --fill:color=0.8,0.5,0.9 3x1+6+6 --fill:color=0.8,0.5,0.9 1x1+9+7 -d uint8 -o islands.png
  "$STYLUT" lut islands.png -s 8 --no-history -q -o islands.lut.png
}

# exact_engines: those that this build has.
exact_engines() {
  if [[ ${STYLUT_BUILD##*/} = *-nocgal ]]; then echo brute,flann-single,grid; else echo brute,flann-single,cgal,grid; fi
}

# near_value GUIDE X Y WIDTH: by an independent search 'x y distance' of the nearest
# pixel, and of the nearest that has another value.
near_value() {
  dump "$1" A,normal.X,normal.Y | awk -v gx="$2" -v gy="$3" '
    $3 > 0 { n++; at[n] = $1 " " $2; x[n] = $4; y[n] = $5; d[n] = sqrt((gx - $4) ^ 2 + (gy - $5) ^ 2) }
    END {
      for (k = 1; k <= n; k++) if (!best || d[k] < d[best] - 1e-9) best = k
      for (k = 1; k <= n; k++) if ((x[k] != x[best] || y[k] != y[best]) && (!next_best || d[k] < d[next_best] - 1e-9)) next_best = k
      printf "%s %.6f %s %.6f", at[best], d[best], at[next_best], d[next_best]
    }'
}

@test "each step is what an independent search finds" {
  bring 'wide*'
  local x y found texel
  # None of these lies between two pixels.
  for value in '0.31 -0.22' '-0.47 0.55' '0.013 0.871' '-0.93 -0.12' '0.93 0.91' '-1 -0.97' '1 1'; do
    x=${value% *} y=${value#* }
    accept probe wide.lut.exr --guide wide.exr "$x" "$y" --format json
    found=$output
    expect "exact of $value" "$(json - '(b => [...b.pixel, b.distance.toFixed(6), ...r.runner_up.pixel, r.runner_up.distance.toFixed(6)].join(" "))(r.engines[0])' <<<"$found")" \
      "$(near_value wide.exr "$x" "$y")"
    expect "engines of $value" "$(json - 'r.engines.map(e => e.engine).join()' <<<"$found")" "$(exact_engines)"
    expect "agreement of $value" "$(json - 'r.engines_agree && new Set(r.engines.map(e => e.pixel.join())).size === 1' <<<"$found")" true
    # The texel that holds the value, and what the table stores there.
    texel=$(awk -v x="$x" -v y="$y" 'BEGIN { i = int((x + 1) * 10); j = int((1 - y) * 10); print (i > 19 ? 19 : i), (j > 19 ? 19 : j) }')
    expect "texel of $value" "$(json - 'r.texel.at.join(" ")' <<<"$found")" "$texel"
    expect "stored of $value" "$(json - 'r.stored.pixel.join(" ")' <<<"$found")" \
      "$(dump wide.lut.exr u,v | awk -v at="$texel" '$1 " " $2 == at { print int($3 * 31), int($4 * 24) }')"
    expect_near "own value of $value" "$(json - 'r.texel.value.join(" ")' <<<"$found")" \
      "$(awk '{ print ($1 + 0.5) / 10 - 1, 1 - ($2 + 0.5) / 10 }' <<<"$texel")" 1e-6
    expect "exact at the texel of $value" "$(json - 'r.exact_at_texel.pixel.join(" ")' <<<"$found")" \
      "$(json - 'r.stored.pixel.join(" ")' <<<"$found")"
    expect "nearest at the texel of $value" "$(json - r.stored.from_texel.nearest <<<"$found")" true
    expect "nearest to $value" "$(json - r.stored.from_value.nearest <<<"$found")" \
      "$(json - 'r.stored.from_value.distance <= r.engines[0].distance' <<<"$found")"
  done
}

@test "distances in guide units, levels and degrees" {
  bring 'wide*'
  accept probe wide.lut.exr --guide wide.exr 0.31 -0.22 --format json
  # shellcheck disable=SC2016 # it is JavaScript
  json - '
    const lift = g => [...g, Math.sqrt(Math.max(0, 1 - g[0] ** 2 - g[1] ** 2))]
    const turn = (a, b) => Math.acos(Math.min(1, lift(a).reduce((s, v, k) => s + v * lift(b)[k], 0))) * 180 / Math.PI
    const check = (of, to, d) => Math.abs(Math.hypot(of[0] - to[0], of[1] - to[1]) - d.distance) < 1e-6 &&
      Math.abs(d.distance * 127.5 - d.levels) < 1e-9 && Math.abs(turn(of, to) - d.degrees) < 1e-3
    ;[[r.value, r.texel.value, r.texel], [r.value, r.stored.value, r.stored.from_value],
      [r.texel.value, r.stored.value, r.stored.from_texel], [r.texel.value, r.exact_at_texel.value, r.exact_at_texel],
      [r.value, r.runner_up.value, r.runner_up], ...r.engines.map(e => [r.value, e.value, e])].map(a => check(...a)).join()' <<<"$output" >checks.txt
  expect checks "$(tr ',' '\n' <checks.txt | sort | uniq -c | tr -s ' ')" " $((5 + $(exact_engines | tr ',' '\n' | wc -l))) true"
}

@test "text says what JSON says" {
  bring 'creature*'
  accept probe creature.lut.exr --guide creature.exr 0.25 0.5
  local text=$output lines
  accept probe creature.lut.exr --guide creature.exr 0.25 0.5 --format json
  lines=$(json - '[
    "value      (0.25, 0.5), inside the disc", `texel      (${r.texel.at.join(", ")}) of 32x32 (centre, map xy, metric xy)`,
    `stored     pixel (${r.stored.pixel.join(", ")}) of value (`,
    `exact      brute         pixel (${r.engines[0].pixel.join(", ")}) of value (`,
    `runner-up                pixel (${r.runner_up.pixel.join(", ")}) of value (`,
    `choice     ${r.ambiguity.pixels} source pixel`, ` in ${r.ambiguity.pieces} piece`].join("\n")' <<<"$output")
  local line
  while read -r line; do expect_holds text "$text" "$line"; done <<<"$lines"
  expect schema "$(json - r.schema <<<"$output")" stylut-probe/1
  expect 'keys' "$(json - 'Object.keys(r).join()' <<<"$output")" \
    schema,table,guide,value,inside_disc,texel,stored,exact_at_texel,engines,engines_agree,runner_up,ambiguity
  accept probe creature.lut.exr --guide creature.exr 0.25 0.5 -q
  expect quiet "$output" ''
  accept probe creature.lut.exr --guide creature.exr 1 1
  expect_holds text "$output" 'value      (1, 1), outside the disc'
}

@test "negative numbers are numbers" {
  bring 'wide*'
  accept probe wide.lut.exr --guide wide.exr -- -0.5 -0.25
  local expected=$output form
  local forms=('--guide wide.exr wide.lut.exr -0.5 -0.25' 'wide.lut.exr -0.5 --guide wide.exr -0.25'
    'wide.lut.exr -.5 -.25 --guide wide.exr' 'wide.lut.exr -5e-1 -25e-2 --guide=wide.exr' '-j 1 wide.lut.exr -0.5 -0.25 --guide wide.exr'
    'wide.lut.exr --guide wide.exr -0.5 -- -0.25' 'wide.lut.exr --guide wide.exr -0.50 -0.250')
  for form in "${forms[@]}"; do
    # shellcheck disable=SC2086
    accept probe $form
    expect "$form" "$output" "$expected"
  done
  # Zero has no sign.
  accept probe wide.lut.exr --guide wide.exr -0 -0
  expected=$output
  accept probe wide.lut.exr --guide wide.exr 0 0
  expect 'minus zero' "$output" "$expected"
}

@test "ambiguity: how many, in how many pieces, how far apart" {
  bring 'islands*'
  # 0.8 is byte 204, 0.5 is 128, 0.2 is 51.
  local x=0.6 y=0.003921569
  accept probe islands.lut.png --guide islands.png $x $y --format json
  expect islands "$(json - '(a => [a.pixels, a.pieces, a.ambiguous].join())(r.ambiguity)' <<<"$output")" 8,2,true
  expect_near spread "$(json - r.ambiguity.spread <<<"$output")" "$(awk 'BEGIN {
    n = split("1 2 1 2 6 7 8 9", x); split("1 1 2 2 6 6 6 7", y)
    for (k = 1; k <= n; k++) { sx += x[k] / n; sy += y[k] / n }
    for (k = 1; k <= n; k++) s += ((x[k] - sx) ^ 2 + (y[k] - sy) ^ 2) / n
    print sqrt(s) }')" 1e-6
  expect 'first island' "$(json - 'r.engines[0].pixel.join()' <<<"$output")" 1,1
  expect 'runner-up: the sea' "$(json - '[...r.runner_up.pixel, r.runner_up.value[0].toFixed(4)].join()' <<<"$output")" 0,0,-0.6000
  # All of it, when the guide can be trusted to nothing; two pieces less.
  accept probe islands.lut.png --guide islands.png $x $y --precision 255 --format json
  expect everything "$(json - '(a => [a.pixels, a.pieces, a.precision_levels].join())(r.ambiguity)' <<<"$output")" 120,1,255
  # One piece alone, and it is small.
  oiiotool --create 12x10 3 --fill:color=0.2,0.5,0.9 12x10 --fill:color=0.8,0.5,0.9 2x2+1+1 -d uint8 -o one.png
  accept lut one.png -s 8 -o one.lut.png
  accept probe one.lut.png --guide one.png $x $y --jump 0.71 --format json
  expect 'one island' "$(json - '(a => [a.pixels, a.pieces, a.spread.toFixed(4), a.ambiguous].join())(r.ambiguity)' <<<"$output")" 4,1,0.7071,false
  accept probe one.lut.png --guide one.png $x $y --jump 0.7 --format json
  expect 'one island, wide for that jump' "$(json - r.ambiguity.ambiguous <<<"$output")" true
}

@test "guides of one value have no runner-up" {
  oiiotool --create 4x4 3 --fill:color=0.5,0.5,1 4x4 -d uint8 -o flat.png
  accept lut flat.png -s 4 -o flat.lut.png
  accept probe flat.lut.png --guide flat.png 0.5 -0.5
  expect_holds text "$output" 'runner-up  none: all source pixels have one value'
  accept probe flat.lut.png --guide flat.png 0.5 -0.5 --format json
  expect runner-up "$(json - r.runner_up <<<"$output")" null
  accept guide sphere -s 1 -o one.exr
  accept lut one.exr -s 1 -o one.lut.exr
  accept probe one.lut.exr --guide one.exr -1 1
}

@test "every sampling, map and metric" {
  bring creature.exr creature8.png
  local guide options
  for guide in creature.exr creature8.png; do
    for options in '--sampling unorm8' '--sampling corner' '--map equal-area' '--metric angle' '--map equal-area --metric angle'; do
      # shellcheck disable=SC2086
      accept lut $guide -s 24 $options -o t.exr
      accept probe t.exr --guide $guide -0.31 0.44 --format json
      expect "$guide $options" "$(json - '[r.stored.from_texel.nearest, r.engines_agree, r.engines.length, r.table.size.join("x")].join()' <<<"$output")" \
        "true,true,$(exact_engines | tr ',' '\n' | wc -l),24x24"
      # shellcheck disable=SC2086
      expect "kind of $options" "$(json - '["--sampling " + r.table.sampling, "--map " + r.table.map, "--metric " + r.table.metric].join(" ")' <<<"$output" |
        grep -cF -- "${options%% --metric*}")" 1
    done
  done
  # A byte table of an 8-bit guide answers its own bytes without any error.
  accept lut creature8.png -s 256 --sampling unorm8 -o t.png
  local x y
  read -r x y < <(dump creature8.png A,R,G 255 | awk '$3 == 255 { printf "%.9f %.9f\n", $4 / 127.5 - 1, $5 / 127.5 - 1 }' | sed -n 400p)
  accept probe t.png --guide creature8.png "$x" "$y" --format json
  expect 'distances' "$(json - '[r.texel.distance, r.stored.from_value.distance, r.engines[0].distance].join()' <<<"$output")" 0,0,0
}

@test "a table that is wrong, and one that points at the background" {
  bring 'wide*'
  accept lut wide.exr -s 20 --no-history -o t.png
  accept probe t.png --guide wide.exr 0.31 -0.22 --format json
  expect 'right' "$(json - r.stored.from_texel.nearest <<<"$output")" true
  oiiotool t.png --rotate180 -o turned.png
  oiiotool t.png --fill:color=0,0,0 20x20 -o hole.png
  accept probe turned.png --guide wide.exr 0.31 -0.22 --format json
  expect 'turned' "$(json - '[r.stored.from_texel.nearest, r.stored.from_value.nearest, r.stored.covered, r.stored.from_value.degrees > 20].join()' <<<"$output")" false,false,true,true
  accept probe turned.png --guide wide.exr 0.31 -0.22
  expect_holds text "$output" 'degrees, not the nearest'
  expect_match text "$output" ' should be +pixel \('
  accept probe hole.png --guide wide.exr 0.31 -0.22
  expect_holds text "$output" "stored     pixel (0, 0), which isn't covered: no answer at all"
  accept probe hole.png --guide wide.exr 0.31 -0.22 --format json
  expect 'hole' "$(json - '[r.stored.covered, r.stored.value, r.stored.from_texel.nearest].join()' <<<"$output")" false,,false
}

@test "tables of other tools" {
  bring 'wide*'
  local encoding
  for encoding in rg8 rg16 rg8x2; do
    accept lut wide.exr -s 20 --encoding $encoding --no-history -o t.png
    accept probe t.png --guide wide.exr 0.31 -0.22
    local expected=$output
    # Without what the file says of itself.
    oiiotool --no-autopremult t.png --eraseattrib 'stylut:.*' -o bare.png
    accept probe bare.png --as $encoding --guide wide.exr 0.31 -0.22
    expect "as $encoding" "$output" "$expected"
  done
  refuse 3 bare.png probe bare.png --as rg16 --guide wide.exr 0.31 -0.22
  # StyleBlitUnity's rows are counted from the bottom, and need not be as many as columns.
  accept lut wide.exr -s 20 --sampling corner --encoding rg8 --no-history -o t.png
  accept probe t.png --guide wide.exr 0.31 -0.22 --format json
  local stored
  stored=$(json - 'r.stored.pixel.join()' <<<"$output")
  oiiotool t.png --mulc 1,-1,1 --addc 0,1,0 --eraseattrib 'stylut:.*' -o up.png
  accept probe up.png --as unity --guide wide.exr 0.31 -0.22 --format json
  expect 'as unity' "$(json - 'r.stored.pixel.join()' <<<"$output")" "$stored"
  expect sampling "$(json - r.table.sampling <<<"$output")" corner
  oiiotool up.png --cut 20x14+0+0 -o wide.png
  accept probe wide.png --as unity --guide wide.exr 0.31 -0.22 --format json
  expect size "$(json - 'r.table.size.join("x")' <<<"$output")" 20x14
}

@test "the published plugin's table" {
  need_data unity-plugin/lut.png unity-plugin/s_normals.png
  accept_warned 'facing away' probe "$data/unity-plugin/lut.png" --as unity --guide "$data/unity-plugin/s_normals.png" 0.3 -0.5 --format json
  expect size "$(json - 'r.table.size.join("x")' <<<"$output")" 600x456
  expect agree "$(json - r.engines_agree <<<"$output")" true
  expect_less 'degrees off' "$(json - r.stored.from_value.degrees <<<"$output")" 5
}

@test "arguments that make no sense" {
  bring 'wide*'
  local good=(probe wide.lut.exr --guide wide.exr 0.25 0.5 --precision 2 --jump 3 --as stylut)
  prove "${good[@]}"
  local bad
  for bad in 1.01 -1.01 2 -7 nan inf -inf -nan x 0.5x -0.5x -.x - 0x1 ' 0' 1e9; do
    swap 1 0.25 "$bad" "${good[@]}"
    swap 1 0.5 "$bad" "${good[@]}"
  done
  for bad in 0 -1 256 nan x; do swap 1 2 $bad "${good[@]}"; done
  for bad in 0 0.4 -5 65537 x; do swap 1 3 $bad "${good[@]}"; done
  swap 1 stylut unreal "${good[@]}"
  refuse 1 "table's file name" probe
  refuse 1 --guide probe wide.lut.exr 0 0
  refuse 1 'X Y' probe wide.lut.exr --guide wide.exr
  refuse 1 'found one number' probe wide.lut.exr --guide wide.exr -0.5
  refuse 1 -0.75 probe wide.lut.exr --guide wide.exr 0 0 -0.75
  refuse 1 '--guide' probe wide.lut.exr 0 0 --guide
  refuse 1 "argument after '0.5'" probe wide.lut.exr --guide wide.exr 0.5 ''
  wait
}

@test "options that make no sense here are not offered" {
  bring 'wide*'
  accept probe --help
  local option
  for option in --weights --frames --tolerance --seed --output --dry-run --no-history; do
    [[ $output != *$option* ]] || complain "--help lists $option"
    refuse 1 $option probe wide.lut.exr --guide wide.exr 0.25 0.5 $option 1
  done
  for option in --guide --as --precision --jump; do expect_holds '--help' "$output" $option; done
}

@test "inputs that can't be used" {
  bring 'wide*' creature.exr
  local good=(probe wide.lut.exr --guide wide.exr -0.25 0.5)
  mkdir folder.exr
  touch empty.exr
  printf 'no picture' >text.exr
  local bad file
  for file in wide.lut.exr wide.exr; do
    head -c 1000 $file >cut.exr
    swap 2 $file missing.exr "${good[@]}"
    swap 2 $file folder.exr "${good[@]}"
    for bad in empty.exr text.exr cut.exr; do swap 3 $file $bad "${good[@]}"; done
  done
  # A guide in the table's place and the reverse; another guide than the table's.
  swap 3 wide.lut.exr wide.exr "${good[@]}"
  swap 3 wide.exr wide.lut.exr "${good[@]}"
  swap 3 wide.exr creature.exr "${good[@]}"
  beside refuse 3 31x24 probe wide.lut.exr --guide creature.exr 0 0
  oiiotool wide.exr --mulc 0 -o nothing.exr
  swap 3 wide.exr nothing.exr "${good[@]}"
  oiiotool wide.exr --ch A,depth.Z -o bare.exr
  swap 3 wide.exr bare.exr "${good[@]}"
  oiiotool wide.lut.exr --mulc 3 -o far.exr
  swap 3 wide.lut.exr far.exr "${good[@]}"
  wait
}
