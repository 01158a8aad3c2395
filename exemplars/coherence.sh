#!/usr/bin/env bash
# What the four choices of `lut --resolve` give on turning figures: how calm the
# tables are, how calm a style lies on frames, and what it costs. A table on
# stdout, the same as FOLDER/coherence.csv. With STYLUT_DATA the golem's frames,
# too. Usage: coherence.sh STYLUT FOLDER
#
# Each figure is its own exemplar: its guide from one side, wearing a painted
# sphere. Of eight frames of a slow turn, seen from elsewhere, some are given to
# --resolve frames and both; only the others are measured, in pairs of neighbours.
set -euo pipefail

stylut=$1
out=$2
here=$(cd "$(dirname "$0")" && pwd)
pieces=$(dirname "$stylut")/tests/bench/pieces
side=1024 runs=5
from=30,15  # where exemplars are seen from: azimuth, elevation
elevation=5 # of the frames
frames=(1 2 3 4 5 6 7 8) given=(1 2 5 6) measured=(3 4 7 8)
choices=(nearest coherent frames both)

mkdir -p "$out"
out=$(cd "$out" && pwd)
csv=$out/coherence.csv

say() { printf '%s\n' "$*" >&2; }

# number KEY: of the JSON on stdin.
number() { sed -n "s/^ *\"$1\": \([-+.e0-9]*\).*/\1/p"; }

median() { sort -g | awk '{ value[NR] = $1 } END { print value[int((NR + 1) / 2)] }'; }

# look NAME MESH FILE VIEW: an 8-bit guide, NAME/FILE.png.
look() { "$stylut" guide scene "$2" --view "$4" -s $side -c normal -o "$out/$1/$3.png" -q; }

# turn NAME MESH AZIMUTH STEP FRAME...: NAME/frame.*.png, so many degrees apart.
turn() {
  local name=$1 mesh=$2 azimuth=$3 step=$4 k
  shift 4
  for k in "$@"; do
    look "$name" "$mesh" "frame.$k" "$azimuth,$elevation"
    azimuth=$(awk "BEGIN { print $azimuth + $step }")
  done
}

# render NAME MESH: NAME/guide.png and the frames.
render() {
  say "$1: guide and ${#frames[@]} frames"
  mkdir -p "$out/$1"
  look "$1" "$2" guide $from
  turn "$1" "$2" -8 1.75 "${frames[@]}"
}

# borrow NAME GUIDE FRAME...: the same from files of STYLUT_DATA.
borrow() {
  local name=$1 k=1 frame
  mkdir -p "$out/$name"
  ln -sf "$2" "$out/$name/guide.png"
  for frame in "${@:3}"; do ln -sf "$frame" "$out/$name/frame.$((k++)).png"; done
}

# build NAME CHOICE OUT OPTION...: the table of one choice.
build() {
  local folder=$out/$1 choice=$2 table=$3 k options=()
  shift 3
  [ "$choice" = nearest ] || options+=(--slack 2)
  if [ "$choice" = frames ] || [ "$choice" = both ]; then
    options+=(--frames)
    for k in "${given[@]}"; do options+=("$folder/frame.$k.png"); done
  fi
  "$stylut" lut "$folder/guide.png" -s 256 --resolve "$choice" "$@" -o "$table" "${options[@]}"
}

# paint NAME STYLE: NAME/exemplar.png, and NAME/CHOICE.bundle with it.
paint() {
  local folder=$out/$1 choice
  "$stylut" stylize "$out/spheres" --style "$2" --guide "$folder/guide.png" -o "$folder/exemplar.png" -q
  for choice in "${choices[@]}"; do
    build "$1" "$choice" "$folder/$choice.exr" -q
    printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "%s", "exemplar": "exemplar.png", "guide": "guide.png",
      "lut": { "file": "%s.exr" } } ] }\n' "$2" "$choice" >"$folder/$choice.json"
    "$stylut" pack "$folder/$choice.json" -o "$folder/$choice.bundle" -q
  done
}

# wear NAME CHOICE FRAME...: NAME/CHOICE.FRAME.png and its field.
wear() {
  local folder=$out/$1 choice=$2 k
  for k in "${@:3}"; do
    "$stylut" stylize "$folder/$choice.bundle" --guide "$folder/frame.$k.png" -o "$folder/$choice.$k.png" \
      --nnf "$folder/$choice.$k.nnf.png" -q
  done
}

# measure NAME CHOICE FRAME...: 'moved piece' over the frames, which are pairs.
measure() {
  local folder=$out/$1 choice=$2 k fields=()
  for k in "${@:3}"; do fields+=("$folder/$choice.$k.nnf.png"); done
  "$pieces" "${fields[@]}" | awk -F, 'NR > 1 { piece += $3; if (NR % 2) moved += $4 }
    END { printf "%.4f %.1f\n", moved / (NR - 1) * 2, piece / (NR - 1) }'
}

