#!/usr/bin/env bats
# stylut report: the page as a file, and as Chromium shows it.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" guide sphere -s 40 -q -o sphere.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 120x100 -q -o creature8.png
  "$STYLUT" lut sphere.exr -s 48 -q -o sphere.lut.exr
  "$STYLUT" lut creature8.png -s 48 --sampling unorm8 -q -o creature8.lut.exr
}

# browse PAGE[#hash] [OPTION...]: opens it; what happened becomes $seen.
browse() {
  command -v chromium >/dev/null || skip "no chromium: pages are not opened here"
  seen=$(node "$STYLUT_ROOT/tests/cli/browse.mjs" "$@" 2>browse.log) || { complain "$1: $(cat browse.log)"; return 1; }
  expect "$1 is ready" "$(json - r.ready <<<"$seen")" true
  expect "$1: errors" "$(json - r.errors <<<"$seen")" '[]'
  expect "$1: requests" "$(json - r.requests <<<"$seen")" '[]'
}

# value [EXPRESSION]: of what was evaluated in the page, called r.value.
value() { json - "${1:-r.value}" <<<"$seen"; }

# block PAGE ID: a block of JSON in the page.
# shellcheck disable=SC2016 # it is JavaScript
block() {
  node -e 'const [file, id] = process.argv.slice(1), text = require("fs").readFileSync(file, "utf8")
    console.log(text.match(new RegExp(`<script type="application/json" id="${id}">(.*?)</script>`, "s"))[1])' "$1" "$2"
}

