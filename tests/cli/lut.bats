#!/usr/bin/env bats
# stylut lut and check: tables from every exact engine, and their audit.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 40 -q -o sphere.exr
  "$STYLUT" guide sphere -s 31x24 -q -o wide.exr
  "$STYLUT" guide sphere -s 40 -q -o sphere8.png
  "$STYLUT" guide sphere -s 40 --bits 16 -q -o sphere16.png
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -q -o creature.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -q -o creature8.png
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 --bits 16 -q -o creature16.png
}

# same_tables GUIDE SIZE ENGINE...: all give the bytes of brute.
same_tables() {
  local guide=$1 size=$2 engine kind
  shift 2
  for kind in '' '--sampling unorm8' '--map equal-area'; do
    # shellcheck disable=SC2086
    accept lut "$guide" -s "$size" $kind -e brute --no-history -q -o brute.exr || return 1
    for engine in "$@"; do
      rm -f other.exr
      # shellcheck disable=SC2086
      accept lut "$guide" -s "$size" $kind -e "$engine" --no-history -q -o other.exr || return 1
      expect_same brute.exr other.exr
    done
  done
}

# All exact engines of this build but brute.
exact_engines() {
  local engines='flann-single grid auto'
  ! "$STYLUT" --version | grep -q 'CGAL [0-9]' || engines+=' cgal'
  echo "$engines"
}

# same_by_angle GUIDE SIZE: the other metric, which the analytic engine doesn't know.
same_by_angle() {
  local map engine
  for map in xy equal-area; do
    accept lut "$1" -s "$2" --metric angle --map $map -e brute --no-history -o brute.exr || return 1
    for engine in $(exact_engines); do
      accept lut "$1" -s "$2" --metric angle --map $map -e "$engine" --no-history -o other.exr || return 1
      expect_same brute.exr other.exr
    done
  done
}

@test "engines give the same bytes: spheres" {
  bring 'sphere*' wide.exr
  beside same_tables sphere.exr 48 $(exact_engines) analytic
  beside same_tables wide.exr 33 $(exact_engines) analytic
  beside same_tables sphere8.png 48 $(exact_engines)
  beside same_tables sphere16.png 48 $(exact_engines)
  wait
}

@test "engines give the same bytes: the creature" {
  bring 'creature*'
  beside same_tables creature.exr 64 $(exact_engines)
  beside same_tables creature8.png 64 $(exact_engines)
  beside same_tables creature16.png 64 $(exact_engines)
  wait
}

@test "engines give the same bytes: by angle" {
  bring sphere.exr creature8.png creature.exr
  beside same_by_angle sphere.exr 40
  beside same_by_angle creature8.png 40
  beside same_by_angle creature.exr 40
  wait
}

@test "vector units and threads give the same bytes" {
  accept guide sphere -s 300 -o large.exr
  local unit threads
  accept lut large.exr -s 200 -e flann-single --no-history -o reference.exr
  for unit in plain avx2 avx512; do
    for threads in 1 2 3; do
      STYLUT_VECTOR=$unit accept lut large.exr -s 200 -e grid -j $threads --no-history -o $unit.exr
      expect_same reference.exr $unit.exr
    done
  done
}

@test "approximate engines say that they are, and err little" {
  bring creature.exr
  local engine
  for engine in flann-forest flann-auto; do
    accept lut creature.exr -s 64 -e $engine -o t.exr --format json
    expect "$engine is exact" "$(json - r.exact <<<"$output")" false
    accept check t.exr --guide creature.exr --format json --max-excess 5
    expect_less "share of $engine's misses" "$(json - '1 - r.optimal' <<<"$output")" 0.6
  done
  # As many checks as it takes: to miss next to nothing, and more than with fewer.
  accept lut creature.exr -s 64 -e flann-auto --precision 1 -o best.exr
  accept check best.exr --guide creature.exr --format json
  local misses
  misses=$(json - '1 - r.optimal' <<<"$output")
  expect_less 'misses at precision 1' "$misses" 0.05
  accept lut creature.exr -s 64 -e flann-auto --precision 0.2 -o worst.exr
  accept check worst.exr --guide creature.exr --format json
  expect_less 'misses at precision 1, at 0.2' "$misses" "$(json - '1 - r.optimal' <<<"$output")"
  accept lut creature.exr -s 64 -e flann-forest --trees 8 --checks 512 -o more.exr
  accept check more.exr --guide creature.exr --format json
  expect_less 'misses with more checks' "$(json - '1 - r.optimal' <<<"$output")" 0.05
}