# time_builds NAME: median milliseconds of each choice and of FLANN's exact
# table, one thread, all in turn so that they meet the same weather.
time_builds() {
  local choice run folder=$out/$1
  rm -f "$folder"/*.times
  for ((run = 0; run < runs; run++)); do
    build "$1" nearest "$folder/timed.exr" -e flann-single -j 1 --format json | number build >>"$folder/flann.times"
    for choice in "${choices[@]}"; do
      build "$1" "$choice" "$folder/timed.exr" -j 1 --format json | number build >>"$folder/$choice.times"
    done
  done
}

# study NAME STYLE FRAME...: a line of CSV per choice; no frames, no figures of them.
study() {
  local name=$1 style=$2 choice moved='' piece='' nearest='' jumps time
  shift 2
  say "$name: tables, bundles, times"
  paint "$name" "$style"
  time_builds "$name"
  for choice in "${choices[@]}"; do
    say "$name, $choice: frames"
    if [ $# -gt 0 ]; then
      wear "$name" "$choice" "$@"
      read -r moved piece <<<"$(measure "$name" "$choice" "$@")"
      nearest=${nearest:-$piece}
    fi
    jumps=$("$stylut" check "$out/$name/$choice.exr" --guide "$out/$name/guide.png" --format json | number jumps)
    time=$(median <"$out/$name/$choice.times")
    awk -v f="$(median <"$out/$name/flann.times")" -v t="$time" -v p="$piece" -v n="$nearest" -v j="$jumps" -v m="$moved" \
      -v row="$name,$choice" 'BEGIN {
        printf "%s,%.3f,%s,%s,%s,%.0f,%.1f\n", row, j, m == "" ? "" : sprintf("%.3f", m), p == "" ? "" : sprintf("%.0f", p),
          p == "" ? "" : sprintf("%.2f", p / n), t, t / f }' >>"$csv.part"
  done
}

# study_slow NAME MESH: a quarter of a degree a frame, of which none was given;
# NAME/CHOICE.slow.*.png make an animation.
study_slow() {
  local name=$1 choice moved piece nearest=
  say "$name, slowly"
  turn "$name" "$2" -3 0.25 slow.{1,2,3,4,5,6,7,8}
  for choice in "${choices[@]}"; do
    wear "$name" "$choice" slow.{1,2,3,4,5,6,7,8}
    read -r moved piece <<<"$(measure "$name" "$choice" slow.{1,2,3,4,5,6,7,8})"
    nearest=${nearest:-$piece}
    awk -v p="$piece" -v n="$nearest" -v m="$moved" -v row="$name slowly,$choice" \
      'BEGIN { printf "%s,,%.3f,%.0f,%.2f,,\n", row, m, p, p / n }' >>"$csv.part"
  done
}

cpu=$(sed -n 's/^model name[[:blank:]]*: //p' /proc/cpuinfo | head -n 1)
{
  printf '# %s, %s cores; %s\n' "${cpu:-unknown processor}" "$(nproc)" "$("$stylut" --version | head -n 1)"
  printf 'figure,resolve,jumps,moved,piece,piece_ratio,build_ms,flann_ratio\n'
} >"$csv.part"

"$stylut" pack "$here/styles.json" -o "$out/spheres" -q
for shape in torus bust; do LC_ALL=C awk -v shape=$shape -f "$here/shapes.awk" >"$out/$shape.obj"; done
render creature "$here/creature.ply"
study creature pencil "${measured[@]}"
study_slow creature "$here/creature.ply"
render torus "$out/torus.obj"
study torus oil "${measured[@]}"
render bust "$out/bust.obj"
study bust watercolour "${measured[@]}"

data=${STYLUT_DATA:-}/frames
if [ -d "$data" ]; then
  data=$(cd "$data" && pwd)
  golem=("$data"/golem.00{1,2,3,4,5,6}.png)
  borrow golem.045 "$data/golem.045.png" "${golem[@]}"
  study golem.045 charcoal 3 4
  borrow golem.001 "$data/golem.001.png" "${golem[@]}"
  study golem.001 charcoal
else
  say "no golem: STYLUT_DATA names no folder that has frames/"
fi
mv "$csv.part" "$csv"

sed -n 's/^# //p' "$csv"
awk -F, 'NR > 1 {
  if ($2 == "nearest") print ""
  printf "%-15s %-9s %6s %6s %6s %12s %9s %12s\n", $1, $2, $3, $4, $5, $6, $7, $8
}' "$csv"
cat <<END

jumps: share of neighbouring texels on pixels far apart. moved: share of the covered pixels whose source pixel is more
than 64 pixels away from one frame to the next. piece: mean size, pixels, of the piece a pixel belongs to, and its ratio
to that of the nearest. build_ms: one thread, median of $runs; flann_ratio: over FLANN's for the exact table.
END
awk -F, '
  function expect(what, found, sign, aim) {
    if (found == "" || (sign == "<" ? found <= aim : found >= aim)) return
    printf "coherence: below aim: %s, %s: found %s of %s, expected at %s %s\n", $1, $2, found, what,
      sign == "<" ? "most" : "least", aim
  }
  $2 == "coherent" && $1 == "golem.001" { expect("jumps", $3, "<", 0.055) }
  $2 == "coherent" && $1 == "golem.045" { expect("jumps", $3, "<", 0.045); expect("moved", $4, "<", 0.07) }
  $2 == "coherent" && $1 !~ /slowly/ { expect("piece_ratio", $6, ">", 1) }
  $2 == "frames" && $1 !~ /slowly/ { expect("piece_ratio", $6, ">", 1.2) }
  NR > 2 && $2 != "nearest" { expect("flann_ratio", $8, "<", 10) }
' "$csv" >&2
