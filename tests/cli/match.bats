#!/usr/bin/env bats
# stylut match, and lut --channels: whatever channels two guides have in common.
load helpers

light_paths=full.R,full.G,full.B,LDE.R,LDE.G,LDE.B,LSE.R,LSE.G,LSE.B,LD12E.R,LD12E.G,LD12E.B,LIE.R,LIE.G,LIE.B

# make_light_paths GUIDE OUT SEED: 15 channels that follow from the normals, with
# the noise of a path tracer, stored in another order than asked for.
make_light_paths() {
  oiiotool "$1" --ch normal.X,normal.Y,normal.Z,normal.X,normal.Y,normal.Z,normal.Z,normal.X,normal.Y,normal.Z,normal.X,normal.Y,normal.Z,normal.X,normal.Y \
    --mulc 0.3,0.3,0.3,0.5,0.4,0.5,0.2,0.1,0.1,0.6,0.5,0.5,0.1,0.1,0.2 --addc 0.4 --noise:type=gaussian:stddev=0.01:seed="$3" \
    --chnames $light_paths "$1" --ch A --chappend -o "$2"
}

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 40 -c all -q -o sphere.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -c all -q -o creature.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -q -o creature8.png
  make_light_paths sphere.exr paths.exr 1
  make_light_paths creature.exr frame.exr 2
}

# Exact engines that take any number of channels, or three.
any_engines='brute flann-single auto'
three_engines() { ! "$STYLUT" --version | grep -q 'CGAL [0-9]' || echo cgal; }

# covered FILE CHANNELS: covered pixels only, a line each.
covered() { dump "$1" "A,$2" | awk '$3 > 0'; }

# same_fields SOURCE TARGET CHANNELS ENGINE...: all give the bytes of brute.
same_fields() {
  local source=$1 target=$2 channels=$3 engine threads
  shift 3
  accept match "$source" "$target" --channels "$channels" -e brute -j 1 --no-history -o brute.exr || return 1
  for engine in "$@"; do
    accept match "$source" "$target" --channels "$channels" -e "$engine" -j 2 --no-history -o other.exr || return 1
    expect_same brute.exr other.exr
  done
  for threads in 1 3; do
    accept match "$source" "$target" --channels "$channels" -j $threads --no-history -o other.exr || return 1
    expect_same brute.exr other.exr
  done
}

@test "engines and threads give the same bytes" {
  bring '*.exr' '*.png'
  beside same_fields sphere.exr creature.exr normal.Y $any_engines
  beside same_fields sphere.exr creature8.png normal.X,normal.Y $any_engines $(three_engines) grid
  beside same_fields sphere.exr creature.exr normal:2,depth.Z:0.1 $any_engines
  beside same_fields sphere.exr creature.exr normal $any_engines $(three_engines)
  beside same_fields paths.exr frame.exr full,LDE,LSE,LD12E,LIE $any_engines
  wait
}

