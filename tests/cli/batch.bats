#!/usr/bin/env bats
# stylut batch: the bundles of stylut pack, step by step, and only what has changed.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  mkdir painted
  local style
  for style in oil pencil charcoal; do
    oiiotool --no-autopremult "$exemplars/spheres/$style.png" --resize 64x64 -d uint8 -o painted/$style.png
  done
  oiiotool --no-autopremult painted/oil.png --mulc 0.5,0.5,0.5,1 -d uint8 -o dark.png
  oiiotool --no-autopremult painted/oil.png --resize 48x48 -d uint8 -o small.png
  printf 'o ball\n' >room.obj
  awk 'BEGIN { for (i = 0; i <= 12; i++) for (k = 0; k < 24; k++) { a = 3.14159265 * i / 12; b = 2 * 3.14159265 * k / 24
      print "v", sin(a) * cos(b), cos(a), sin(a) * sin(b) }
    for (i = 0; i < 12; i++) for (k = 0; k < 24; k++) { p = i * 24 + k + 1; q = i * 24 + (k + 1) % 24 + 1
      print "f", p, p + 24, q + 24; print "f", p, q + 24, q } }' >>room.obj
  printf '%s\n' '{"schema": "stylut-scene/1", "camera": {"type": "fit", "view": "front"}, "objects": [{"mesh": "room.obj"}]}' >room.json
  "$STYLUT" guide sphere -s 64 --bits 8 -q -o sphere.png
  "$STYLUT" lut sphere.png -s 64 -q -o table.png
  "$STYLUT" guide scene room.json -s 64x64 -c normal -q -o frame.exr
  printf '%s\n' '{"schema": "stylut-bundle/1", "defaults": {"params": {"radius": 2}}, "styles": [{"glob": "painted/*.png"}]}' >styles.json
  printf '%s\n' '{"schema": "stylut-bundle/1", "defaults": {"lut": {"size": 64}}, "styles": [
    {"name": "two lights", "exemplars": [{"image": "dark.png", "luma": 0.2}, {"image": "painted/oil.png", "luma": 0.8}], "base": 2.123456789012},
    {"name": "room", "exemplar": "painted/pencil.png", "guide": "room.json"},
    {"name": "picture", "exemplar": "painted/oil.png", "guide": "sphere.png", "lut": {"resolve": "coherent", "slack": 1}},
    {"name": "table", "exemplar": "painted/oil.png", "guide": "sphere.png", "lut": "table.png"},
    {"name": "frames", "exemplar": "painted/charcoal.png", "lut": {"size": 64, "resolve": "both", "frames": ["frame.exr"]},
     "params": {"threshold": 60, "depth_tolerance": 0.1, "scale": 0.5}}]}' >all.json
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [
    {"name": "a", "exemplar": "painted/oil.png", "lut": {"budget": {"p99": 9}}}, {"name": "b", "exemplar": "small.png", "lut": {"budget": {"mean": 3}}}]}' >budget.json
}

# steps: how many the last batch did, of its JSON in $output.
steps() { json - r.done <<<"$output"; }

expect_steps() { # WHAT N: a batch with --format json does so many
  accept batch styles.json -o out --format json
  expect "steps for $1" "$(steps)" "$2"
}

expect_packed() { # BUNDLE MANIFEST OPTION...: what pack makes of it
  local name bundle=$1
  accept pack "${@:2}" -o ref
  for name in exemplars guides luts params jitter; do expect_same "$bundle/$name.ktx2" "ref/$name.ktx2"; done
  expect_same "$bundle/import-settings.json" ref/import-settings.json
  expect "index of $bundle" "$(json "$bundle/bundle.json" 'JSON.stringify([r.styles, r.jitter, r.history.manifest, r.files])')" \
    "$(json ref/bundle.json 'JSON.stringify([r.styles, r.jitter, r.history.manifest, r.files])')"
  expect "inputs of $bundle" "$(json "$bundle/bundle.json" 'JSON.stringify(Object.entries(r.history.inputs).sort())')" \
    "$(json ref/bundle.json 'JSON.stringify(Object.entries(r.history.inputs).sort())')"
  accept validate "$bundle"
  rm -rf ref
}

@test "bundles are those of pack" {
  bring painted dark.png small.png room.* sphere.png table.png frame.exr '*.json'
  accept batch styles.json all.json -o out
  expect_packed out/styles styles.json
  expect_packed out/all all.json
  accept batch budget.json -o out --fit pad --jitter-frames 2 --seed 5
  expect_packed out/budget budget.json --fit pad --jitter-frames 2 --seed 5
  accept batch budget.json -o out --fit resize --jitter-noise blue -j 1
  expect_packed out/budget budget.json --fit resize --jitter-noise blue
  accept batch styles.json all.json -o out --no-history
  expect history "$(json out/all/bundle.json r.history)" undefined
}

