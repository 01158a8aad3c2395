#!/usr/bin/env bash
# What stylize --anchor does for things that move, with exact and with coherent tables: how far pictures are from the
# one before along the motion, and how many source pixels jump. CSV and a chart.
# Usage: motion.sh STYLUT WORK FOLDER
#
# Each figure is its own exemplar: its guide from one side, wearing a painted sphere. It moves in front of a camera that
# stands still, twelve frames at a time.
set -euo pipefail
stylut=$(realpath "$1")
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$2" "$3"
work=$(realpath "$2")
out=$(realpath "$3")
cd "$work"
side=640 frames=12
export LC_ALL=C # a point, whatever the language

# write_scene MESH SCALE ANGLE X: a figure turned so many degrees, X pixels to the right. Two balls outside the picture
# keep the scene's bounds.
write_scene() {
  awk -v mesh="$1" -v by="$2" -v angle="$3" -v x="$4" -v side=$side 'BEGIN {
    c = by * cos(angle * atan2(0, -1) / 180); s = by * sin(angle * atan2(0, -1) / 180)
    printf "{ \"schema\": \"stylut-scene/1\","
    printf "  \"camera\": { \"type\": \"orthographic\", \"position\": [0,0,8], \"target\": [0,0,0], \"height\": 2.5 },"
    printf "  \"objects\": [ { \"mesh\": \"%s\",", mesh
    printf "    \"transform\": [%.9f,0,%.9f,%.9f, 0,%g,0,0, %.9f,0,%.9f,0, 0,0,0,1] } ],", c, s, x * 2.5 / side, by, -s, c
    printf "  \"spheres\": [ { \"center\": [-3.5,0,0], \"radius\": 0.5 }, { \"center\": [3.5,0,0], \"radius\": 0.5 } ] }\n" }'
}

# prepare NAME MESH SCALE STYLE: the exemplar, and NAME/TABLE.bundle of both tables.
prepare() {
  local name=$1 table options
  mkdir -p "$name"
  write_scene "$2" "$3" 30 0 >"$name/source.json"
  "$stylut" guide scene "$name/source.json" -s $side -c normal -q -o "$name/source.png"
  "$stylut" stylize spheres.bundle --style "$4" --guide "$name/source.png" -q -o "$name/exemplar.png"
  for table in nearest coherent; do
    options=()
    [ $table = nearest ] || options=(--slack 2)
    "$stylut" lut "$name/source.png" -s 256 --resolve $table "${options[@]}" -q -o "$name/$table.exr"
    printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "%s", "exemplar": "exemplar.png", "guide": "source.png",
      "lut": { "file": "%s.exr" } } ] }\n' "$4" $table >"$name/$table.json"
    "$stylut" pack "$name/$table.json" -q -o "$name/$table.bundle"
  done
}

# render NAME MESH SCALE MOVE: NAME/MOVE.K.exr
render() {
  local k angle x previous
  for ((k = 0; k < frames; k++)); do
    case $4 in
      whole) angle=0 x=$((5 * k - 30)) ;;
      slow) angle=0 x=$(awk "BEGIN { print 0.3 * $k }") ;;
      fast) angle=0 x=$(awk "BEGIN { print 4.7 * $k - 26 }") ;;
      turn) angle=$k x=0 ;;
    esac
    write_scene "$2" "$3" "$angle" "$x" >"$1/$4.$k.json"
    previous=$1/$4.$((k > 0 ? k - 1 : 0)).json
    "$stylut" guide scene "$1/$4.$k.json" --previous "$previous" -s $side -c normal,depth,object,motion -q -o "$1/$4.$k.exr"
  done
}

# number KEY FILE: of what --measure wrote for all frames.
number() { sed -n '/^  "overall"/,$ s/^ *"'"$1"'": \([-+.e0-9]*\).*/\1/p' "$2"; }

# wear NAME MOVE ANCHOR TABLE: stylizes the frames; prints warping error, jumps and the size of pieces.
wear() {
  local made=$1/$2.$3.$4
  "$stylut" stylize "$1/$4.bundle" --guide "$1/$2.%d.exr" --anchor "$3" --measure "$made.json" -q -o "$made.%d.png"
  printf '%s,%s,%s\n' "$(number warp_mean "$made.json")" "$(number jumps "$made.json")" "$(number chunk_weighted "$made.json")"
}

# study NAME MESH SCALE STYLE
study() {
  local move anchor table
  prepare "$@"
  for move in whole fast slow turn; do
    printf '%s, %s\n' "$1" $move >&2
    render "$1" "$2" "$3" $move
    for anchor in screen object; do
      for table in nearest coherent; do
        printf '%s,%s,%s,%s,%s\n' "$1" $move $anchor $table "$(wear "$1" $move $anchor $table)" >>motion.csv
      done
    done
  done
}

awk -v shape=torus -f "$here/shapes.awk" >torus.obj
"$stylut" pack "$here/styles.json" -q -o spheres.bundle
echo 'figure,move,anchor,table,warp_mean,jumps,chunk_weighted' >motion.csv
study creature "$here/creature.ply" 1 pencil
study torus "$work/torus.obj" 0.5 oil

gnuplot <<'END'
set terminal svg size 1080,420 font "DejaVu Sans,11" background "white"
set output "motion.svg"
set datafile separator ","
set datafile missing NaN
set multiplot layout 1,2
set style data histograms
set style fill solid border lc rgb "white"
set boxwidth 0.9
set grid ytics lc rgb "#dddddd"
set xrange [-0.6:7.6]
set xtics ("5 px\ncreature" 0, "4.7 px" 1, "0.3 px" 2, "1° turn" 3, "5 px\ntorus" 4, "4.7 px" 5, "0.3 px" 6, "1° turn" 7) scale 0
set key top center horizontal maxcols 2 reverse Left width 2
set bmargin 4
anchors = "screen object screen object"
tables = "nearest nearest coherent coherent"
colours = "#fdba74 #93c5fd #c2410c #1d4ed8"
row(i) = sprintf("< grep ,%s,%s, motion.csv", word(anchors, i), word(tables, i))
set yrange [0:0.115]
set title "Warping error, share of white"
plot for [i=1:4] row(i) using 5 lc rgb word(colours, i) title word(anchors, i).", ".word(tables, i)
set yrange [0:100]
set title "Source pixels that jump, %"
plot for [i=1:4] row(i) using ($6 * 100) lc rgb word(colours, i) notitle
END
sed -i 's/ *$//' motion.svg # the house has no trailing blanks
cp motion.svg motion.csv "$out/"
column -s, -t motion.csv
