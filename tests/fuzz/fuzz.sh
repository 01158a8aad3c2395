#!/usr/bin/env bash
# Runs fuzz targets one after the other, each from its corpus and from what it
# found earlier. Usage: fuzz.sh BUILD SECONDS TARGET...
# What crashes a target lands in BUILD/fuzz/crashes; once mended, it belongs in
# tests/fuzz/corpus/NAME.
set -uo pipefail
build=$(cd "$1" && pwd)
seconds=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
export TMPDIR=$build/fuzz/tmp
mkdir -p "$TMPDIR" "$build/fuzz/crashes"
export UBSAN_OPTIONS=print_stacktrace=1

failed=0
for target in "$@"; do
  name=${target##*/fuzz_}
  found=$build/fuzz/$name
  log=$build/fuzz/$name.log
  mkdir -p "$found"
  # OpenImageIO's own leaks aren't told from ours without the slow unwinder; replays have that.
  leaks=1
  [ "$name" != picture ] || leaks=0
  export ASAN_OPTIONS=detect_leaks=$leaks:detect_odr_violation=0 # the latter as in tests/run.sh
  # An EXR whose attributes are longer or shorter than they say can still have OpenEXR ask for 2 GB.
  if "$target" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 -detect_leaks=$leaks \
    -artifact_prefix="$build/fuzz/crashes/$name-" "$found" "$here/corpus/$name" >"$log" 2>&1; then
    printf 'ok    %s: %s inputs, %s\n' "$name" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" \
      "$(grep -o 'cov: [0-9]* ft: [0-9]*' "$log" | tail -n 1)"
  else
    printf 'FAIL  %s\n' "$name"
    tail -n 60 "$log"
    failed=1
  fi
done
exit $failed
