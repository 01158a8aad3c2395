# shellcheck shell=bash
# What all command tests share. Environment: STYLUT (the binary), STYLUT_BUILD
# (its folder), STYLUT_CONFIG, STYLUT_ROOT (the sources), as tests/run.sh sets.
#
# A test works in a folder of its own. Checks made with `complain` don't end the
# test at once, so that one run shows all that is wrong; teardown then fails it.

: "${STYLUT:?}" "${STYLUT_BUILD:?}" "${STYLUT_CONFIG:?}" "${STYLUT_ROOT:?}"
# STYLUT_BUILD is often relative; tests change folder.
STYLUT=$(realpath "$STYLUT")
STYLUT_BUILD=$(realpath "$STYLUT_BUILD")
STYLUT_ROOT=$(realpath "$STYLUT_ROOT")
# shellcheck disable=SC2034 # for the tests
exemplars=$STYLUT_ROOT/exemplars shared_data=$STYLUT_ROOT/../shared/data

# What an outer make hands down would rule the makes that tests start.
unset MAKEFLAGS MFLAGS MAKEOVERRIDES MAKELEVEL

setup() {
  mkdir "$BATS_TEST_TMPDIR/work"
  cd "$BATS_TEST_TMPDIR/work" || return 1
}

teardown() {
  local status=0
  wait
  ! mountpoint -q disk 2>/dev/null || umount disk
  if [ -s "$BATS_TEST_TMPDIR/complaints" ]; then
    cat "$BATS_TEST_TMPDIR/complaints"
    status=1
  fi
  cd / || return 1
  return $status
}

# complain TEXT...: notes what is wrong; the test fails in the end.
complain() { printf '%.2000s\n' "$*" | tr -c '[:print:]\n' '?' >>"$BATS_TEST_TMPDIR/complaints"; }

# expect WHAT FOUND EXPECTED
expect() { [ "$2" = "$3" ] || complain "$1: found '$2', expected '$3'"; }

# expect_holds WHAT TEXT PART
expect_holds() { [[ $2 == *"$3"* ]] || complain "$1: found '$2', expected it to hold '$3'"; }

# expect_match WHAT TEXT REGEX
expect_match() { [[ $2 =~ $3 ]] || complain "$1: found '$2', expected it to match '$3'"; }

# expect_less WHAT A B: A < B as numbers
expect_less() { awk -v a="$2" -v b="$3" 'BEGIN { exit !(a + 0 < b + 0) }' || complain "$1: found $2, expected less than $3"; }

expect_same() { cmp -s "$1" "$2" || complain "$1 and $2 differ, expected the same bytes"; }
expect_other() { ! cmp -s "$1" "$2" || complain "$1 and $2 hold the same bytes, expected a difference"; }

# All that is below the working folder, with times: what a refused command must leave alone.
list_files() { find . -type d -printf '%P/\n' -o -printf '%P %s %T@\n' | sort; }

# bring PATTERN...: copies of what setup_file made.
bring() {
  local pattern
  # shellcheck disable=SC2086
  for pattern in "$@"; do cp -r "$BATS_FILE_TMPDIR"/$pattern .; done
}

# accept COMMAND...: passes and says nothing on stderr. Its stdout becomes $output.
accept() {
  local status=0 said=$BATS_TEST_TMPDIR/stderr
  # shellcheck disable=SC2034 # for the tests
  output=$("$STYLUT" "$@" 2>"$said") || status=$?
  [ $status = 0 ] && [ ! -s "$said" ] && return 0
  printf "'stylut %s': exit %s, stderr '%s', expected to pass in silence\n" "$*" "$status" "$(cat "$said")"
  return 1
}

# complain_unless_refused CODE NAMED COMMAND...: ends with CODE and says why in
# one line that begins with 'stylut: error:' and holds NAMED.
complain_unless_refused() {
  local code=$1 named=$2 status=0 said
  shift 2
  said=$("$STYLUT" "$@" 2>&1 >/dev/null </dev/null) || status=$?
  local line="'stylut $*'"
  [ "$status" = "$code" ] || complain "$line: exit $status, expected $code; it said '$said'"
  [[ $said == 'stylut: error: '* && $said != *$'\n'* ]] || complain "$line: said '$said', expected one line 'stylut: error: ...'"
  [[ $said == *"$named"* ]] || complain "$line: said '$said', expected it to name '$named'"
}