@test "--size auto takes the smallest table that meets the budget" {
  accept guide sphere -s 200 -o large.exr
  local size
  accept lut large.exr -s auto --max-p99 4 --encoding rg16 --no-history -o auto.png --format json
  size=$(json - r.size <<<"$output")
  expect 'chosen candidate' "$(json - 'r.candidates.filter(c => c.chosen).map(c => [c.size, c.bytes / 4, c.lookup_p99 <= 4]).join()' <<<"$output")" "$size,$((size * size)),true"
  expect 'candidates that do with less' "$(json - "r.candidates.filter(c => c.size < $size && c.lookup_p99 <= 4).length" <<<"$output")" 0
  accept check auto.png --guide large.exr --max-p99 4
  accept lut large.exr -s $((size * 100 / 142)) --encoding rg16 -o smaller.png
  refuse_check smaller.png
  accept lut large.exr -s "$size" --encoding rg16 --no-history -o same.png
  expect_same auto.png same.png
  # Equal areas do with less on a sphere.
  accept lut large.exr -s auto --max-p99 4 --map auto --encoding rg16 -o either.png --format json
  expect map "$(json - r.map <<<"$output")" equal-area
  expect_less 'size of either map' "$(json - r.size <<<"$output")" "$size"
  # What can't be met is said.
  local status=0
  output=$("$STYLUT" lut large.exr -s auto --max-p99 0.01 -o none.exr 2>error.txt) || status=$?
  expect status $status 6
  expect_match 'what came nearest' "$output" '[*] xy +[0-9]+: .* p99 [0-9.]+,'
  expect_match message "$(cat error.txt)" '^stylut: error: --max-p99: found [0-9.]+ degrees at best .* expected at most 0.01$'
  status=0
  output=$("$STYLUT" lut large.exr -s auto --max-p99 0.01 -o none.exr --format json 2>error.txt) || status=$?
  expect status $status 6
  expect 'what was tried' "$(json - '[r.size, r.candidates.length > 5, r.candidates.some(c => c.chosen)].join()' <<<"$output")" ,true,false
  [ ! -e none.exr ] || complain "none.exr was written"
  refuse 1 unorm8 lut large.exr -s auto --max-p99 4 --sampling unorm8 --map equal-area -o none.exr
  prove lut large.exr -s auto --max-p99 4 --frames large.exr large.exr -o framed.exr
  refuse 1 max-p99 lut large.exr -s auto -o none.exr
  cp large.exr frame.exr
  refuse 1 frame.exr lut large.exr -s auto --max-p99 4 --frames frame.exr -o frame.exr
  expect_same large.exr frame.exr
  refuse 1 auto lut large.exr -s 64 --max-p99 1 -o none.exr
  refuse 1 auto lut large.exr -s 64 --map auto -o none.exr
}
refuse_check() {
  local status=0
  "$STYLUT" check "$1" --guide large.exr --max-p99 4 >/dev/null 2>&1 || status=$?
  expect "status of $1" $status 6
}

@test "the table that a plugin ships is judged" {
  need_data unity-plugin/lut.png unity-plugin/s_normals.png
  accept_warned 'facing away' check "$data/unity-plugin/lut.png" --guide "$data/unity-plugin/s_normals.png" --as unity --format json
  expect 'share of nearest pixels' "$(json - 'r.optimal.toFixed(3)' <<<"$output")" 0.358
  expect background "$(json - r.background <<<"$output")" 307
  expect size "$(json - '[r.size, r.height].join()' <<<"$output")" 600,456
  accept_warned 'facing away' lut "$data/unity-plugin/s_normals.png" -s 256 -o ours.exr
  accept_warned 'facing away' check ours.exr --guide "$data/unity-plugin/s_normals.png" --max-excess 0 --format json
  expect 'share of nearest pixels of ours' "$(json - r.optimal <<<"$output")" 1
}

@test "engines give the same bytes: painters' guides" {
  need_data unity-plugin/s_normals.png frames/golem.001.png
  same_tables "$data/unity-plugin/s_normals.png" 24 $(exact_engines)
  same_tables "$data/frames/golem.001.png" 16 $(exact_engines)
}