@test "the page is one file with the audit in it" {
  bring 'sphere*'
  accept report sphere.lut.exr --guide sphere.exr -o r.html
  expect_match said "$output" '^Exact: every texel holds the nearest pixel'
  expect_holds page "$(head -c 300 r.html)" '<!DOCTYPE html>'
  expect 'what the page would load' "$(grep -cE '(src|href)="?(https?:|//|[a-z./]+\.)|url\(|@import' r.html)" 0
  expect 'parts left to fill' "$(grep -c '{{' r.html)" 0
  accept check sphere.lut.exr --guide sphere.exr --format json
  expect 'the audit' "$(block r.html audit | json - 'JSON.stringify(r)')" "$(json - 'JSON.stringify(r)' <<<"$output")"
  accept report sphere.lut.exr --guide sphere.exr -o r.html --format json
  expect facts "$(json - '[r.schema, r.output, r.judgement, r.headline].join()' <<<"$output")" \
    'stylut-report/1,r.html,good,Exact: every texel holds the nearest pixel.'
}

@test "the same bytes for the same input" {
  bring 'sphere*'
  accept report sphere.lut.exr --guide sphere.exr -o r.html -j 1
  mv r.html first.html
  accept report sphere.lut.exr --guide sphere.exr -o r.html -j 2
  expect_same first.html r.html
  expect 'hash and command' "$(grep -cE "$(sha256sum <sphere.exr | cut -c 1-64)|report --guide=sphere.exr sphere.lut.exr" r.html)" 2
  accept report sphere.lut.exr --guide sphere.exr -o r.html --no-history
  expect 'history' "$(grep -cE 'made with|SHA-256' r.html)" 0
}

@test "wrong calls" {
  bring 'sphere*'
  local right=(report sphere.lut.exr --guide sphere.exr -o out.html)
  swap 1 out.html out.png "${right[@]}"
  swap 2 out.html no/such/out.html "${right[@]}"
  swap 2 sphere.lut.exr missing.exr "${right[@]}"
  swap 2 sphere.exr missing.exr "${right[@]}"
  wait
  refuse 1 '--output' report sphere.lut.exr --guide sphere.exr
  refuse 1 '--guide' report sphere.lut.exr -o out.html
  refuse 1 '' report --guide sphere.exr -o out.html
  cp sphere.exr guide.html
  refuse 1 guide.html report sphere.lut.exr --guide guide.html -o ./guide.html
  accept "${right[@]}" --dry-run
  expect_holds said "$output" 'would write out.html'
  [ ! -e out.html ] || complain "out.html was written"
}

@test "a full disk leaves no page behind" {
  bring 'sphere*'
  small_disk 16k
  refuse 2 disk/out.html report sphere.lut.exr --guide sphere.exr -o disk/out.html
}

# The path as a whole is a script element, which no single name could hold.
@test "names do no harm" {
  local path=$'<script>document.body.dataset.ready=alert(1)<\b/script><img src=x onerror=alert(2)>"\'&amp;{{audit}}\xff.exr'
  mkdir "${path%%/*}"
  cp "$BATS_FILE_TMPDIR/sphere.exr" "$path"
  cp "$BATS_FILE_TMPDIR/sphere.lut.exr" "<!--.exr"
  accept report '<!--.exr' --guide "$path" -o 'r.html'
  expect 'script elements' "$(grep -oi '<script' r.html | wc -l)" 5
  expect 'images' "$(grep -ci '<img' r.html)" 0
  browse r.html --eval '[document.title, document.querySelector("header").textContent, document.scripts.length, document.images.length]'
  expect title "$(value 'r.value[0]')" '<!--.exr - stylut report'
  expect_holds header "$(value 'r.value[1]')" '<script>document.body.dataset.ready=alert(1)<?/script><img src=x onerror=alert(2)>"'\''&amp;{{audit}}?.exr'
  expect elements "$(value '[r.value[2], r.value[3]].join()')" 5,0
}

# read_at X Y: the page's values at a texel, as "source-x source-y error excess pieces spread jumps unstable".
read_out='(x, y) => { moveToTexel(x, y); return ["source", "error", "excess", "pieces", "spread", "jumps", "unstable"].map(id => document.getElementById("at-" + id).dataset.value).join().replaceAll(",", " ") }'

@test "the read-out is what the table and the audit hold" {
  bring 'sphere*'
  accept report sphere.lut.exr --guide sphere.exr -o r.html
  dump sphere.lut.exr u,v >table.txt
  local places='[[24, 24], [3, 17], [40, 9], [10, 37], [30, 44]]'
  browse r.html --eval "$places.map(p => p.join(' ') + ' ' + ($read_out)(...p))"
  value 'r.value.join("\n")' >read.txt
  # The sphere's normals are known: the error is the angle between that of the texel and that of the pixel it names.
  awk 'function z(x, y) { return sqrt(1 - x * x - y * y) }
    NR == FNR { u[$1, $2] = $3; v[$1, $2] = $4; next }
    { px = int(u[$1, $2] * 40); py = int(v[$1, $2] * 40)
      a = ($1 + 0.5) / 24 - 1; b = 1 - ($2 + 0.5) / 24; c = (px + 0.5) / 20 - 1; d = 1 - (py + 0.5) / 20
      chord = sqrt((a - c) ^ 2 + (b - d) ^ 2 + (z(a, b) - z(c, d)) ^ 2)
      error = 2 * atan2(chord / 2, sqrt(1 - chord * chord / 4)) * 45 / atan2(1, 1)
      if ($3 != px || $4 != py) print "texel " $1 " " $2 ": pixel " $3 " " $4 ", not " px " " py
      if ($5 - error > 2e-3 || error - $5 > 2e-3) print "texel " $1 " " $2 ": error " $5 ", not " error
      if ($6 != 0 || $7 != 1) print "texel " $1 " " $2 ": excess " $6 ", pieces " $7
      n++ } END { if (n != 5) print "read " n " texels" }' table.txt read.txt >wrong.txt
  expect 'what is wrong' "$(cat wrong.txt)" ''
  # The texel with the largest error, from the audit, holds it.
  browse r.html --eval "[($read_out)(...audit.assignment.at.texel), audit.assignment.max, ...audit.assignment.at.source]"
  expect 'worst source' "$(value 'r.value[0].split(" ").slice(0, 2).join()')" "$(value 'r.value.slice(2).join()')"
  expect_near 'worst error' "$(value 'r.value[0].split(" ")[2]')" "$(value 'r.value[1]')" 1e-3
}

# A table with a hole and a turned part, of an ambiguous guide: means over the maps are the audit's figures.
@test "the maps are the audit's" {
  bring 'creature8*'
  accept lut creature8.png -s 48 --sampling unorm8 -o t.png
  oiiotool t.png --fill:color=0,0,0 6x6+12+12 -o hole.png
  accept report hole.png --guide creature8.png -o r.html
  expect_match said "$output" '^Wrong in places: only 9[0-9]+ % of the texels hold the nearest pixel; 36 point at the background'
  browse r.html --eval '(() => {
    const { table } = state, cells = table.x.map((x, i) => i).filter(i => !Number.isNaN(table.x[i]))
    const mean = f => cells.reduce((sum, i) => sum + f(i), 0) / cells.length
    return [cells.length, mean(i => table.error[i]), mean(i => table.excess[i]), mean(i => table.spread[i]), mean(i => table.unstable[i]),
      mean(i => table.pieces[i] >= 2 || table.spread[i] > audit.jump), cells.filter(i => table.error[i] > 179.99).length]
      .map((found, k) => [found, [audit.feasible, audit.assignment.mean, audit.excess.mean, audit.spread, audit.unstable, audit.ambiguous, audit.background][k]])
  })()'
  expect_near 'figures from maps' "$(value 'r.value.map(v => v[0]).join(" ")')" "$(value 'r.value.map(v => v[1]).join(" ")')" 2e-3
  expect 'ambiguous at all' "$(value 'r.value[5][1] > 0.05')" true
  # And what is said of a hole is said where it is.
  browse 'r.html#texel=14,14&map=error' --eval '[document.getElementById("at-error").textContent, state.map.id, document.querySelector("[name=map]:checked").value]'
  expect 'in the hole' "$(value 'r.value.join()')" background,error,error
}