@test "only what has changed is made anew" {
  bring painted dark.png styles.json
  expect_steps everything 10
  expect_steps nothing 0
  touch painted/* styles.json
  expect_steps 'files that were touched' 0
  cp dark.png painted/oil.png
  expect_steps 'an exemplar of the same outline' 2
  expect_packed out/styles styles.json
  touch -d '2001-01-01' painted/charcoal.png
  cp -p painted/charcoal.png kept.png
  cp dark.png painted/charcoal.png
  touch -d '2000-01-01' painted/charcoal.png
  expect_steps 'a file that became older' 2
  cp -p kept.png painted/charcoal.png
  expect_steps 'the file as it was' 2
  sed -i 's/"radius": 2/"radius": 3/' styles.json
  expect_steps 'a parameter' 2
  oiiotool --no-autopremult painted/pencil.png --fill:color=0,0,0,0 20x20+20+20 -d uint8 -o hole.png
  mv hole.png painted/pencil.png
  # exemplars, source guides, its table, tables, bundle
  expect_steps 'a hole in the paint' 5
  expect_packed out/styles styles.json
  rm -r out/styles
  expect_steps 'a bundle that is gone' 1
  expect_packed out/styles styles.json
  cp painted/oil.png painted/another.png
  accept batch styles.json -o out
  expect_packed out/styles styles.json
  rm painted/another.png
  accept batch styles.json -o out
  expect_packed out/styles styles.json
}

@test "meshes that a scene names are inputs" {
  bring painted dark.png room.* sphere.png table.png frame.exr all.json
  accept batch all.json -o out
  sed -i 's/^v 0 1 0/v 0 1.5 0/' room.obj
  accept batch all.json -o out --format json
  # The guide, source guides, its table, tables, bundle.
  expect 'steps for a mesh' "$(steps)" 5
  expect_packed out/all all.json
  touch room.obj
  accept batch all.json -o out --format json
  expect 'steps for a mesh that was touched' "$(steps)" 0
  mv room.obj gone.obj
  refuse_batch 2 'room.obj' all.json -o out
  mv gone.obj room.obj
  accept batch all.json -o out
  expect_packed out/all all.json
}

# refuse_batch CODE PART ARGUMENT...: as refuse, but the work folder may change.
refuse_batch() { complain_unless_refused "$1" "$2" batch "${@:3}"; }

@test "failures are said, and the rest goes on where that is asked for" {
  bring painted dark.png small.png styles.json budget.json
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "broken.png"}]}' >broken.json
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"name": "<two>", "exemplar": "dark.png", "lut": {"budget": {"max": 0.001}}}]}' >strict.json
  head -c 200 dark.png >broken.png
  refuse 3 broken.png batch broken.json styles.json -o out
  refuse_batch 6 "strict, size for the budget of '<two>': style '<two>': budget: found max" strict.json -o out
  [ ! -e out/strict ] || complain 'a bundle over its budget was made'
  local status=0
  "$STYLUT" batch broken.json strict.json styles.json -o out -k --format json --junit out.xml >result.json 2>said.txt || status=$?
  expect 'exit code' "$status" 3
  expect lines "$(wc -l <said.txt)" 2
  expect_holds said "$(cat said.txt)" 'stylut: error: broken, plan: '
  expect_holds said "$(cat said.txt)" 'stylut: error: strict, '
  expect failed "$(json result.json 'r.bundles.map(b => b.failed).join()')" 1,1,0
  accept validate out/styles
  # Read by a reader of XML.
  expect junit "$(python3 -c 'import sys, xml.etree.ElementTree as e
for s in e.parse("out.xml").getroot(): print(s.get("name"), s.get("failures"), len(s) == int(s.get("tests")), [c.get("name") for c in s if len(c)])')" \
    "broken 1 True ['plan']
strict 1 True [\"size for the budget of '<two>'\"]
styles 0 True []"
  # Mended, it goes on.
  cp dark.png broken.png
  sed -i 's/0.001/50/' strict.json
  accept batch broken.json strict.json styles.json -o out
  accept validate out/broken
  accept validate out/strict
}

@test "a batch that was killed goes on" {
  bring painted dark.png room.* sphere.png table.png frame.exr '*.json'
  accept batch styles.json all.json -o whole
  local delay
  for delay in 0.02 0.05 0.1 0.2 0.3 0.4 0.5 0.7 0.9; do
    setsid "$STYLUT" batch styles.json all.json -o out >/dev/null 2>&1 &
    local group=$!
    sleep $delay
    kill -KILL -- -$group 2>/dev/null || true
    wait $group || true
  done
  accept batch styles.json all.json -o out
  local name bundle
  for bundle in styles all; do
    for name in exemplars guides luts params jitter; do expect_same "out/$bundle/$name.ktx2" "whole/$bundle/$name.ktx2"; done
    accept validate out/$bundle
  done
  accept batch styles.json all.json -o out --format json
  expect 'steps left' "$(steps)" 0
}

@test "tables are shared by guide, outline and what is asked for, and go with the last that has them" {
  bring painted dark.png
  cp painted/oil.png same.png
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [
    {"name": "one", "exemplar": "painted/oil.png"}, {"name": "dark", "exemplar": "dark.png"}, {"name": "same", "exemplar": "same.png"},
    {"name": "centred", "exemplar": "same.png", "lut": {"sampling": "centre"}},
    {"name": "engine", "exemplar": "same.png", "lut": {"engine": "brute"}}]}' >styles.json
  accept batch styles.json -o out
  expect tables "$(find out/.stylut/tables -name '*.ktx2' | wc -l)" 3
  expect_packed out/styles styles.json
  oiiotool --no-autopremult painted/oil.png --fill:color=0,0,0,0 20x20+20+20 -d uint8 -o same.png
  accept batch styles.json -o out
  expect 'tables, one of them with a hole' "$(find out/.stylut/tables -name '*.ktx2' | wc -l)" 4
  expect_packed out/styles styles.json
  cp painted/oil.png same.png
  accept batch styles.json -o out
  expect 'tables as before' "$(find out/.stylut/tables -name '*.ktx2' | wc -l)" 3
  expect_packed out/styles styles.json
}

@test "bundles that share tables are done after one run, and what nobody shares goes" {
  bring painted
  local i
  for i in 1 2 3; do printf '%s\n' '{"schema": "stylut-bundle/1", "defaults": {"lut": {"size": 32}}, "styles": [{"glob": "painted/*.png"}]}' >m$i.json; done
  accept batch m1.json m2.json m3.json -o out
  accept batch m1.json m2.json m3.json -o out
  expect_holds 'the second time' "$output" ' 0 steps done'
  expect 'a table and its facts' "$(find out/.stylut/tables -type f | wc -l)" 2
  for i in 9 12 15; do # outlines: one table more, which goes with the next
    oiiotool --no-autopremult painted/pencil.png --fill:color=0,0,0,0 ${i}x9+20+20 -d uint8 -o new.png
    mv new.png painted/pencil.png
    accept batch m1.json m2.json m3.json -o out
    expect "tables and facts that are kept of outline $i" "$(find out/.stylut/tables -type f | wc -l)" 4
  done
  accept batch m1.json m2.json m3.json -o out
  expect_holds 'the second time' "$output" ' 0 steps done'
}

@test "--check audits every table, and refuses bundles by it" {
  bring painted table.png sphere.png
  printf '%s\n' '{"schema": "stylut-bundle/1", "defaults": {"check": {"max-p99": 50, "min-coverage": 0.5}}, "styles": [
    {"name": "loose", "exemplar": "painted/oil.png"},
    {"name": "strict", "exemplar": "painted/oil.png", "check": {"max-p99": 0.5, "max-mean": 0.1, "max-jumps": 1}}]}' >m.json
  accept batch m.json -o out
  rm -r out/m
  refuse_batch 6 "error: m, audit of 'strict': style 'strict': max-mean: found 1." m.json -o out --check
  refuse_batch 6 '; max-p99: found ' m.json -o out --check -k
  [ ! -e out/m ] || complain 'a bundle was packed of which an audit fails'
  # The same figures as of check, for the same table and guide.
  sed -i 's/0\.5, "max-mean": 0\.1/50, "max-mean": 20/' m.json
  accept batch m.json -o out --check
  accept validate out/m
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "painted/oil.png", "guide": "sphere.png", "lut": "table.png"}]}' >one.json
  oiiotool --no-autopremult painted/oil.png --ch R,G,B,A=1 -d uint8 -o painted/oil.png
  accept batch one.json -o out --check
  "$STYLUT" check table.png --guide sphere.png --format json >check.json
  expect audit "$(json out/.stylut/one/luts/001.audit 'JSON.stringify([r.lookup, r.assignment, r.ambiguous, r.jumps, r.unstable, r.unused, r.coverage])')" \
    "$(json check.json 'JSON.stringify([r.lookup, r.assignment, r.ambiguous, r.jumps, r.unstable, r.unused, r.coverage])')"
  accept batch one.json -o out --check --format json
  expect 'steps of an audit that passed' "$(steps)" 0
  # Budgets are looked at anew when they change.
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "painted/oil.png", "guide": "sphere.png", "lut": "table.png", "check": {"max-error": 0.001}}]}' >one.json
  refuse_batch 6 'max-error' one.json -o out --check
  for check in '5' '{"max-p98": 1}' '{"max-p99": "1"}' '{"max-jumps": 2}' '{"min-coverage": -1}'; do
    printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "painted/oil.png", "check": '"$check"'}]}' >bad.json
    refuse 3 'bad.json:1:' pack bad.json -o bundle
    refuse 3 'bad.json:1:' batch bad.json -o other
  done
}

@test "a dry run says what would be done" {
  bring painted styles.json dark.png
  local before after
  before=$(list_files)
  accept batch styles.json -o out --dry-run
  after=$(list_files)
  expect 'files of a dry run' "$after" "$before"
  expect lines "$(wc -l <<<"$output")" 11
  expect_holds steps "$output" "styles: table of 'oil'"
  accept batch styles.json -o out
  cp dark.png painted/oil.png
  accept batch styles.json -o out --dry-run
  expect_holds steps "$output" 'styles: exemplars'
  accept batch styles.json -o out --format json
  expect steps "$(steps)" 2
}

@test "names of every kind" {
  bring painted/oil.png
  mkdir 'odd $folder: é'
  cp oil.png 'odd $folder: é/a b$c:d'"'"'é.png'
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [{"glob": "*.png"}]}' >'odd $folder: é/my $tyle: 1.json'
  accept batch 'odd $folder: é/my $tyle: 1.json' -o 'out put'
  accept validate 'out put/my $tyle: 1'
  expect 'style name' "$(json 'out put/my $tyle: 1/bundle.json' 'r.styles[0].name')" 'a b$c:d'"'"'é'
  mkdir x
  cp 'odd $folder: é/my $tyle: 1.json' x/guides.json
  refuse 1 'guides.json' batch x/guides.json -o other
  cp 'odd $folder: é/my $tyle: 1.json' x
  refuse 1 'one name' batch 'odd $folder: é/my $tyle: 1.json' 'x/my $tyle: 1.json' -o other
}

@test "wrong calls" {
  bring painted styles.json
  refuse 1 manifest batch -o out
  refuse 1 output batch styles.json
  refuse 2 missing.json batch missing.json -o out
  refuse 1 fit batch styles.json -o out --fit cut
  refuse 2 'no-folder' batch styles.json -o no-folder/out
  PATH=/nowhere refuse_batch 5 'ninja' styles.json -o out
  printf 'x' >file
  refuse 2 file batch styles.json -o file
  refuse 2 missing.json step missing.json
  refuse 3 schema step styles.json
  printf '%s\n' '{"schema": "stylut-step/1", "step": "dance", "output": "x"}' >step.json
  refuse 3 dance step step.json
}

# paint_fifty FOLDER GREEN: fifty styles in five outlines, each its own painting.
paint_fifty() {
  local i words=()
  mkdir "$1"
  for i in $(seq 0 4); do
    words+=(painted/oil.png --resize 32x32 --fill:color=0,0,0,0 $((2 * i + 1))x3+8+8 -d uint8 -o "cut$i.png")
  done
  for i in $(seq 10 59); do words+=("cut$((i % 5)).png" --mulc "0.$i,$2,1,1" -d uint8 -o "$1/$i.png"); done
  oiiotool --no-autopremult "${words[@]}"
}

@test "fifty styles: built, changed one by one, and killed twenty times" {
  bring painted
  paint_fifty fifty 0.5
  paint_fifty other 0.7
  printf '%s\n' '{"schema": "stylut-bundle/1", "defaults": {"lut": {"size": 16}}, "styles": [{"glob": "fifty/*.png"}]}' >styles.json
  # A guide, exemplars, guides, 50 tables, their array, parameters, jitter, the bundle.
  expect_steps 'fifty styles' 57
  expect_steps nothing 0
  local i name
  for i in $(seq 10 59); do
    # Another colour, the same outline: its layer in the exemplars, and the bundle.
    cp other/$i.png fifty
    expect_steps "a colour of $i" 2
  done
  # Another outline: its table, the guides and the array of tables besides.
  oiiotool --no-autopremult fifty/33.png --fill:color=0,0,0,0 4x4+20+20 -d uint8 -o new.png
  mv new.png fifty/33.png
  expect_steps 'an outline' 5
  sed -i 's/"size": 16/"size": 16, "sampling": "centre"/' styles.json
  expect_steps 'all tables' 53
  # Killed at twenty moments of a whole build, it ends with the same bytes.
  mv out whole
  for i in $(seq 20); do
    timeout -s KILL "0.$((RANDOM % 40 + 3))" setsid "$STYLUT" batch styles.json -o out -q 2>/dev/null || true
  done 2>/dev/null
  accept batch styles.json -o out
  for name in exemplars guides luts params jitter; do expect_same whole/styles/$name.ktx2 out/styles/$name.ktx2; done
}
