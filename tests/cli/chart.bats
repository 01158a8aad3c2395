#!/usr/bin/env bats
# stylut chart: the figures, the fronts, and the picture.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 40 -q -o sphere.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 60x50 -c normal -q -o creature.exr
}

# Without what varies: times, and with them the first front.
without_times() { grep -v '^#' "$1" | cut -d, -f 1-8,11-13,15; }

header=guide,engine,parameters,metric,map,size,encoding,bytes,time_ms,runs,lookup_mean,lookup_p99,lookup_max,pareto_time,pareto_bytes

# expect_fronts FILE.csv: the flags are what the figures say.
expect_fronts() {
  grep -v -e '^#' -e '^guide,' "$1" >rows.csv
  expect "wrong flags of $1" "$(awk -F, '
    { for (c = 1; c <= 2; c++) { flag[NR, c] = $(13 + c); cost[NR, c] = c == 1 ? $9 : $8 } error[NR] = $12 }
    END {
      for (c = 1; c <= 2; c++)
        for (i = 1; i <= NR; i++) {
          if (flag[i, c] == "") continue
          front = 1
          for (k = 1; k <= NR; k++)
            if (flag[k, c] != "" && cost[k, c] <= cost[i, c] && error[k] <= error[i] && (cost[k, c] < cost[i, c] || error[k] < error[i])) front = 0
          if (flag[i, c] != front) print "row " i " chart " c ": " flag[i, c] ", not " front
          some[c] += front
        }
      if (!some[1] || !some[2]) print "an empty front"
    }' rows.csv)" ''
}

@test "the table: columns, rows, fronts" {
  bring 'sphere.exr'
  accept chart sphere.exr -s 16,8 -e grid,flann-single,flann-forest,analytic --repeats 3 --csv c.csv
  expect_match said "$output" 'time   .*bytes  equal-area, angle, '
  expect_match 'first line' "$(sed -n 1p c.csv)" '^# .+, [0-9]+ cores?; stylut [0-9.]+; OpenImageIO [0-9.]+, '
  expect 'second line' "$(sed -n 2p c.csv)" "# stylut chart --sizes=16,8 --engines=grid,flann-single,flann-forest,analytic --repeats=3 --csv=c.csv sphere.exr; version $("$STYLUT" --version | sed -n "1s/.* //p"); guide of SHA-256 $(sha256sum <sphere.exr | cut -c 1-64)"
  expect header "$(sed -n 3p c.csv)" "$header"
  # Two sizes of: two maps, two metrics, four encodings by grid; the other engines, the forest of three kinds.
  expect rows "$(sed 1,3d c.csv | wc -l)" $((2 * (2 * 2 * 4 + 2 + 3)))
  expect 'fields' "$(sed 1,3d c.csv | awk -F, '{ print NF }' | sort -u)" 15
  expect 'on either chart' "$(sed 1,3d c.csv | awk -F, '$14 != "" { t++ } $15 != "" { b++ } END { print t, b }')" '12 32'
  expect 'bytes' "$(sed 1,3d c.csv | awk -F, '{ print $7, $8 / $6 / $6 }' | sort -u | tr '\n' ,)" 'f32 8,rg16 4,rg8 2,rg8x2 4,'
  expect_fronts c.csv
  # The exact engines agree with each other and with the audit.
  accept lut sphere.exr -s 16 --map equal-area --metric angle --encoding rg8 -o t.png
  accept check t.png --guide sphere.exr --format json
  expect 'error by check' "$(sed -n 's/^"sphere.exr",grid,,angle,equal-area,16,rg8,[^,]*,[^,]*,3,\([^,]*,[^,]*,[^,]*\),.*/\1/p' c.csv)" \
    "$(json - '[r.lookup.mean, r.lookup.p99, r.lookup.max].map(v => v.toFixed(6)).join()' <<<"$output")"
  expect 'errors of exact engines' "$(grep -E '^"sphere.exr",(grid|flann-single),,xy,xy,16,f32' c.csv | cut -d, -f 11-13 | sort -u | wc -l)" 1
}

@test "the same but for the times, on any number of threads, by frames" {
  bring '*.exr'
  local right=(chart creature.exr -s 8,16 -e grid,cgal,brute --repeats 1 --no-history -q)
  accept "${right[@]}" --csv a.csv
  accept "${right[@]}" --csv b.csv -j 2
  accept "${right[@]}" --csv f.csv --frames sphere.exr creature.exr
  for file in a b f; do
    expect_fronts $file.csv
    without_times $file.csv >$file.txt
    expect 'comments without a history' "$(grep -c '^#' $file.csv)" 1
  done
  expect_same a.txt b.txt
  expect_other a.txt f.txt
  accept lut creature.exr -s 16 -o t.exr
  accept check t.exr --guide creature.exr --frames sphere.exr creature.exr --format json
  expect 'error by frames' "$(sed -n 's/^"creature.exr",grid,,xy,xy,16,f32,.*,\([0-9.]*\),[0-9.]*,[01],[01]$/\1/p' f.csv)" "$(json - 'r.lookup.p99.toFixed(6)' <<<"$output")"
}