@test "the page: keys, choices and pointers" {
  bring 'sphere*'
  accept report sphere.lut.exr --guide sphere.exr -o r.html
  # shellcheck disable=SC2016 # it is JavaScript
  browse 'r.html#texel=20,20' --eval '(() => {
    const map = document.getElementById("table-map"), at = () => document.getElementById("at-texel").dataset.value, found = []
    const press = (key, shiftKey) => { map.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey, cancelable: true })); found.push(at()) }
    press("ArrowRight"); press("ArrowDown", true); press("ArrowUp"); press("ArrowLeft", true); press("ArrowLeft", true)
    for (const input of document.querySelectorAll("[name=map], [name=overlay]")) input.click()
    found.push(document.getElementById("map-name").textContent)
    const box = map.getBoundingClientRect()
    map.dispatchEvent(new PointerEvent("pointerdown", { clientX: box.left + box.width * 30.5 / 48, clientY: box.top + box.height * 10.5 / 48 }))
    found.push(at())
    return found.join("|")
  })()'
  expect 'what happened' "$(value)" '21,20|21,30|21,29|11,29|1,29|Unstable:|30,10'
  # Colour ramps get darker all the way.
  browse r.html --eval 'Object.values(ramps).every(ramp => ramp.every((c, i) => !i || getLuminance(c) <= getLuminance(ramp[i - 1])) && getLuminance(ramp[0]) - getLuminance(ramp[255]) > 0.8)'
  expect 'ramps fall' "$(value)" true
}