@test "the table is what an independent search finds" {
  accept guide sphere -s 13x11 -c normal -o g.exr
  accept lut g.exr -s 15 -o t.exr
  dump g.exr A,normal.X,normal.Y >guide.txt
  dump t.exr u,v,error >table.txt
  awk '
    BEGIN { n = 0 }
    NR == FNR { if ($3 == 1) { x[n] = $4; y[n] = $5; at[$1 " " $2] = n++ } next }
    {
      gx = ($1 + 0.5) / 15 * 2 - 1; gy = 1 - ($2 + 0.5) / 15 * 2
      least = 9
      for (k = 0; k < n; k++) { d = sqrt((gx - x[k]) ^ 2 + (gy - y[k]) ^ 2); if (d < least) least = d }
      px = $3 * 13 - 0.5; py = $4 * 11 - 0.5
      key = int(px + 0.5) " " int(py + 0.5)
      off = px - int(px + 0.5) + py - int(py + 0.5)
      if (!(key in at) || off > 1e-3 || off < -1e-3) { print "no source pixel: " $0; exit }
      k = at[key]
      d = sqrt((gx - x[k]) ^ 2 + (gy - y[k]) ^ 2)
      if (d > least + 1e-6 || d - $5 > 1e-6 || $5 - d > 1e-6) { print "not nearest: " $0 ", least " least; exit }
    }
    END { if (FNR != 225) print FNR " texels" }' guide.txt table.txt >wrong.txt
  expect wrong "$(cat wrong.txt)" ''
}

@test "of equally near pixels the first in reading order is taken" {
  # Two colours only, each in many pixels.
  oiiotool --create 8x8 3 --fill:color=0.2,0.5,0.9 8x4 --fill:color=0.9,0.5,0.8 8x4+0+4 -d uint8 -o two.png
  local engine
  for engine in brute $(exact_engines); do
    accept lut two.png -s 8 -e $engine -o t.exr
    expect "sources by $engine" "$(dump t.exr u,v | cut -d' ' -f3- | sort -u | tr '\n' ',')" '0.062500000 0.062500000,0.062500000 0.562500000,'
  done
}

@test "the analytic engine takes spheres that fill the picture, and nothing else" {
  bring creature.exr sphere.exr sphere8.png sphere16.png
  swap 3 sphere.exr creature.exr lut sphere.exr -s 16 -e analytic --no-history -o out.exr
  oiiotool sphere.exr --cut 39x40 -o cut.exr
  swap 3 sphere.exr cut.exr lut sphere.exr -s 16 -e analytic --no-history -o out.exr
  oiiotool sphere.exr --ch A,depth.Z,normal.X,normal.Y=0.5,normal.Z -o odd.exr
  swap 3 sphere.exr odd.exr lut sphere.exr -q -s 16 -e analytic --no-history -o out.exr
  wait
  # Rounded to bytes or words it is a sphere still.
  local file
  for file in sphere8.png sphere16.png; do
    accept lut $file -s 48 -e analytic --no-history -o analytic.exr
    accept lut $file -s 48 -e brute --no-history -o brute.exr
    expect_same analytic.exr brute.exr
  done
}

@test "encodings hold the same table" {
  bring sphere.exr
  local encoding
  accept lut sphere.exr -s 20 -o f32.exr
  for encoding in rg16 rg8x2 rg8; do accept lut sphere.exr -s 20 --encoding $encoding -o $encoding.png; done
  accept lut sphere.exr -s 20 -o default.png
  expect 'default PNG' "$(dump default.png R,G 65535)" "$(dump rg16.png R,G 65535)"
  dump f32.exr u,v | awk '{ printf "%d %d %d %d\n", $1, $2, $3 * 65535 + 0.5, $4 * 65535 + 0.5 }' >f32.txt
  expect rg16 "$(dump rg16.png R,G 65535)" "$(cat f32.txt)"
  expect rg8x2 "$(dump rg8x2.png R,G,B,A 255 | awk '{ print $1, $2, $3 * 256 + $4, $5 * 256 + $6 }')" "$(cat f32.txt)"
  expect rg8 "$(dump rg8.png R,G 255)" "$(dump f32.exr u,v | awk '{ printf "%d %d %d %d\n", $1, $2, $3 * 255 + 0.5, $4 * 255 + 0.5 }')"
  # All of them read back as the same table: a source of 40 pixels fits a byte.
  accept check f32.exr --guide sphere.exr
  audit=$output
  for encoding in rg16 rg8x2 rg8; do beside same_audit $encoding; done
  wait
}
same_audit() {
  accept check "$1.png" --guide sphere.exr
  expect "audit of $1" "$output" "$audit"
}

