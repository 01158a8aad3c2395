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
exemplars=$STYLUT_ROOT/exemplars data=${STYLUT_DATA:-none}

# What an outer make hands down would rule the makes that tests start.
unset MAKEFLAGS MFLAGS MAKEOVERRIDES MAKELEVEL

setup() {
  mkdir "$BATS_TEST_TMPDIR/desk"
  cd "$BATS_TEST_TMPDIR/desk" || return 1
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
expect_less() { awk -v a="$2" -v b="$3" 'BEGIN { exit !(a != "" && b != "" && a + 0 < b + 0) }' || complain "$1: found '$2', expected less than '$3'"; }

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
  local status=0 said=$BATS_TEST_TMPDIR/stderr.$BASHPID
  # shellcheck disable=SC2034 # for the tests
  output=$("$STYLUT" "$@" 2>"$said") || status=$?
  [ $status = 0 ] && [ ! -s "$said" ] && return 0
  complain "'stylut $*': exit $status, stderr '$(cat "$said")', expected to pass in silence"
  return 1
}

# accept_warned PART COMMAND...: passes, with a line on stderr that begins with
# 'stylut: warning:' and holds PART, and says nothing there with -q.
accept_warned() {
  local part=$1 status=0 said
  shift
  "$STYLUT" "$@" -q >/dev/null 2>quiet.txt || status=$?
  [ "$status:$(cat quiet.txt)" = 0: ] || complain "'stylut $* -q': exit $status, stderr '$(cat quiet.txt)', expected to pass in silence"
  rm -f quiet.txt
  said=$BATS_TEST_TMPDIR/stderr.$BASHPID
  # shellcheck disable=SC2034 # for the tests
  output=$("$STYLUT" "$@" 2>"$said") || status=$?
  [ $status = 0 ] && [ "$(wc -l <"$said")" = 1 ] && grep -q "^stylut: warning: " "$said" && grep -qF -- "$part" "$said" && return 0
  complain "'stylut $*': exit $status, stderr '$(cat "$said")', expected one warning with '$part'"
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
# by the name of BAD with BAD in the place of the argument GOOD. Needs `wait`.
swap() { beside swap_here "$@"; }
swap_here() {
  local code=$1 good=$2 bad=$3 changed=() argument
  shift 3
  prove "$@" || return 1
  for argument in "$@"; do
    [ "$argument" = "$good" ] && argument=$bad
    changed+=("$argument")
  done
  [ "${changed[*]}" != "$*" ] || complain "'$*' doesn't hold '$good'"
  refuse "$code" "$bad" "${changed[@]}"
}

# small_disk SIZE: mounts one at ./disk, or skips the test.
small_disk() {
  mkdir disk
  mount -t tmpfs -o "size=$1" tmpfs disk 2>/dev/null || skip "mounting a small tmpfs is not allowed here"
}

# json FILE EXPRESSION: a value of a JSON file, called r; '-' is stdin.
json() { node -p 'const r = JSON.parse(require("fs").readFileSync(process.argv[1] === "-" ? 0 : process.argv[1])); let v = eval(process.argv[2]); typeof v === "object" ? JSON.stringify(v) : v' "$1" "$2"; }

# dump FILE CHANNELS [SCALE]: a line 'x y value...' per pixel of an EXR or PNG file,
# read without stylut's or anybody's image library; with SCALE (255, 65535) the
# integers of the file; with 'count' only how many values of a channel aren't 0.
dump() { node -e "$pixel_reader" "$@"; }
# shellcheck disable=SC2016 # it is JavaScript
pixel_reader='
const { readFileSync } = require("fs"), { inflateSync } = require("zlib")
const [file, wanted, scale] = process.argv.slice(1), bytes = readFileSync(file)
const image = bytes.readUInt32LE(0) === 20000630 ? readExr(bytes) : readPng(bytes)
const planes = wanted.split(",").map(name => {
  if (!image.planes[name]) throw new Error(`${file} has no channel ${name}`)
  return image.planes[name]
})
if (scale === "count") {
  console.log(planes[0].reduce((sum, v) => sum + (v !== 0), 0))
  process.exit()
}
const show = v => scale ? Math.floor(v * scale + 0.5) : Number.isFinite(v) ? v.toFixed(9) : v > 0 ? "inf" : v < 0 ? "-inf" : "nan"
const lines = []
for (let y = 0, i = 0; y < image.height; y++)
  for (let x = 0; x < image.width; x++, i++) lines.push(`${x} ${y} ${planes.map(p => show(p[i])).join(" ")}`)
process.stdout.write(lines.join("\n") + "\n")

function readPng(b) {
  const width = b.readUInt32BE(16), height = b.readUInt32BE(20), depth = b[24], count = { 0: 1, 2: 3, 4: 2, 6: 4 }[b[25]]
  if (b[28]) throw new Error("interlaced")
  const parts = []
  for (let at = 8; at < b.length; at += 12 + b.readUInt32BE(at))
    if (b.toString("latin1", at + 4, at + 8) === "IDAT") parts.push(b.subarray(at + 8, at + 8 + b.readUInt32BE(at)))
  const data = inflateSync(Buffer.concat(parts)), step = count * depth / 8, row = width * step
  let above = Buffer.alloc(row)
  const names = [, ["Y"], ["Y", "A"], ["R", "G", "B"], ["R", "G", "B", "A"]][count], planes = {}
  for (const name of names) planes[name] = new Float64Array(width * height)
  for (let y = 0; y < height; y++) {
    const filter = data[y * (row + 1)], line = data.subarray(y * (row + 1) + 1, (y + 1) * (row + 1))
    for (let i = 0; i < row; i++) {
      const a = i >= step ? line[i - step] : 0, c = i >= step ? above[i - step] : 0, p = a + above[i] - c
      const da = Math.abs(p - a), db = Math.abs(p - above[i]), dc = Math.abs(p - c)
      line[i] += [0, a, above[i], a + above[i] >> 1, da <= db && da <= dc ? a : db <= dc ? above[i] : c][filter]
    }
    for (let x = 0; x < width; x++)
      names.forEach((name, k) => planes[name][y * width + x] = depth === 8 ? line[x * step + k] / 255 : line.readUInt16BE(x * step + 2 * k) / 65535)
    above = line
  }
  return { width, height, planes }
}

function readExr(b) {
  let at = 8
  const text = () => { const from = at; while (b[at]) at++; return b.toString("latin1", from, at++) }
  const header = {}
  while (b[at]) {
    const name = text(), type = text(), size = b.readInt32LE(at)
    header[name] = { at: at + 4, size }
    at += 4 + size
  }
  at++
  const box = [0, 4, 8, 12].map(o => b.readInt32LE(header.dataWindow.at + o)), compression = b[header.compression.at]
  const rows = { 0: 1, 2: 1, 3: 16 }[compression], channels = [], planes = {}
  const width = box[2] - box[0] + 1, height = box[3] - box[1] + 1, chunks = Math.ceil(height / rows), table = at
  for (at = header.channels.at; b[at];) {
    const name = text(), half = b.readInt32LE(at) === 1
    channels.push({ name, half })
    planes[name] = new Float64Array(width * height)
    at += 16
  }
  const line = channels.reduce((sum, c) => sum + width * (c.half ? 2 : 4), 0)
  for (let k = 0; k < chunks; k++) {
    const from = Number(b.readBigUInt64LE(table + 8 * k)), top = b.readInt32LE(from) - box[1], size = b.readInt32LE(from + 4)
    const lines = Math.min(rows, height - top)
    let data = b.subarray(from + 8, from + 8 + size)
    if (size < line * lines) {
      const packed = inflateSync(data), middle = packed.length + 1 >> 1
      for (let i = 1; i < packed.length; i++) packed[i] += packed[i - 1] - 128
      data = Buffer.alloc(packed.length)
      for (let i = 0; i < packed.length; i++) data[i] = packed[i % 2 ? middle + (i >> 1) : i >> 1]
    }
    for (let y = top, i = 0; y < top + lines; y++)
      for (const c of channels)
        for (let x = 0; x < width; x++, i += c.half ? 2 : 4) planes[c.name][y * width + x] = c.half ? readHalf(data.readUInt16LE(i)) : data.readFloatLE(i)
  }
  return { width, height, planes }
}

function readHalf(h) {
  const e = h >> 10 & 31, m = h & 1023, s = h >> 15 ? -1 : 1
  return e === 31 ? (m ? NaN : s * Infinity) : s * (e ? 2 ** (e - 15) * (1 + m / 1024) : 2 ** -14 * m / 1024)
}
'

# expect_near WHAT 'FOUND...' 'EXPECTED...' TOLERANCE: lists of numbers
expect_near() {
  awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN {
    n = split(a, x); m = split(b, y)
    if (n != m || n == 0) exit 1
    for (i = 1; i <= n; i++) if (!(x[i] - y[i] <= t + 0 && y[i] - x[i] <= t + 0)) exit 1
  }' || complain "$1: found '$2', expected '$3' within $4"
}

# need_data FILE...: skips the test unless STYLUT_DATA has them.
need_data() {
  local file
  for file in "$@"; do
    [ -e "$data/$file" ] || skip "no $file: STYLUT_DATA names no folder that has it"
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
