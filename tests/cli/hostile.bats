#!/usr/bin/env bats
# Files that want harm: headers that claim the world, depth without end, names that speak to the terminal.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  oiiotool --no-autopremult "$exemplars/spheres/oil.png" --resize 48x48 -d uint8 -o oil.png
  "$STYLUT" guide sphere -s 48 -q -o sphere.exr
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "oil", "exemplar": "oil.png", "lut": {"size": 16}}]}\n' >m.json
  "$STYLUT" pack m.json -q -o bundle
}

# claim SIDE: sphere.exr, but for its windows, which are SIDE pixels wide and high.
claim() {
  node -e 'const fs = require("fs"), side = +process.argv[1], d = fs.readFileSync("sphere.exr");
    for (const name of ["dataWindow", "displayWindow"]) {
      const at = d.indexOf(name + "\0box2i\0") + name.length + 7 + 4;
      [0, 0, side - 1, side - 1].forEach((v, i) => d.writeInt32LE(v, at + 4 * i)); }
    fs.writeFileSync("claim.exr", d);' "$1"
}

@test "headers that claim more than a file can hold" {
  bring sphere.exr bundle oil.png
  local side
  for side in 16384 31623 65536 1000000 2147483647; do
    claim $side
    (
      [ "$STYLUT_CONFIG" = sanitize ] || ulimit -v 2000000
      refuse 3 claim.exr info claim.exr
      refuse 3 claim.exr lut claim.exr -o lut.exr
      refuse 3 claim.exr stylize bundle --guide claim.exr -o out.png
    ) || return 1
  done
  # A PNG whose header claims 60000x60000 pixels.
  node -e 'const fs = require("fs"), d = fs.readFileSync("oil.png"), zlib = require("zlib");
    d.writeUInt32BE(60000, 16); d.writeUInt32BE(60000, 20);
    const table = [...Array(256)].map((_, n) => { for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n >>> 0; });
    let c = 0xffffffff; for (let i = 12; i < 29; i++) c = table[(c ^ d[i]) & 255] ^ (c >>> 8);
    d.writeUInt32BE((c ^ 0xffffffff) >>> 0, 29); fs.writeFileSync("claim.png", d);'
  refuse 3 'found a header of 60000x60000 pixels' info claim.png
  refuse 3 '(--limit pixels=N)' stylize bundle --guide claim.png -o out.png
}

@test "limits that are set hold, in batches too, and are named" {
  bring oil.png m.json sphere.exr bundle
  refuse 3 'oil.png: found a header of 48x48 pixels and 4 channels, expected sides up to 65536, at most 2303 pixels (--limit pixels=N)' \
    pack m.json --limit pixels=2303 -o out
  accept pack m.json --limit pixels=2304 -o out
  refuse 3 'm.json: found' pack m.json --limit json-bytes=20 -o out
  refuse 3 'expected at most 20 (--limit json-bytes=N)' pack m.json --limit json-bytes=20 -o out
  refuse 3 'bundle/bundle.json' info bundle --limit json-bytes=100
  refuse 1 "--limit: found 'depth=3', expected pixels=N, json-bytes=N, import-seconds=N or import-bytes=N" info oil.png --limit depth=3
  refuse 1 "--limit pixels: found '0'" info oil.png --limit pixels=0
  printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' >a.obj
  refuse 3 a.obj guide scene a.obj --limit import-bytes=1000 -o a.exr
  accept guide scene a.obj -s 16 --limit import-bytes=2000000000 --limit import-seconds=60 -o a.exr
  # Of a step of a batch: its scene is the first to be read there.
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": "a.obj"}]}' >a.json
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "oil", "exemplar": "oil.png", "guide": "a.json", "lut": {"size": 16}}]}\n' >s.json
  "$STYLUT" batch s.json -q --limit import-bytes=1000 -o out2 2>said && complain 'batch imported beyond its limit'
  expect_holds batch "$(cat said)" 'a.obj'
  accept batch s.json -q --limit import-bytes=2000000000 -o out2
}

