#!/usr/bin/env bats
# stylut bench: its rows, beside the committed ones.
load helpers

header=row,variant,runs,median_ms,rate,rate_unit,ratio,reference

# expect_ratios FILE.csv: each is what the times say.
expect_ratios() {
  expect "wrong ratios of $1" "$(awk -F, '
    NR > 2 { n++; row[n] = $1; variant[n] = $2; time[n] = $4; ratio[n] = $7; reference[n] = $8 }
    END {
      for (i = 1; i <= n; i++) {
        if ((ratio[i] == "") != (reference[i] == "")) print row[i] ", " variant[i] ": half a reference"
        if (ratio[i] == "") continue
        found = 0
        for (k = 1; k <= n; k++) {
          same = row[k] == row[i] && variant[k] == reference[i]
          if (reference[i] == "1 thread") {
            one = row[i] " " variant[i]
            sub("2 threads", "1 thread", one)
            same = row[k] " " variant[k] == one
          }
          if (!same) continue
          found++
          d = time[k] / time[i] - ratio[i]
          least = 0.01 * ratio[i] + 0.0005 # ratios have three decimals
          if (d > least || d < -least) print row[i] ", " variant[i] ": " ratio[i] ", not " time[k] / time[i]
        }
        if (found != 1) print row[i] ", " variant[i] ": " found " references"
      }
    }' "$1")" ''
}

@test "rows, ratios and the committed figures" {
  # What sanitizers make slow is measured without them.
  local parts=(guide pack)
  [ "$STYLUT_CONFIG" != release ] || parts=()
  mkdir scratch
  TMPDIR=$PWD/scratch accept bench "${parts[@]}" --repeats 1 --csv b.csv --format json
  expect 'left in the temporary folder' "$(ls scratch)" ''
  expect_match 'first line' "$(head -n 1 b.csv)" '^# .+, [0-9]+ cores?; stylut [0-9.]+; OpenImageIO '
  expect header "$(sed -n 2p b.csv)" "$header"
  expect fields "$(sed 1,2d b.csv | awk -F, '{ print NF }' | sort -u)" 8
  expect runs "$(sed 1,2d b.csv | cut -d, -f 3 | sort -u)" 1
  expect_ratios b.csv
  expect schema "$(json - r.schema <<<"$output")" stylut-bench/1
  expect 'rows in JSON' "$(json - 'r.rows.map(r => [r.row, r.variant, r.runs, r.time_ms.toFixed(3), r.rate.toFixed(3), r.rate_unit, r.ratio === null ? "" : r.ratio.toFixed(3), r.reference].join()).join("\n")' <<<"$output")" "$(sed 1,2d b.csv)"
  expect 'committed machine' "# $(json - r.committed_machine <<<"$output")" "$(head -n 1 "$exemplars/charts/bench.csv")"
  expect 'committed figures' "$(json - 'r.rows.map(r => [r.row, r.variant, r.committed ? r.committed.time_ms.toFixed(3) : "", r.committed && r.committed.ratio !== null ? r.committed.ratio.toFixed(3) : ""].join()).join("\n")' <<<"$output")" \
    "$(awk -F, 'NR == FNR { time[$1, $2] = $4; ratio[$1, $2] = $7; next } FNR > 2 { print $1 "," $2 "," time[$1, $2] "," ratio[$1, $2] }' "$exemplars/charts/bench.csv" b.csv)"
  # Machines of another number of cores have rows of their own.
  expect 'rows without a committed figure' \
    "$(json - 'r.rows.filter(r => !r.committed && !/ [0-9]+ threads/.test(r.row + " " + r.variant)).map(r => r.row + " " + r.variant).join()' <<<"$output")" ''
  [ "$STYLUT_CONFIG" = release ] || return 0
  # Every engine has a row; so have all parts.
  local name engines='brute analytic flann-single flann-forest flann-auto grid'
  ! "$STYLUT" --version | grep -q 'CGAL [0-9]' || engines+=' cgal'
  for name in $engines; do grep -q "^lut.*,$name," b.csv || complain "no row of $name"; done
  for name in 'lut 8-bit' 'guide torus 2 threads' pack 'stylize full' 'stylize coverage'; do grep -q "^$name" b.csv || complain "no row $name"; done
}

@test "as text" {
  accept bench pack --repeats 2
  expect_match said "$output" '^here       .*
committed  .*
row +variant .*
pack +parts: decode and one lut .*
pack +whole .* parts: decode and one lut
'
  accept bench pack --repeats 1 -q
  expect said "$output" ''
}

@test "wrong calls" {
  local right=(bench pack --repeats 1 --csv out.csv)
  swap 1 pack park "${right[@]}"
  swap 2 out.csv no/such/out.csv "${right[@]}"
  wait
  refuse 1 '--repeats' bench pack --repeats 0
  refuse 1 '--repeats' bench pack --repeats 100
  refuse 1 'lut, guide, pack, stylize' bench park
  TMPDIR=$PWD/missing refuse 2 TMPDIR bench pack --repeats 1
  TMPDIR=$PWD/missing refuse 2 TMPDIR bench pack --repeats 1
}
