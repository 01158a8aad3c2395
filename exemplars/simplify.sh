#!/usr/bin/env bash
# What --simplify leaves of three models and what that changes of their guides, as
# CSV and drawn: error, silhouettes, time and memory against triangles.
# Usage: simplify.sh STYLUT FOLDER
set -euo pipefail
stylut=$(realpath "$1")
out=$(realpath "$2")
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
size=512

cp "$here/creature.ply" .
for shape in torus bust; do LC_ALL=C awk -v shape=$shape -f "$here/shapes.awk" >$shape.obj; done

# measure MODEL auto|COUNT: a line of the table; times are the least of three runs.
measure() {
  for _ in 1 2 3; do
    "$stylut" guide scene "$1" --view three-quarter -s $size -c normal --simplify "$2" -o guide.exr --format json |
      tr -d '\n'
    echo
  done >runs.txt
  node -e '
    const [model, kind] = process.argv.slice(1)
    const runs = require("fs").readFileSync("runs.txt", "utf8").trim().split("\n").map(line => JSON.parse(line).simplify)
    const r = runs[0], least = pick => Math.min(...runs.map(pick)).toFixed(2)
    const time = side => least(run => run[side].build_ms + run[side].trace_ms)
    const bytes = side => r[side].mesh_bytes + r[side].tree_bytes
    console.log([model, kind, r.simple.triangles, r.full.triangles, r.normal_deg.mean.toFixed(4), r.normal_deg.p99.toFixed(4),
      r.silhouette_px, time("simple"), time("full"), bytes("simple"), bytes("full"), least(run => run.search_ms)].join())' "${1%.*}" "$3"
}

cpu=$(sed -n 's/^model name[[:blank:]]*: //p' /proc/cpuinfo | head -n 1)
printf '# %s, %s cores; %s\n' "${cpu:-unknown processor}" "$(nproc)" "$("$stylut" --version | head -n 1)" >simplify.csv
echo 'model,chosen,triangles,full_triangles,mean_deg,p99_deg,silhouette_px,render_ms,full_render_ms,bytes,full_bytes,search_ms' >>simplify.csv
for model in creature.ply torus.obj bust.obj; do
  echo "$model" >&2
  all=$("$stylut" info "$model" --format json | node -p 'JSON.parse(require("fs").readFileSync(0)).survey.triangles')
  measure "$model" auto auto >>simplify.csv
  for divisor in 2 4 8 16 32 64; do measure "$model" $((all / divisor)) count >>simplify.csv; done
done

gnuplot <<'END'
set terminal svg size 1080,360 font "DejaVu Sans,11" background "white"
set output "simplify.svg"
set datafile separator ","
set multiplot layout 1,3
set logscale x
set xlabel "triangles"
set grid lc rgb "#dddddd"
set key bottom left reverse Left
models = "creature torus bust"
colour(i) = word("#c2410c #1d4ed8 #15803d", i)
of(model, kind, column) = strcol(1) eq model && strcol(2) eq kind ? column : NaN
set datafile missing NaN
set logscale y
set yrange [0.01:1000]
set title "Normals' change, 99th percentile, degrees"
plot for [i=1:3] "simplify.csv" using (of(word(models, i), "count", $3)):6 skip 2 with linespoints pt 7 ps 0.5 lc rgb colour(i) title word(models, i), \
  for [i=1:3] "simplify.csv" using (of(word(models, i), "auto", $3)):6 skip 2 with points pt 6 ps 1.4 lw 2 lc rgb colour(i) notitle, \
  1 with lines dt 2 lc rgb "#888888" title "--max-error 1; rings: auto"
unset logscale y
set key top right
set yrange [0:*]
set title "Silhouettes' move, pixels (at most 4 are told)"
plot for [i=1:3] "simplify.csv" using (of(word(models, i), "count", $3)):7 skip 2 with linespoints pt 7 ps 0.5 lc rgb colour(i) notitle, \
  for [i=1:3] "simplify.csv" using (of(word(models, i), "auto", $3)):7 skip 2 with points pt 6 ps 1.4 lw 2 lc rgb colour(i) notitle, \
  0.5 with lines dt 2 lc rgb "#888888" title "half a pixel"
set yrange [0:1.1]
set title "Time (solid), memory (dashed), full mesh = 1"
plot for [i=1:3] "simplify.csv" using (of(word(models, i), "count", $3)):($8 / $9) skip 2 with linespoints pt 7 ps 0.5 lc rgb colour(i) notitle, \
  for [i=1:3] "simplify.csv" using (of(word(models, i), "count", $3)):($10 / $11) skip 2 with lines dt 2 lw 2 lc rgb colour(i) notitle
END
sed -i 's/ *$//' simplify.svg # the house has no trailing blanks
mv simplify.svg simplify.csv "$out/"
