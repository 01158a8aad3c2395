#!/usr/bin/env bash
# Speed and memory, each figure beside a reference from the same run: a table on
# stdout, the same as BUILD/bench.csv. Usage: bench.sh BUILD
set -euo pipefail

build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
exemplars=$here/../../exemplars
csv=$build/bench.csv
scratch=$(mktemp -d "$build/bench.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# What the tool can measure by itself, with comment and header; then what needs the
# libraries raw or a process. Each section in a process of its own: a child's peak
# memory starts at its parent's.
printf 'bench: stylut bench\n' >&2
"$build/stylut" bench -q --csv "$scratch/own.csv"
{
  cat "$scratch/own.csv"
  for section in guide lut startup batch memory; do
    printf 'bench: %s\n' "$section" >&2
    "$build/tests/bench/bench" "$section" "$build/stylut" "$exemplars" "$scratch"
  done
  printf 'bench: engines\n' >&2
  if [ -d "${STYLUT_DATA:-}" ]; then "$build/tests/bench/engines" "$STYLUT_DATA"; else "$build/tests/bench/engines"; fi
} >"$scratch/bench.csv"
mv "$scratch/bench.csv" "$csv"

sed -n 's/^# //p' "$csv"
awk -F, '
  NR == 1 { next } # the comment
  { rows++; for (i = 1; i <= 8; i++) { cell[rows, i] = $i; if (length($i) > width[i]) width[i] = length($i) } }
  END {
    split("what variant runs median_ms rate unit ratio reference", title, " ")
    for (i = 1; i <= 8; i++) cell[1, i] = title[i]
    for (r = 1; r <= rows; r++) {
      if (cell[r, 1] != cell[r - 1, 1]) print ""
      for (i = 1; i <= 8; i++) printf i == 3 || i == 4 || i == 5 || i == 7 ? "%*s  " : "%-*s  ", width[i], cell[r, i]
      print ""
    }
  }
' "$csv" | sed 's/ *$//'
cat <<END

ratio: the reference's time over the row's; above 1, the row is the faster one.
memory: peak of the process less that of an idle one; its ratio is to the bytes of data held.
aims: guide 0.5 or more beside the bare loop, memory at most 3. The figures are also in ${csv#"$PWD"/}.
END