@test "tables that differ from their picture in size" {
  bring 'sphere*'
  accept lut sphere.exr -s 600 -o big.exr
  accept report big.exr --guide sphere.exr -o big.html
  browse 'big.html#texel=301,250' --eval '[state.table.step, state.table.width, document.getElementById("at-texel").dataset.value, document.getElementById("at-source").dataset.value,
    Math.abs(Math.max(...state.table.error.filter(v => v >= 0)) - audit.assignment.max) < 2e-3].join()'
  dump big.exr u,v | awk '$1 == 301 && $2 == 251 { print "2,300,301,251," int($3 * 40) "," int($4 * 40) ",true" }' >expected
  expect 'a cell of four' "$(value)" "$(cat expected)"
  accept lut sphere.exr -s 1 -o one.exr
  accept report one.exr --guide sphere.exr -o one.html
  browse one.html
  accept lut sphere.exr -s 33 --map equal-area -o area.exr
  accept report area.exr --guide sphere.exr -o area.html
  browse area.html --eval "[[16, 16], [3, 20], [28, 9]].every(p => findTexel(...getTexelValue(...p)).join() === p.join())"
  expect 'values and texels' "$(value)" true
}

@test "what can't be compressed is shown coarser" {
  oiiotool --create 512x512 3 --noise:type=uniform:min=0:max=1:mono=0:seed=5 --mulc 1,1,0 -d uint16 -o noise.png
  oiiotool --create 400x400 4 --noise:type=uniform:min=-0.99:max=0.99:mono=0:seed=3 \
    --chnames normal.X,normal.Y,normal.Z,A --mulc 1,1,1,0 --addc 0,0,0,1 -d float -o guide.exr
  accept_warned 'other lengths' report noise.png --as rg16 --guide guide.exr --precision 2 -o r.html
  expect_match said "$output" '^Wrong: hardly any texel holds the nearest pixel'
  expect_less 'size of the page' "$(stat -c %s r.html)" 3000000
  expect 'texels a cell' "$(block r.html table | json - r.step)" 2
}

# expect_advice TEXT: among what the last command said.
expect_advice() { expect_holds advice "$output" "$1"; }

@test "advice fits what was found" {
  bring 'sphere*' creature8.png
  accept lut sphere.exr -s 40 -o t.exr
  accept report t.exr --guide sphere.exr -o r.html
  expect 'lines about a good table' "$(wc -l <<<"$output")" 2
  grep -q 'Nothing to mend' r.html || complain 'the page has advice on a good table'
  # Half a sphere, before a frame that asks for the other half.
  oiiotool sphere.exr --fill:color=0,0,0,0,0 14x40 -o half.exr
  accept lut half.exr -s 40 -o half.lut.exr
  accept report half.lut.exr --guide half.exr -o r.html
  expect_advice 'no surface facing upper left, lower left, left. Name frames'
  accept report half.lut.exr --guide half.exr --frames sphere.exr -o r.html
  expect_match advice "$output" 'no surface facing upper left \(9\.4 %\), lower left \(9\.4 %\), left \(9\.3 %\): the frames ask for it in 28 % of their pixels'
  accept lut creature8.png -o c.exr
  accept report c.exr --guide creature8.png -o r.html
  expect_advice '--resolve coherent'
  # What rg8 loses of a large source, said before and after it is lost.
  accept guide sphere -s 700 -o large.exr
  accept lut large.exr -s 300 -o fine.exr
  accept report fine.exr --guide large.exr -o r.html
  expect_advice 'Keep 16 bits a coordinate'
  accept_warned "8 bits can't name each" lut large.exr -s 300 --encoding rg8 -o rg8.png
  accept report rg8.png --guide large.exr -o r.html
  expect_advice 'it went through rg8'
  accept lut large.exr -s 30 -o tiny.exr
  accept report tiny.exr --guide large.exr -o r.html
  expect_advice 'The table is small for its guide'
}

@test "painters' tables" {
  need_data unity-plugin/lut.png unity-plugin/s_normals.png
  accept_warned 'facing away' report "$data/unity-plugin/lut.png" --guide "$data/unity-plugin/s_normals.png" --as unity -o r.html
  expect_match said "$output" '^Wrong: only 36 % of the texels hold the nearest pixel; 307 point at the background'
  expect_holds said "$output" 'it went through rg8'
  browse r.html --eval '[state.table.step, document.getElementById("verdict").className].join()'
  expect page "$(value)" 2,bad
}