@test "a guide matched with itself gives every pixel itself, or the first like it" {
  bring '*.exr' '*.png'
  local file channels
  for file in sphere.exr:normal creature.exr:normal,position paths.exr:full,LIE creature.exr:object,depth creature8.png:normal; do
    channels=${file#*:} file=${file%:*}
    accept match $file $file --channels $channels -o self.exr --format json
    expect "largest distance of $file" "$(json - r.max_distance <<<"$output")" 0
    accept match $file $file --channels $channels -o self.png
    dump self.png R,G,B,A 65535 >found.txt
    expect "uncovered pixels of $file" "$(awk '$6 == 0 && ($3 || $4 || $5)' found.txt | wc -l)" 0
    expect "pixels of $file that find a later one" "$(awk '$6 > 0 && ($4 > $2 || ($4 == $2 && $3 > $1))' found.txt)" ''
    expect "covered pixels of $file" "$(awk '$6 == 65535' found.txt | wc -l)" "$(covered $file A | wc -l)"
    [ "$file" != sphere.exr ] || expect 'pixels of a sphere that find another' "$(awk '$6 > 0 && ($3 != $1 || $4 != $2)' found.txt)" ''
  done
}

@test "a sphere matched with a sphere is what its table says" {
  bring sphere.exr
  # The pixels of a sphere of 64 have the values of a table of 64.
  accept guide sphere -s 64 -o target.exr
  accept lut sphere.exr -s 64 -o table.exr
  accept match sphere.exr target.exr -o field.exr
  paste -d' ' <(dump target.exr A) <(dump table.exr u,v,error) <(dump field.exr u,v,error,A) >both.txt
  expect 'covered pixels that differ' "$(awk '$3 > 0 && ($6 != $11 || $7 != $12 || $8 != $13 || $14 != 1)' both.txt)" ''
  expect 'uncovered pixels with an answer' "$(awk '$3 == 0 && ($11 || $12 || $13 || $14)' both.txt)" ''
  expect 'covered pixels' "$(awk '$14 > 0' both.txt | wc -l)" "$(covered target.exr A | wc -l)"
  # The same as whole numbers.
  accept match sphere.exr target.exr -o field.png
  expect 'whole numbers' "$(dump field.png R,G,B,A 65535 | awk '$6 { print $1, $2, $3, $4 }')" \
    "$(awk '$14 > 0 { printf "%d %d %d %d\n", $1, $2, $11 * 40, $12 * 40 }' both.txt)"
}

@test "the field is what an independent search finds" {
  bring paths.exr frame.exr
  accept match paths.exr frame.exr --channels full:2,LSE.G,LIE.B:0.5 -o t.exr
  local channels=A,full.R,full.G,full.B,LSE.G,LIE.B
  dump paths.exr $channels >source.txt
  dump frame.exr $channels | paste -d' ' - <(dump t.exr u,v,error,A) >target.txt
  awk '
    BEGIN { split("2 2 2 1 0.5", w) }
    NR == FNR { if ($3 > 0) { for (k = 1; k <= 5; k++) s[n, k] = $(3 + k) * w[k]; at[$1 " " $2] = n++ } next }
    $3 == 0 { if ($14) print "answered: " $0; next }
    {
      least = 9e9
      for (p = 0; p < n; p++) { d = 0; for (k = 1; k <= 5; k++) d += ($(3 + k) * w[k] - s[p, k]) ^ 2; if (d < least) least = d }
      key = int($11 * 40) " " int($12 * 40)
      if (!(key in at)) { print "no source pixel: " $0; next }
      p = at[key]; d = 0
      for (k = 1; k <= 5; k++) d += ($(3 + k) * w[k] - s[p, k]) ^ 2
      if (sqrt(d) > sqrt(least) + 1e-6 || sqrt(d) - $13 > 1e-6 || $13 - sqrt(d) > 1e-6) print "not nearest: " $0
      count++
    }
    END { if (!count) print "nothing asked" }' source.txt target.txt >wrong.txt
  expect wrong "$(head -n 3 wrong.txt)" ''
}

@test "an approximate engine says so, and more checks find more" {
  bring paths.exr frame.exr
  accept match paths.exr frame.exr --channels full,LDE,LSE,LD12E,LIE -o exact.exr --format json
  expect 'exact engine' "$(json - '[r.engine, r.exact, r.dims].join()' <<<"$output")" flann-single,true,15
  dump exact.exr u,v,A >exact.txt
  local checks misses last=1
  for checks in 8 1024; do
    accept match paths.exr frame.exr -c full,LDE,LSE,LD12E,LIE -e flann-forest --trees 4 --checks $checks -o t.exr --format json
    expect 'approximate engine' "$(json - '[r.engine, r.exact].join()' <<<"$output")" flann-forest,false
    dump t.exr u,v,A >found.txt
    misses=$(paste -d' ' exact.txt found.txt | awk '$5 > 0 { n++; if ($3 != $8 || $4 != $9) miss++ } END { print miss / n }')
    expect_less "misses with $checks checks" "$misses" "$last"
    last=0.05
  done
}

@test "coverage, colours and names" {
  bring creature8.png creature.exr sphere.exr
  # A target that shows nothing is answered with nothing.
  oiiotool creature8.png --mulc 0 -o empty.png
  accept_warned 'empty.png: found no covered pixel' match sphere.exr empty.png -o t.exr --format json
  expect 'pixels of an empty target' "$(json - '[r.pixels, r.mean_distance].join()' <<<"$output")" 0,0
  expect 'values of an empty target' "$(dump t.exr A count)" 0
  # Pictures by their colours, with their own alpha.
  accept match creature8.png creature8.png --channels R,G,B -o t.png --format json
  expect facts "$(json - '[r.channels.join(), r.max_distance].join()' <<<"$output")" R,G,B,0
  # Without A, pixels with a normal are covered, and other layers are there still.
  oiiotool creature.exr --ch depth.Z,normal.X,normal.Y,normal.Z -o bare.exr
  accept match creature.exr bare.exr --channels normal,depth.Z -o a.exr --no-history
  accept match creature.exr creature.exr --channels normal,depth.Z -o b.exr --no-history
  expect_same a.exr b.exr
}

@test "match's report, and what the file says" {
  bring sphere.exr creature.exr
  accept match sphere.exr creature.exr --channels normal:2,depth.Z:0.5 -o t.exr --format json
  expect facts "$(json - '[r.schema, r.engine, r.exact, r.channels.join(" "), r.weights.join(" "), r.dims].join()' <<<"$output")" \
    'stylut-match/1,flann-single,true,normal.X normal.Y normal.Z depth.Z,2 2 2 0.5,4'
  expect pixels "$(json - '[r.pixels, r.points].join()' <<<"$output")" "$(covered creature.exr A | wc -l),$(covered sphere.exr A | wc -l)"
  expect distinct "$(json - r.distinct <<<"$output")" "$(covered sphere.exr normal.X,normal.Y | wc -l)"
  expect times "$(json - 'Object.keys(r.time_ms).sort().join()' <<<"$output")" read,search,write
  expect_near 'mean and largest distance' "$(json - '[r.mean_distance, r.max_distance].join(" ")' <<<"$output")" \
    "$(dump t.exr A,error | awk '$3 > 0 { n++; sum += $4; if ($4 > most) most = $4 } END { print sum / n, most }')" 1e-6
  accept info t.exr --format json
  expect attributes "$(json - '["kind", "source", "channels"].map(k => r.attributes["stylut:" + k]).join(" ")' <<<"$output")" \
    'field 40x40 normal.X:2,normal.Y:2,normal.Z:2,depth.Z:0.5'
  expect hashes "$(json - '[1, 2].map(i => r.attributes["stylut:input" + i]).join()' <<<"$output")" \
    "$(sha256sum sphere.exr creature.exr | cut -d' ' -f1 | paste -sd,)"
  accept match sphere.exr creature.exr -o t.png
  expect_match report "$output" '^t.png: [0-9]+ pixels matched with [0-9]+ source pixels, [0-9]+ distinct values, by normal.X,normal.Y
engine [a-z-]+, exact; distance'
  refuse 1 '3 dimensions' match sphere.exr creature.exr --channels normal -e analytic -o none.png --dry-run
  accept match sphere.exr creature.exr -o none.png --dry-run
  expect_holds 'dry run' "$output" 'would write none.png: 60x50 pixels by 2 channels'
  [ ! -e none.png ] || complain 'a dry run writes'
  # A field is no table.
  complain_unless_refused 3 field check t.exr --guide sphere.exr
}

@test "bad input gets one line" {
  bring sphere.exr creature.exr paths.exr frame.exr
  local good=(match sphere.exr creature.exr --channels normal,depth.Z -o out.exr)
  swap 2 sphere.exr missing.exr "${good[@]}"
  swap 2 creature.exr missing.exr "${good[@]}"
  swap 1 out.exr out.jpg "${good[@]}"
  swap 1 out.exr sphere.exr "${good[@]}"
  swap 1 out.exr creature.exr "${good[@]}"
  wait
  local channels
  for channels in , normal, normal:0 normal:x normal:1:2 normal,normal normal.X,normal :2 normal:1e9; do
    refuse 1 "" match sphere.exr creature.exr --channels "$channels" -o out.exr
  done
  # What is missing, where, and what is there.
  refuse 3 'sphere.exr: found no channel glow, expected one of A, ' match sphere.exr creature.exr --channels glow -o out.exr
  refuse 3 'sphere.exr: found no channel full.R, expected one of A, ' match sphere.exr paths.exr --channels full.R -o out.exr
  refuse 3 'sphere.exr: found no channel full.R, expected one of A, ' match paths.exr sphere.exr --channels full -o out.exr
  refuse 3 LIE.B match sphere.exr paths.exr --channels depth.Z -o out.exr
  # Engines that don't know so many dimensions.
  refuse 1 'engine grid: found values of 4 dimensions, expected one of these engines: brute flann-single flann-forest' "${good[@]}" -e grid
  refuse 1 analytic match sphere.exr creature.exr --channels normal -e analytic -o out.exr
  refuse 1 'engine grid: found values of 1 dimension,' match sphere.exr creature.exr --channels depth.Z -e grid -o out.exr
  ! "$STYLUT" --version | grep -q 'CGAL [0-9]' || refuse 1 cgal "${good[@]}" -e cgal
  refuse 1 kd match sphere.exr creature.exr -e kd -o out.exr
  refuse 1 --checks match sphere.exr creature.exr -e flann-forest --checks 0 -o out.exr
  # Numbers that are none, and too large ones; where nothing is covered they don't matter.
  oiiotool paths.exr --ch full.R,A --mulc 2000,1 -o large.exr
  refuse 3 'large.exr: found full.R = ' match large.exr paths.exr --channels full.R -o out.exr
  refuse 3 'large.exr: found full.R = ' match paths.exr large.exr --channels full.R -o out.exr
  prove match large.exr paths.exr --channels full.R:0.25 -o out.exr
  oiiotool sphere.exr --ch normal.X,depth.Z,A=0 -o nothing.exr
  refuse 3 'nothing.exr: found no covered pixel' match nothing.exr creature.exr --channels depth.Z -o out.exr
  oiiotool --create 4x4 1 --chnames Y -o grey.exr
  refuse 3 grey.exr match grey.exr creature.exr -o out.exr
  refuse 1 'after the source' match sphere.exr -o out.exr
  refuse 1 third.exr match sphere.exr creature.exr third.exr -o out.exr
  refuse 1 --output match sphere.exr creature.exr
}

# ---- tables of three dimensions ----

@test "lut --channels: texel by texel what an independent search finds" {
  bring creature.exr
  accept_warned "outside the table" lut creature.exr --channels normal.X,normal.Y:2,position.Z:0.5 -s 6 -o t.exr
  expect_holds report "$output" '6x6x6 texels'
  dump creature.exr A,normal.X,normal.Y,position.Z >guide.txt
  dump t.exr u,v,error >table.txt
  awk '
    NR == FNR { if ($3 > 0) { x[n] = $4; y[n] = 2 * $5; z[n] = $6 / 2; at[$1 " " $2] = n++ } next }
    {
      gx = ($1 + 0.5) / 6 * 2 - 1; gy = 2 * (1 - ($2 % 6 + 0.5) / 6 * 2); gz = (int($2 / 6) + 0.5) / 6 / 2
      least = 9e9
      for (p = 0; p < n; p++) { d = (gx - x[p]) ^ 2 + (gy - y[p]) ^ 2 + (gz - z[p]) ^ 2; if (d < least) least = d }
      key = int($3 * 60) " " int($4 * 50)
      if (!(key in at)) { print "no source pixel: " $0; next }
      p = at[key]
      d = (gx - x[p]) ^ 2 + (gy - y[p]) ^ 2 + (gz - z[p]) ^ 2
      if (sqrt(d) > sqrt(least) + 1e-6 || sqrt(d) - $5 > 1e-6 || $5 - sqrt(d) > 1e-6) print "not nearest: " $0
    }
    END { if (FNR != 216) print FNR " texels" }' guide.txt table.txt >wrong.txt
  expect wrong "$(head -n 3 wrong.txt)" ''
  # All engines that can, on any number of threads.
  local engine
  for engine in $any_engines $(three_engines); do
    accept lut creature.exr --channels normal.X,normal.Y:2,position.Z:0.5 -s 6 -e $engine -q -j 2 --no-history -o $engine.exr
    expect_same brute.exr $engine.exr
  done
  # As whole numbers.
  accept lut creature.exr --channels normal.X,normal.Y:2,position.Z:0.5 -s 6 -q -o t.png
  expect 'whole numbers' "$(dump t.png R,G 65535)" "$(awk '{ printf "%d %d %d %d\n", $1, $2, $3 * 65535 + 0.5, $4 * 65535 + 0.5 }' table.txt)"
}

@test "lut --channels: what the file and the report say" {
  bring creature.exr
  local engine=cgal
  "$STYLUT" --version | grep -q 'CGAL [0-9]' || engine=flann-single
  accept lut creature.exr --channels normal:0.5 -s 5 -o t.exr --format json
  expect facts "$(json - '[r.schema, r.engine, r.exact, r.size, r.channels.join(" "), r.weights.join(" "), r.dims].join()' <<<"$output")" \
    "stylut-lut/1,$engine,true,5,normal.X normal.Y normal.Z,0.5 0.5 0.5,3"
  accept info t.exr
  expect_holds info "$output" '5x25 pixels'
  expect_holds info "$output" 'stylut:depth = 5'
  expect_holds info "$output" 'stylut:channels = normal.X:0.5,normal.Y:0.5,normal.Z:0.5'
  # What takes flat tables only says so.
  complain_unless_refused 3 'three dimensions (normal.X, normal.Y, normal.Z)' check t.exr --guide creature.exr
  refuse 3 'three dimensions' report t.exr --guide creature.exr -o out.html
  complain_unless_refused 3 'three dimensions' probe t.exr --guide creature.exr 0 0
  cp "$exemplars/spheres/oil.png" .
  accept guide sphere -s 512 -o oil.exr
  accept lut oil.exr --channels normal -s 5 -o oil-cube.exr
  echo '{ "schema": "stylut-bundle/1", "styles": [ { "name": "oil", "exemplar": "oil.png", "guide": "oil.exr", "lut": "oil-cube.exr" } ] }' >m.json
  refuse 3 'three dimensions' pack m.json -o bundle
}

@test "lut --channels: what doesn't go, and what takes too much" {
  bring creature.exr
  local cube=(lut creature.exr --channels normal -o out.exr) option
  prove "${cube[@]}" -s 4
  for option in '--sampling unorm8' '--map equal-area' '--metric angle' '--resolve coherent' '--size auto --max-p99 3'; do
    # shellcheck disable=SC2086
    refuse 1 "${option%% *}" "${cube[@]}" $option
  done
  refuse 1 'found 2 (normal.X,normal.Y), expected three' lut creature.exr --channels normal.X,normal.Y -o out.exr
  refuse 1 'expected three' lut creature.exr --channels normal,depth -o out.exr
  refuse 3 'creature.exr: found no channel glow.Y' lut creature.exr --channels normal.X,normal.Y,glow.Y -o out.exr
  refuse 1 grid "${cube[@]}" -e grid -s 4
  # size^3 and the bytes are said.
  refuse 1 'found 1024, 1073741824 texels (1024^3) that take 21474836480 bytes, expected at most --max-memory 1073741824' "${cube[@]}" -s 1024
  refuse 1 'found 300, expected 1 to 256' "${cube[@]}" -s 300
  refuse 1 'found 64, 262144 texels (64^3) that take 5242880 bytes' "${cube[@]}" --max-memory 5242879
  refuse 1 'expected at most --max-memory 5242880' "${cube[@]}" -s 65 --max-memory 5M
  accept "${cube[@]}" --max-memory 5M --dry-run
  expect_holds 'dry run' "$output" '64x64x64 texels: 262144 texels that take 5242880 bytes'
  [ ! -e out.exr ] || complain 'a dry run writes'
  prove "${cube[@]}" -s 8 --max-memory 10K
  for option in 0 -1 1T 1.5G x K; do refuse 1 --max-memory "${cube[@]}" --max-memory $option; done
  refuse 1 --max-memory lut creature.exr -s 8 --max-memory 1G -o out.exr
}