@test "JSON, and what is left out" {
  bring creature.exr
  accept chart creature.exr -s 8 --repeats 1 --csv c.csv --format json -j 1
  local rows
  rows=$(sed 1,3d c.csv | wc -l)
  expect facts "$(json - '[r.schema, r.guide, r.threads, r.weights, r.points.length].join()' <<<"$output")" "stylut-chart/1,creature.exr,1,disc,$rows"
  expect 'first point' "$(json - '(p => [`"${r.guide}"`, p.engine, p.parameters, p.metric, p.map, p.size, p.encoding, p.bytes, p.time_ms.toFixed(3), p.runs, p.lookup.mean.toFixed(6), p.lookup.p99.toFixed(6), p.lookup.max.toFixed(6), p.pareto.time === null ? "" : +p.pareto.time, p.pareto.bytes === null ? "" : +p.pareto.bytes].join())(r.points[0])' <<<"$output")" "$(sed -n 4p c.csv)"
  expect_holds 'left out' "$(json - 'r.left_out.map(o => o.engine).join()' <<<"$output")" analytic
  expect 'reasons' "$(json - 'r.left_out.every(o => o.size === 8 && o.reason.length > 20)' <<<"$output")" true
  accept chart creature.exr -s 8 -e grid,analytic --repeats 1 --csv c.csv
  expect_holds said "$output" 'left out: analytic from size 8 on: '
  refuse 3 analytic chart creature.exr -s 8 -e analytic --csv out.csv
}

need_gnuplot() { command -v gnuplot >/dev/null || skip 'no gnuplot: nothing is drawn here'; }

@test "the pictures" {
  need_gnuplot
  bring sphere.exr
  accept chart sphere.exr -s 8,16 --repeats 1 -o c.svg --csv c.csv
  expect_match 'first line' "$(head -n 1 c.svg)" '^<\?xml '
  expect_match 'last line' "$(tail -n 1 c.svg)" "^<[?]stylut stylut chart .* sphere.exr; version [0-9.]+; guide of SHA-256 $(sha256sum <sphere.exr | cut -c 1-64)[?]>\$"
  if command -v xmllint >/dev/null; then xmllint --noout c.svg || complain 'c.svg is not well-formed'; fi
  local name
  for name in $(sed 1,3d c.csv | cut -d, -f 2 | sort -u) 'trees=1 checks=8' 'trees=8 checks=128' 'map xy, metric xy' 'map xy, metric angle' \
    'map equal-area, metric xy' 'map equal-area, metric angle' 'f32' 'rg16, rg8x2' 'rg8' 'Pareto front' 'sphere.exr: 40 x 40 pixels, float'; do
    grep -qE "<text>([^<]* )?$name[ ;<]" c.svg || complain "c.svg doesn't name '$name'"
  done
  expect_less 'bytes of c.svg' "$(stat -c %s c.svg)" 300000
  accept chart sphere.exr -s 8 -e grid --repeats 1 -o c.PNG
  expect size "$(oiiotool --info c.PNG | grep -oE '[0-9]+ x +[0-9]+')" '1160 x  600'
  expect_match 'what the PNG says' "$("$STYLUT" info c.PNG)" 'stylut:command = stylut chart .* sphere.exr; version [0-9.]+; guide of SHA-256 [0-9a-f]{64}'
  accept chart sphere.exr -s 8 -e grid --repeats 1 --no-history -o silent.png
  expect 'attributes of a PNG without history' "$("$STYLUT" info silent.png | grep -c stylut:)" 0
  # One table, and one whose errors are all 0: axes need a width.
  accept guide sphere -s 8 -o eight.exr
  accept chart eight.exr --frames eight.exr -s 8 -e grid --repeats 1 -o c.svg --csv c.csv
  expect_match 'errors of 0' "$(sed 1,3d c.csv | cut -d, -f 12)" '^0\.000000'
}