@test "JSON of endless depth, of huge numbers and counts" {
  bring oil.png sphere.exr
  node -e 'const fs = require("fs"), n = 100000;
    fs.writeFileSync("deep.json", "{\"schema\": " + "[".repeat(n) + "]".repeat(n) + "}");
    fs.writeFileSync("objects.json", "{\"a\": ".repeat(n) + "1" + "}".repeat(n));
    fs.writeFileSync("number.json", "{\"schema\": \"stylut-bundle/1\", \"styles\": [{\"name\": \"a\", \"exemplar\": \"oil.png\", \"lut\": {\"size\": 1" + "0".repeat(400) + "}}]}");
    fs.writeFileSync("many.json", JSON.stringify({schema: "stylut-bundle/1", styles: Array(100000).fill({name: "a", exemplar: "oil.png"})}));
    fs.writeFileSync("scene.json", JSON.stringify({schema: "stylut-scene/1", spheres: Array(100000).fill({center: [0, 0, 0], radius: 1})}));'
  local bad
  for bad in deep objects number many; do refuse 3 $bad.json pack $bad.json -o out; done
  for bad in deep objects scene; do refuse 3 $bad.json guide scene $bad.json -o out.exr; done
}

# Colours, a title and a clear screen, by ESC and by the one character that means ESC [.
esc=$'\e[31m\e]0;owned\a\e[2J\xc2\x9b31m'

count_controls() { LC_ALL=C.UTF-8 grep -cP '[\x{0}-\x{8}\x{b}-\x{1f}\x{7f}-\x{9f}]' "$1" || true; }

# expect_plain WHAT COMMAND...: nothing it says can move a cursor.
expect_plain() {
  local what=$1
  shift
  "$STYLUT" "$@" >said 2>&1 || true
  expect "$what: characters that are no text" "$(count_controls said)" 0
  grep -q 'owned' said || complain "$what: said nothing of the name"
}

@test "control characters in names never reach a terminal" {
  bring oil.png sphere.exr
  local name
  name=$(node -p 'JSON.stringify(process.argv[1])' "$esc")
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": %s, "exemplar": "oil.png", "lut": {"size": 16}}]}\n' "$name" >named.json
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": %s}]}\n' "$name" >file.json
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "oil.png", "lut": {"size": 16}, %s: 1}]}\n' "$name" >key.json
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": %s}]}\n' "$name" >scene.json
  expect_plain 'pack of a name' pack named.json -o bundle
  expect_plain info info bundle
  expect_plain params params bundle
  expect_plain 'params as JSON' params bundle --format json
  expect_plain 'a style' stylize bundle --guide sphere.exr --style nobody -o out.png
  expect_plain 'a style that is asked for' stylize bundle --guide sphere.exr --style "$esc" -o "$esc.jpg"
  expect_plain 'a setting' params bundle --set "$esc=1"
  expect_plain 'a file' pack file.json -o other
  expect_plain 'a key' pack key.json -o other
  expect_plain 'a mesh' guide scene scene.json -o other.exr
  expect_plain 'a file that is not there' info "$esc"
  expect_plain 'an option' info "--$esc"
  expect_plain 'a command' "$esc"
  expect_plain 'a batch' batch file.json -o out
  expect_plain 'a batch as JSON' batch file.json -k --junit said.xml --format json -o out
  expect 'JUnit' "$(count_controls said.xml)" 0
  xmllint --noout said.xml || complain 'JUnit XML is none'
  cp oil.png "$esc.png"
  cp named.json "$esc.json"
  expect_plain 'a picture' info "$esc.png"
  expect_plain 'a batch of a name' batch "$esc.json" --format json -o out
  expect_plain 'a report' report "$esc.png" --guide sphere.exr -o out.html
  expect_plain 'a dry run' pack named.json -o "$esc" --dry-run
}
