#!/usr/bin/env bash
# Runs every test and counts. Usage: run.sh BUILD CONFIG UNIT-TEST...
# Environment: CC, CXX of the build.
set -uo pipefail

build=$(cd "$1" && pwd)
config=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$here")
log=$build/tests/log
mkdir -p "$log"
passed=0 failed=0 skipped=0

# A folder of pictures and meshes of other projects, which aren't ours to hand on;
# tests that want them skip where there is none.
export STYLUT_DATA=${STYLUT_DATA:-}

# Leaks that aren't ours, each by the library's name; to see that name past
# frames without pointers the slow unwinder is needed. The image module carries
# copies of the base, hence the names defined twice.
# gcc 12's sanitizer takes a library's thread-local block for one of an older
# glibc when it happens to begin 16 bytes into a page, and then crashes while it
# looks for leaks; without that interception it finds such blocks all the same.
export LSAN_OPTIONS=suppressions=$here/leaks.supp:print_suppressions=0
export ASAN_OPTIONS=detect_odr_violation=0:fast_unwind_on_malloc=0:intercept_tls_get_addr=0
export UBSAN_OPTIONS=print_stacktrace=1

count() { # NAME STATUS LOG
  if [ "$2" = 0 ]; then
    printf 'ok    %s\n' "$1"
  else
    printf 'FAIL  %s (exit %s)\n' "$1" "$2"
    tail -n 40 "$3"
  fi
}

for program in "$@"; do
  name=${program#"$build"/}
  name=${name#*/tests/}
  file=$log/${name//\//_}.log
  "$program" >"$file" 2>&1
  status=$?
  ok=$(grep -c '^\[ *OK \]' "$file")
  bad=$(grep '^\[  FAILED  \] [a-z].*[^:]$' "$file" | sort -u | wc -l) # cmocka lists them once more at the end
  skip=$(grep -c '^\[  SKIPPED \]' "$file")
  [ "$status" != 0 ] && [ "$bad" = 0 ] && bad=1
  count "$name ($ok tests)" "$status" "$file"
  passed=$((passed + ok)) failed=$((failed + bad)) skipped=$((skipped + skip / 2))
done

# run_script NAME COMMAND...: one test by exit code.
run_script() {
  local name=$1 file
  shift
  file=$log/${name//[^a-z_]/_}.log
  "$@" >"$file" 2>&1
  local status=$?
  if [ "$status" = 77 ]; then
    printf 'skip  %s: %s\n' "$name" "$(tail -n 1 "$file")"
    skipped=$((skipped + 1))
    return
  fi
  count "$name" "$status" "$file"
  if [ "$status" = 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

run_script runtime/purity env CC="$CC" CXX="$CXX" "$here/runtime/test_purity.sh" "$build/libstylut_rt.a" "$config"
run_script pack/ktx-parse "$here/pack/ktx_parse.sh" "$build"
run_script include/headers env CC="$CC" CXX="$CXX" "$here/include/test_headers.sh"
# Files that fuzzing began with or that crashed something once; libFuzzer itself would never end.
for source in "$here"/fuzz/fuzz_*.c; do
  name=$(basename "$source" .c)
  name=${name#fuzz_}
  [ "$config" = fuzz ] || run_script "fuzz/$name" "$build/tests/fuzz/fuzz_$name" "$here/fuzz/corpus/$name"
done

# The real binary, through bats.
export STYLUT=$build/stylut STYLUT_BUILD=$build STYLUT_CONFIG=$config STYLUT_ROOT=$root
# Two files at a time: most of their time is programs starting.
rm -f "$log"/*.tap
run_file() { # FILE
  local tap
  tap=$log/$(basename "$1" .bats).tap
  bats --tap "$1" >"$tap" 2>&1 || echo "exit $?" >>"$tap"
}
# Slurm takes its time, and nobody else's.
run_file "$here/cli/slurm.bats" &
slurm=$!
for file in "$here"/cli/*.bats; do
  [ "$(basename "$file")" = slurm.bats ] && continue
  until [ "$(jobs -rp | grep -cvx "$slurm")" -lt 2 ]; do wait -n; done
  run_file "$file" &
done
wait
for file in "$log"/*.tap; do
  grep -E '^not ok|^#|^ok .*# skip' "$file"
  skips=$(grep -c '^ok .*# skip' "$file")
  bad=$(grep -c '^not ok' "$file")
  passed=$((passed + $(grep -c '^ok ' "$file") - skips)) skipped=$((skipped + skips))
  if [ "$bad" = 0 ] && grep -q '^exit ' "$file"; then
    cat "$file"
    bad=1
  fi
  failed=$((failed + bad))
done

printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
[ "$failed" = 0 ]
