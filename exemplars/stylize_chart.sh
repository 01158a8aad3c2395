#!/usr/bin/env bash
# The time of a stylized frame of 1920 x 1080 against what it covers, its blend radius and its styles, from the
# benchmark's rows; published times beside them. Usage: stylize_chart.sh BENCH.csv OUT.svg
set -euo pipefail
csv=$(realpath "$1")
out=$(realpath "$2")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# $1: what comes before the number in a variant; $2: of which rows. Prints number and milliseconds.
list_times() {
  awk -F, -v row="stylize $2" -v what="frame: $1" '
    $1 == row && index($2, what) == 1 { split(substr($2, length(what) + 1), words, " "); print words[1], $4 }' "$csv"
}
full=$(awk -F, '$1 == "stylize full" && $2 == "frame" { print $4 }' "$csv")
{ list_times '' coverage; printf '100 %s\n' "$full"; } | sort -n >coverage.txt
list_times 'radius ' full | sort -n >radius.txt
{ printf '1 %s\n' "$full"; list_times '' styles; } | sort -n >styles.txt

gnuplot <<'END'
set terminal svg size 1080,380 font "DejaVu Sans,11" background "white"
set output "stylize.svg"
set multiplot layout 1,3
set grid lc rgb "#dddddd"
set ylabel "ms a frame, transfer and blend"
set style data linespoints
set logscale y
set yrange [1:2000]
set key top left reverse Left samplen 2
set title "Share of pixels covered, %"
plot "coverage.txt" pt 7 ps 0.6 lw 2 lc rgb "#c2410c" title "stylut, one thread", \
  173 with lines dt 2 lc rgb "#1d4ed8" title "demo, llvmpipe, 14 %: 173", \
  100 with lines dt 3 lc rgb "#888888" title "neural style, GPU: 100", \
  10.4 with lines dt 4 lc rgb "#15803d" title "Unity plugin, GPU: 10.4"
set title "Blend radius, all covered"
plot "radius.txt" pt 7 ps 0.6 lw 2 lc rgb "#c2410c" notitle
set logscale x 2
set title "Styles, all covered, squares of 60 pixels"
plot "styles.txt" pt 7 ps 0.6 lw 2 lc rgb "#c2410c" notitle
END
sed -i 's/ *$//' stylize.svg # the house has no trailing blanks
mv stylize.svg "$out"
