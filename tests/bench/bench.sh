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

cpu=$(sed -n 's/^model name[[:blank:]]*: //p' /proc/cpuinfo | head -n 1)
versions=$("$build/stylut" --version | head -n 2 | paste -s -d ';' | sed 's/;/; /')

# Each section in a process of its own: a child's peak memory starts at its parent's.
{
  printf '# %s, %s cores; %s\n' "${cpu:-unknown processor}" "$(nproc)" "$versions"
  printf 'row,variant,runs,median_ms,rate,rate_unit,ratio,reference\n'
  for section in guide lut pack stylize startup memory; do
    printf 'bench: %s\n' "$section" >&2
    "$build/tests/bench/bench" "$section" "$build/stylut" "$exemplars" "$scratch"
  done
} >"$scratch/bench.csv"
mv "$scratch/bench.csv" "$csv"

sed -n 's/^# //p' "$csv"
awk -F, '
  NR == 1 { next }
  NR == 2 {
    printf "\n%-23s %-29s %4s %12s %11s %-12s %7s  %s\n", "what", "variant", "runs", "median, ms", "rate", "", "ratio", "to"
    next
  }
  $1 != row && NR > 3 { print "" }
  { row = $1; printf "%-23s %-29s %4s %12s %11s %-12s %7s  %s\n", $1, $2, $3, $4, $5, $6, $7, $8 }
' "$csv"
cat <<END

ratio: the reference's time over the row's, above 1 is faster than the reference.
memory: peak of the process less that of an idle one; its ratio is to the bytes of data held.
aims: guide 0.5 or more beside the bare loop, memory below 4. The figures are also in ${csv#"$PWD"/}.
END