@test "names do no harm" {
  need_gnuplot
  local name=$'it\'s "a`touch one`$(touch two)<b>&amp;,\n@x{_^}\\n%s\xff\'.exr'
  cp "$BATS_FILE_TMPDIR/sphere.exr" "$name"
  accept chart "$name" -s 4 -e grid --repeats 1 -o c.svg --csv c.csv
  if command -v xmllint >/dev/null; then
    expect title "$(xmllint --xpath '//*[local-name()="text"]/text()' c.svg | grep -F pixels)" \
      "it's \"a\`touch one\`\$(touch two)&lt;b&gt;&amp;amp;,?@x{_^}\\n%s?'.exr: 40 x 40 pixels, float; numbers are texels a side"
  fi
  expect_holds 'field' "$(sed -n 4p c.csv)" "\"it's \"\"a\`touch one\`\$(touch two)<b>&amp;,?@x{_^}\\n%s?'.exr\",grid,"
  expect files "$(find . -type f -printf .)" ...
}

@test "without gnuplot" {
  bring sphere.exr
  mkdir bin
  local real=$STYLUT STYLUT=$PWD/stylut
  # shellcheck disable=SC2016
  printf '#!/bin/sh\nPATH=%q exec %q "$@"\n' "$PWD/bin" "$real" >stylut
  chmod +x stylut
  local right=(chart sphere.exr -s 4 -e grid --repeats 1)
  # Refused before anything is read or measured.
  refuse 5 gnuplot chart missing.exr -o out.svg
  refuse 5 gnuplot "${right[@]}" -o out.svg --csv out.csv
  accept "${right[@]}" --csv c.csv
  # One that fails, one that says nothing, one that dies.
  printf '#!/bin/sh\n[ "$1" != --version ] || exit 0\necho; echo "   no such colour" >&2; exit 3\n' >bin/gnuplot
  chmod +x bin/gnuplot
  refuse 4 'status 3 and: no such colour' "${right[@]}" -o out.svg --csv out.csv
  printf '#!/bin/sh\nexit 0\n' >bin/gnuplot
  refuse 4 gnuplot "${right[@]}" -o out.svg
  # shellcheck disable=SC2016
  printf '#!/bin/sh\n[ "$1" = --version ] || kill -9 $$\n' >bin/gnuplot
  refuse 4 gnuplot "${right[@]}" -o out.svg
  printf '#!/bin/sh\nexit 1\n' >bin/gnuplot
  refuse 5 'gnuplot --version' "${right[@]}" -o out.svg
}

@test "wrong calls" {
  bring 'sphere.exr'
  local right=(chart sphere.exr -s 4,8 -e grid --repeats 1 --csv out.csv)
  swap 1 4,8 0 "${right[@]}"
  swap 1 4,8 8193 "${right[@]}"
  swap 1 grid gird "${right[@]}"
  swap 1 out.csv out.txt "${right[@]}"
  swap 2 out.csv no/such/out.csv "${right[@]}"
  swap 2 sphere.exr missing.exr "${right[@]}"
  wait
  refuse 1 "'x'" chart sphere.exr -s 4,x --csv out.csv
  refuse 1 '--sizes' chart sphere.exr -s 4,,8 --csv out.csv
  refuse 1 '4 twice' chart sphere.exr -s 4,8,4 --csv out.csv
  refuse 1 'more than 16' chart sphere.exr -s "$(seq -s, 1 17)" --csv out.csv
  refuse 1 'grid twice' chart sphere.exr -e grid,auto --csv out.csv
  refuse 1 '--engines' chart sphere.exr -e grid, --csv out.csv
  refuse 1 '--repeats' chart sphere.exr --repeats 0 --csv out.csv
  refuse 1 '--csv' chart sphere.exr
  refuse 1 'guide' chart --csv out.csv
  refuse 1 out.jpg chart sphere.exr -o out.jpg
  refuse 1 other chart sphere.exr other --csv out.csv
  refuse 2 missing chart sphere.exr -s 4 -e grid --csv out.csv --frames missing.exr
  cp sphere.exr guide.csv
  refuse 1 ./guide.csv chart guide.csv --csv ./guide.csv
  refuse 1 ./guide.csv chart sphere.exr --frames guide.csv --csv ./guide.csv
  oiiotool sphere.exr --mulc 0 -o empty.exr
  refuse 3 frames chart sphere.exr -s 4 -e grid --csv out.csv --frames empty.exr
  refuse 3 frames lut sphere.exr -s auto --max-p99 5 -o out.exr --frames empty.exr
  accept "${right[@]}" --dry-run
  expect said "$output" 'would write out.csv: engines: 1, sizes: 2; from 1264 source pixels'
  [ ! -e out.csv ] || complain 'out.csv was written'
}

@test "a full disk leaves nothing behind" {
  bring 'sphere.exr'
  small_disk 4k
  refuse 2 disk/out.csv chart sphere.exr -s 4,8,16 -e grid --repeats 1 --csv disk/out.csv
}