# refuse CODE NAMED COMMAND...: and writes nothing, either.
refuse() {
  local before after
  before=$(list_files)
  complain_unless_refused "$@"
  after=$(list_files)
  [ "$before" = "$after" ] || complain "'stylut ${*:3}': changed files:
$(diff <(printf '%s\n' "$before") <(printf '%s\n' "$after"))"
}

# beside CHECK...: runs a check in a copy of the folder, while the test goes on;
# two at a time. `wait` for them before the end.
beside() {
  local copy
  while [ "$(jobs -pr | wc -l)" -ge 2 ]; do wait -n || true; done
  copy=$(mktemp -d "$BATS_TEST_TMPDIR/beside.XXXXXX")
  cp -r . "$copy"
  (
    cd "$copy" || exit 1
    "$@" || complain "'$*' failed"
    rm -rf "$copy"
  ) 3>&- &
}

# prove COMMAND...: passes, writing out.*, which is removed again. Proved once a
# file of tests: a command reads only what setup_file made.
prove() {
  local proofs=$BATS_FILE_TMPDIR/.proofs
  grep -qsxF -- "$*" "$proofs" && return 0
  wait
  accept "$@" || return 1
  rm -rf out.*
  printf '%s\n' "$*" >>"$proofs"
}

# swap CODE GOOD BAD COMMAND...: passes as it stands (writing out.*), is refused
# by the name of BAD with BAD in the place of the argument GOOD.
swap() {
  local code=$1 good=$2 bad=$3 changed=() argument
  shift 3
  prove "$@" || return 1
  for argument in "$@"; do
    [ "$argument" = "$good" ] && argument=$bad
    changed+=("$argument")
  done
  [ "${changed[*]}" != "$*" ] || complain "'$*' doesn't hold '$good'"
  beside refuse "$code" "$bad" "${changed[@]}"
}

# small_disk SIZE: mounts one at ./disk, or skips the test.
small_disk() {
  mkdir disk
  mount -t tmpfs -o "size=$1" tmpfs disk 2>/dev/null || skip "mounting a small tmpfs is not allowed here"
}

# json FILE EXPRESSION: a value of a JSON file, called r; '-' is stdin.
json() { node -p 'const r = JSON.parse(require("fs").readFileSync(process.argv[1] === "-" ? 0 : process.argv[1])); let v = eval(process.argv[2]); typeof v === "object" ? JSON.stringify(v) : v' "$1" "$2"; }

# dump FILE CHANNELS [SCALE]: a line 'x y value...' per pixel; with SCALE (255, 65535)
# the integers of the file.
dump() {
  local copy
  copy=$(mktemp --suffix=.exr -p "$BATS_TEST_TMPDIR") # several may run at once
  oiiotool --no-autopremult "$1" --ch "$2" --chnames c0,c1,c2,c3,c4,c5,c6,c7,c8,c9 -d float -o "$copy"
  oiiotool --dumpdata "$copy" | sed -nE 's/^ *Pixel \(([0-9]+), ([0-9]+)\): (.*)/\1 \2 \3/p' |
    if [ -n "${3:-}" ]; then
      awk -v s="$3" '{ printf "%s %s", $1, $2; for (i = 3; i <= NF; i++) printf " %d", $i * s + 0.5; print "" }'
    else
      cat
    fi
  rm "$copy"
}

# expect_near WHAT 'FOUND...' 'EXPECTED...' TOLERANCE: lists of numbers
expect_near() {
  awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN {
    n = split(a, x); m = split(b, y)
    if (n != m || n == 0) exit 1
    for (i = 1; i <= n; i++) if (!(x[i] - y[i] <= t + 0 && y[i] - x[i] <= t + 0)) exit 1
  }' || complain "$1: found '$2', expected '$3' within $4"
}

# need_data FILE...: skips the test unless the shared data have them.
need_data() {
  local file
  for file in "$@"; do
    [ -e "$shared_data/$file" ] || skip "no shared data: ../shared/data/$file"
  done
}

# write_manifest [FILE]: one style with every key, each on a line of its own.
write_manifest() {
  cat >"${1:-manifest.json}" <<'EOF'
{
  "schema": "stylut-bundle/1",
  "styles": [
    {
      "name": "first",
      "exemplar": "exemplar.png",
      "guide": "guide.exr",
      "lut": {
        "size": 16,
        "engine": "auto",
        "sampling": "unorm8",
        "resolve": "nearest"
      },
      "params": {
        "threshold": 24,
        "top_level": 6,
        "radius": 1,
        "depth_tolerance": 0
      }
    }
  ],
  "jitter": "jitter.png"
}
EOF
}
