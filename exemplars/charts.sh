#!/usr/bin/env bash
# What tables of our guides cost and are worth, drawn and as CSV; of other
# projects' guides too, where their folder is given. Usage: charts.sh STYLUT FOLDER [DATA]
set -euo pipefail
stylut=$(realpath "$1")
out=$(realpath "$2")
data=${3:+$(realpath "$3")}
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
# Files by their bare names, so that the tables name no place of this machine.
cd "$scratch"

"$stylut" guide sphere -s 512 -c normal -q -o sphere.exr
"$stylut" guide sphere -s 512 -q -o sphere8.png
"$stylut" guide scene "$here/creature.ply" --view three-quarter -s 512 -c normal -q -o creature.exr
for file in unity-plugin/s_normals.png frames/golem.001.png; do
  [ -z "$data" ] || [ ! -e "$data/$file" ] || ln -s "$data/$file" .
done
for guide in *.exr *.png; do
  name=${guide%.*}
  printf '%s\n' "$guide" >&2
  "$stylut" chart "$guide" -o "$name.svg" --csv "$name.csv" -q
  sed -i "s/ *$//" "$name.svg" # the house has no trailing blanks
  mv "$name.svg" "$name.csv" "$out/"
done
"$here/stylize_chart.sh" "$out/bench.csv" "$out/stylize.svg"