@test "a table says what it is" {
  bring sphere.exr
  accept lut sphere.exr -s 9 --sampling unorm8 -o t.exr
  accept info t.exr --format json
  expect attributes "$(json - '["kind", "encoding", "source", "sampling", "metric", "map"].map(k => r.attributes["stylut:" + k]).join()' <<<"$output")" \
    lut,f32,40x40,unorm8,xy,xy
  expect hash "$(json - 'r.attributes["stylut:input1"]' <<<"$output")" "$(sha256sum sphere.exr | cut -d' ' -f1)"
  accept lut sphere.exr -s 9 --no-history -o t.exr
  accept info t.exr --format json
  expect attributes "$(json - 'Object.keys(r.attributes).sort().join()' <<<"$output")" \
    stylut:encoding,stylut:kind,stylut:map,stylut:metric,stylut:sampling,stylut:source
}

@test "lut's report as JSON" {
  bring creature8.png sphere.exr
  accept lut creature8.png -s 20 -e brute -o t.exr --format json
  expect facts "$(json - '[r.schema, r.engine, r.size, r.sampling, r.encoding].join()' <<<"$output")" stylut-lut/1,brute,20,centre,f32
  expect points "$(json - r.points <<<"$output")" "$(dump creature8.png A | awk '$3 == 1' | wc -l)"
  expect unique "$(json - r.unique <<<"$output")" "$(dump creature8.png R,G,A 255 | awk '$5 > 0 { print $3, $4 }' | sort -u | wc -l)"
  expect times "$(json - 'Object.keys(r.time_ms).sort().join()' <<<"$output")" build,read,write
  expect numbers "$(json - 'Object.values(r.time_ms).every(t => t >= 0) && r.peak_bytes > 1e6 && r.mean_distance <= r.max_distance' <<<"$output")" true
  accept lut sphere.exr -s 20 -o t.exr --format json
  expect_match 'engine of auto' "$(json - r.engine <<<"$output")" '^(analytic|flann-single|cgal|grid)$'
}

@test "--dry-run writes nothing" {
  bring sphere.exr
  accept lut sphere.exr -o t.exr --dry-run
  expect_holds report "$output" 'would write t.exr'
  [ ! -e t.exr ] || complain "t.exr was written"
  # What can't be built can't be promised.
  refuse 1 unorm8 lut sphere.exr --sampling unorm8 --map equal-area -o t.exr --dry-run
  refuse 1 '2 to' lut sphere.exr -s 1 --sampling unorm8 -o t.exr --dry-run
  refuse 1 '3 dimensions' lut sphere.exr --channels normal -s 8 -e grid -o t.exr --dry-run
}

@test "every encoding names every pixel of what it has numbers for" {
  local side
  for side in 255 256; do
    accept guide sphere -s $side -o full.exr
    accept lut full.exr -s 64 --encoding rg8 -o t.png
    accept check t.png --guide full.exr --format json
    expect "optimal, $side pixels" "$(json - r.optimal <<<"$output")" 1
  done
  accept guide sphere -s 257 -o full.exr
  accept_warned rg8 lut full.exr -s 64 --encoding rg8 -o t.png
}

@test "check: text and JSON agree, and figures are plausible" {
  bring sphere.exr
  accept lut sphere.exr -s 64 -o t.exr
  accept check t.exr --guide sphere.exr
  local text=$output
  expect_match text "$text" '^assignment +mean [0-9.]+  p50 [0-9.]+  p95 [0-9.]+  p99 [0-9.]+  max [0-9.]+ degrees'
  expect_holds text "$text" 'lookup'
  expect_holds text "$text" 'coverage'
  accept check t.exr --guide sphere.exr --format json
  expect facts "$(json - '[r.schema, r.size, r.sampling, r.background].join()' <<<"$output")" stylut-audit/1,64,centre,0
  expect_holds 'mean of both' "$text" "lookup      mean $(json - 'r.lookup.mean.toFixed(3)' <<<"$output") "
  expect ordered "$(json - '["assignment", "lookup"].every(k => (f => 0 <= f.mean && f.p50 <= f.p95 && f.p95 <= f.p99 && f.p99 <= f.max && f.max < 180)(r[k]))' <<<"$output")" true
  expect feasible "$(json - r.feasible <<<"$output")" "$(awk 'BEGIN { for (j = 0; j < 64; j++) for (i = 0; i < 64; i++) {
    x = (i + 0.5) / 32 - 1; y = (j + 0.5) / 32 - 1; n += x * x + y * y <= 1 } print n }')"
  expect coverage "$(json - 'r.coverage > 0.99 && r.coverage <= 1' <<<"$output")" true
  # A larger table of the same guide errs less; a byte table of a float guide errs nowhere in between.
  local mean
  mean=$(json - r.lookup.mean <<<"$output")
  accept lut sphere.exr -s 256 -o t.exr
  accept check t.exr --guide sphere.exr --format json
  expect_less 'mean of the larger table' "$(json - r.lookup.mean <<<"$output")" "$mean"
  accept lut sphere.exr -s 256 --sampling unorm8 -o t.exr
  accept check t.exr --guide sphere.exr --format json
  expect 'unorm8: lookup is assignment' "$(json - 'JSON.stringify(r.lookup) === JSON.stringify(r.assignment)' <<<"$output")" true
}

# A budget that is just met and one that is just missed.
@test "check: budgets met and exceeded, a line each" {
  bring sphere.exr
  local report status said
  accept lut sphere.exr -s 32 -o t.exr
  accept check t.exr --guide sphere.exr --format json
  report=$output
  budgets() { # FACTOR
    json - "'--max-mean ' + r.lookup.mean * $1 + ' --max-p99 ' + r.lookup.p99 * $1 + ' --max-error ' + r.lookup.max * $1 + ' --min-coverage ' + Math.max(0, r.coverage / $1 - 1e-6)" <<<"$report"
  }
  # shellcheck disable=SC2046
  accept check t.exr --guide sphere.exr $(budgets 1.001)
  local option count=0
  status=0
  # shellcheck disable=SC2046
  said=$("$STYLUT" check t.exr --guide sphere.exr $(budgets 0.999 | sed 's/--min-coverage.*/--min-coverage 1/') 2>&1 >/dev/null) || status=$?
  expect 'exit of a failed check' $status 6
  for option in --max-mean --max-p99 --max-error; do
    expect "lines about $option" "$(grep -c "^stylut: error: t.exr: $option: found .*, expected at most " <<<"$said")" 1
  done
  expect 'lines in all' "$(grep -c . <<<"$said")" $((3 + $(json - 'r.coverage < 1 ? 1 : 0' <<<"$report")))
  for option in '--max-mean 0' '--max-p99 0' '--max-error 0'; do
    status=0
    # shellcheck disable=SC2086
    said=$("$STYLUT" check t.exr --guide sphere.exr $option 2>&1 >/dev/null) || status=$?
    expect "exit of $option" $status 6
    expect "lines of $option" "$(wc -l <<<"$said")" 1
    count=$((count + 1))
  done
  expect checked $count 3
  # Coverage: half a sphere covers half of the domain.
  oiiotool sphere.exr --fill:color=0,0,0,0,0 20x40 -o half.exr
  accept lut half.exr -s 32 -o h.exr
  accept check h.exr --guide half.exr --format json
  expect_near 'coverage of half a sphere' "$(json - r.coverage <<<"$output")" 0.5 0.05
  status=0
  said=$("$STYLUT" check h.exr --guide half.exr --min-coverage 0.9 2>&1 >/dev/null) || status=$?
  expect 'exit of --min-coverage' $status 6
  expect_match 'line of --min-coverage' "$said" '^stylut: error: h.exr: --min-coverage: found 0\.[0-9]+, expected at least 0.9$'
}

@test "check finds a table that is wrong" {
  bring sphere.exr
  accept lut sphere.exr -s 32 -o t.png
  accept check t.png --guide sphere.exr --max-mean 4
  # Turned by half: every normal is answered by its opposite.
  oiiotool t.png --rotate180 -o turned.png
  local status=0
  "$STYLUT" check turned.png --guide sphere.exr --max-mean 4 >/dev/null 2>&1 || status=$?
  expect 'exit' $status 6
  # Pointing at the background.
  oiiotool t.png --fill:color=0,0,0 8x8+12+12 -o hole.png
  accept check hole.png --guide sphere.exr --format json
  expect 'texels on the background' "$(json - r.background <<<"$output")" 64
}
