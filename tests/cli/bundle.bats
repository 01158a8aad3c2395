#!/usr/bin/env bats
# stylut pack, validate, info, stylize: bundles there and back.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT" pack "$exemplars/styles.json" -q -o five
  "$STYLUT" guide scene "$exemplars/creature.ply" --view three-quarter -s 150x120 -q -o frame.exr
  "$STYLUT" guide scene "$exemplars/creature.ply" --view three-quarter -s 150x120 -q -o frame8.png
  "$STYLUT" guide scene "$exemplars/creature.ply" --view three-quarter -s 150x120 --bits 16 -q -o frame16.png
  oiiotool --no-autopremult "$exemplars/spheres/oil.png" --ch R,G,B --resize 128x128 -d uint8 -o oil128.png
  oiiotool --no-autopremult "$exemplars/spheres/pencil.png" --resize 128x128 -d uint8 -o pencil128.png
  "$STYLUT" guide sphere -s 128 -q -o sphere128.exr
  "$STYLUT" guide sphere -s 128 -q -o sphere128.png
}

write_styles() { # 'NAME EXEMPLAR [JSON]'...
  local separator='' style name exemplar more
  printf '{"schema": "stylut-bundle/1", "styles": ['
  for style in "$@"; do
    read -r name exemplar more <<<"$style"
    printf '%s{"name": "%s", "exemplar": "%s"%s}' "$separator" "$name" "$exemplar" "${more:+, $more}"
    separator=', '
  done
  printf ']}\n'
}

same_bundles() {
  local file
  expect "files of $2" "$(ls "$2")" "$(ls "$1")"
  for file in "$1"/*; do expect_same "$file" "$2/${file##*/}"; done
}

@test "one style: packed, validated, looked into, used" {
  bring oil128.png frame.exr
  write_styles 'oil oil128.png' >one.json
  accept pack one.json -o bundle --format json
  expect report "$(json - '[r.schema, r.bundle, r.styles].join()' <<<"$output")" stylut-pack/1,bundle,1
  expect files "$(ls bundle | tr '\n' ' ')" 'bundle.json exemplars.ktx2 guides.ktx2 import-settings.json jitter.ktx2 luts.ktx2 params.ktx2 '
  accept validate bundle
  expect validate "$output" 'bundle: valid, 1 style(s)'
  accept validate bundle --format json
  expect validate "$(json - '[r.schema, r.valid, r.findings.length].join()' <<<"$output")" stylut-validate/1,true,0
  accept info bundle
  expect_holds info "$output" 'exemplars.ktx2  128x128, 1 layer(s)'
  expect_holds info "$output" "style 1 'oil': threshold 24, top_level 6, radius 1, depth_tolerance 0, luma_weight 0, colour_weight 0, jitter_amount 1, jitter_period 0, scale 1, objects false, scatter 0, unorm8 table"
  accept info bundle --format json
  expect index "$(json - '[r.schema, r.styles.length, r.styles[0].name, r.styles[0].size, r.styles[0].lut.size, r.styles[0].lut.sampling, r.jitter.seed].join()' <<<"$output")" \
    stylut-bundle-index/1,1,oil,128,128,256,unorm8,0
  expect 'hash of the exemplar' "$(json - 'r.history.inputs["oil128.png"]' <<<"$output")" "$(sha256sum oil128.png | cut -d' ' -f1)"
  local file
  for file in exemplars guides luts params jitter; do
    expect "hash of $file" "$(json bundle/bundle.json "r.files.find(f => f.name == '$file.ktx2').sha256")" "$(sha256sum bundle/$file.ktx2 | cut -d' ' -f1)"
    expect "bytes of $file" "$(json bundle/bundle.json "r.files.find(f => f.name == '$file.ktx2').bytes")" "$(stat -c %s bundle/$file.ktx2)"
    expect "identifier of $file" "$(head -c 12 bundle/$file.ktx2 | od -An -tx1 | tr -d ' \n')" ab4b5458203230bb0d0a1a0a
  done
  accept stylize bundle --guide frame.exr -o out.png --format json
  expect report "$(json - '[r.schema, r.size].join()' <<<"$output")" stylut-stylize/1,150,120
  expect covered "$(json - r.covered <<<"$output")" "$(dump frame.exr A | awk '$3 == 1' | wc -l)"
  expect times "$(json - 'Object.keys(r.time_ms).sort().join()' <<<"$output")" blend,load,read,transfer,write
  expect share "$(json - 'r.fallback >= 0 && r.fallback < 0.2' <<<"$output")" true
}

@test "five styles: by number, by name, each its own picture" {
  bring five frame.exr
  accept validate five
  local style number=0
  for style in pencil stipple watercolour oil charcoal; do
    number=$((number + 1))
    accept stylize five --guide frame.exr --style $style --no-history -o $style.png
    [[ $number = [24] ]] || continue
    accept stylize five --guide frame.exr --style $number --no-history -o number.png
    expect_same number.png $style.png
  done
  accept stylize five --guide frame.exr --no-history -o default.png
  expect_same default.png pencil.png
  expect 'distinct pictures' "$(sha256sum pencil.png stipple.png watercolour.png oil.png charcoal.png | cut -d' ' -f1 | sort -u | wc -l)" 5
}

@test "a frame's style.I channel chooses; ids beyond the bundle's stay empty" {
  bring five frame.exr
  # Left third style 1, middle style 4, right style 9: none.
  oiiotool --create 150x120 1 --fill:color=1 50x120 --fill:color=4 50x120+50+0 --fill:color=9 50x120+100+0 --chnames style.I -d float -o ids.exr
  oiiotool frame.exr ids.exr --chappend -o styled.exr
  accept_warned 'style.I the bundle has no style for, expected 1 to 5, or 0' stylize five --guide styled.exr -o mixed.png
  accept stylize five --guide frame.exr --style 1 -o one.png
  accept stylize five --guide frame.exr --style 4 -o four.png
  dump mixed.png R,G,B,A 255 >mixed.txt
  paste -d' ' mixed.txt <(dump one.png R,G,B,A 255) <(dump four.png R,G,B,A 255) >all.txt
  # Borders are left out: the blend stops there.
  expect 'style 1 at the left' "$(awk '$1 < 48 && ($3 != $9 || $4 != $10 || $5 != $11 || $6 != $12) { print; exit }' all.txt)" ''
  expect 'style 4 in the middle' "$(awk '$1 > 52 && $1 < 98 && ($3 != $15 || $4 != $16 || $5 != $17 || $6 != $18) { print; exit }' all.txt)" ''
  expect 'nothing at the right' "$(awk '$1 >= 100 && $6 != 0 { print; exit }' all.txt)" ''
  accept stylize five --guide styled.exr --style 4 --no-history -o chosen.png
  expect 'style 4 everywhere' "$(dump chosen.png R,G,B,A 255)" "$(dump four.png R,G,B,A 255)"
}

@test "256 styles of small exemplars" {
  local i styles=()
  accept guide sphere -s 8 -o plain.png
  for i in 1 2 3; do oiiotool --no-autopremult plain.png --addc 0.0$i,0,0,0 -d uint8 -o $i.png; done
  for ((i = 1; i <= 256; i++)); do styles+=("s$i $((i % 3 + 1)).png"); done
  write_styles "${styles[@]}" | sed 's/"exemplar"/"lut": {"size": 8}, "exemplar"/g' >many.json
  accept pack many.json -o many
  accept validate many
  expect validate "$output" 'many: valid, 256 style(s)'
  accept guide sphere -s 8 -o frame.exr
  for i in 1 255 256; do
    accept stylize many --guide frame.exr --style $i --no-history -o a.png
    accept stylize many --guide frame.exr --style s$i --no-history -o b.png
    expect_same a.png b.png
    expect "colours of style $i" "$(dump a.png R,G,B,A 255 | awk '$6 > 0')" "$(dump $((i % 3 + 1)).png R,G,B,A 255 | awk '$6 > 0')"
  done
  refuse 1 --style stylize many --guide frame.exr --style 257 -o c.png
}

@test "a table brought along: EXR and rg16 PNG give what pack builds itself" {
  bring pencil128.png sphere128.exr
  accept lut sphere128.exr -s 64 -o own.exr
  accept lut sphere128.exr -s 64 -o own.png
  accept lut sphere128.exr -s 64 --sampling unorm8 -o unorm8.exr
  write_styles 'p pencil128.png "lut": {"size": 64, "sampling": "centre"}' >built.json
  accept pack built.json -o built
  local lut
  for lut in '"own.exr"' '"own.png"' '{"file": "own.exr"}' '{"file": "own.png", "sampling": "centre"}'; do
    write_styles "p pencil128.png \"lut\": $lut" >own.json
    accept pack own.json -o own
    expect_same own/luts.ktx2 built/luts.ktx2
    expect_same own/params.ktx2 built/params.ktx2
  done
  write_styles 'p pencil128.png "lut": "unorm8.exr"' >own.json
  accept pack own.json -o own
  expect_other own/luts.ktx2 built/luts.ktx2
  accept info own
  expect_holds sampling "$output" 'unorm8 table'
  write_styles 'p pencil128.png "guide": "sphere128.exr", "lut": {"size": 64, "sampling": "centre"}' >guide.json
  accept pack guide.json -o guide
  expect_same guide/guides.ktx2 built/guides.ktx2
  expect_same guide/luts.ktx2 built/luts.ktx2
}

# The texels of a KTX2 file, which end it: the last COUNT bytes in decimal.
last_bytes() { tail -c "$2" "$1" | od -An -v -tu1 -w2 | sed 's/^ *//; s/  */ /g'; }

@test "a jitter table brought along, and seeds that change jitter only" {
  bring oil128.png
  oiiotool --create 256x256 3 --noise:type=uniform:min=0:max=1:seed=3 -d uint8 -o table.png
  write_styles 'oil oil128.png' >plain.json
  sed 's/^{/{"jitter": "table.png", /' plain.json >jitter.json
  accept pack jitter.json -o own
  expect 'bytes of the table' "$(last_bytes own/jitter.ktx2 131072)" "$(dump table.png R,G 255 | cut -d' ' -f3-)"
  local file
  accept pack plain.json -o zero --no-history
  accept pack plain.json --seed 0 -o also --no-history
  same_bundles zero also
  accept pack plain.json --seed 12345 -o other
  expect_other zero/jitter.ktx2 other/jitter.ktx2
  for file in exemplars guides luts params; do expect_same zero/$file.ktx2 other/$file.ktx2; done
  expect seed "$(json other/bundle.json r.jitter.seed)" 12345
  expect 'bytes of 255' "$(last_bytes zero/jitter.ktx2 131072 | tr ' ' '\n' | grep -cx 255)" 0
  accept pack jitter.json --seed 9 -o seeded
  expect_same own/jitter.ktx2 seeded/jitter.ktx2
}

@test "an older bundle is replaced, whole" {
  bring oil128.png pencil128.png
  write_styles 'oil oil128.png' >one.json
  write_styles 'oil oil128.png' 'pencil pencil128.png' >two.json
  accept pack two.json -o fresh --no-history
  accept pack one.json -o bundle
  accept pack two.json -o bundle --no-history
  same_bundles fresh bundle
  mkdir empty
  accept pack two.json -o empty/ --no-history
  same_bundles fresh empty
  expect 'folders' "$(find . -maxdepth 1 -type d | sort | tr '\n' ' ')" '. ./bundle ./empty ./fresh '
  accept pack two.json -o dry --dry-run
  [ ! -e dry ] || complain "--dry-run wrote a bundle"
  # From anywhere: paths are relative to the manifest.
  mkdir elsewhere
  cd elsewhere
  accept pack ../two.json -o bundle --no-history
  same_bundles ../fresh bundle
}

@test "pictures in 8 and 16 bits, the field and the chunks" {
  bring five frame.exr
  accept stylize five --guide frame.exr -o p8.png --nnf nnf.png --chunks chunks.png
  accept stylize five --guide frame.exr -o p16.png --bits 16
  accept info nnf.png --format json
  expect 'bits of the field' "$(json - r.bits <<<"$output")" 16
  accept info p16.png --format json
  expect 'bits of the picture' "$(json - r.bits <<<"$output")" 16
  accept info chunks.png --format json
  expect 'bits of the chunks' "$(json - r.bits <<<"$output")" 8
  dump frame.exr A | awk '{ print $3 == 1 }' >covered.txt
  paste -d' ' covered.txt <(dump p8.png R,G,B,A 255) <(dump p16.png R,G,B,A 65535) >pictures.txt
  expect '16 bits round to 8' "$(awk '{ for (k = 4; k <= 7; k++) { d = $(k + 6) / 257 - $k; if (d > 0.501 || d < -0.501) { print; exit } } }' pictures.txt)" ''
  expect 'pictures outside' "$(awk '!$1 && ($7 || $13 || $4 || $10) { print; exit }' pictures.txt)" ''
  paste -d' ' covered.txt <(dump nnf.png R,G,A 65535) <(dump chunks.png R,G,B,A 255) >fields.txt
  expect 'the field is where the frame is' "$(awk '($6 == 65535) != $1 || ($1 && ($4 > 511 || $5 > 511)) { print; exit }' fields.txt)" ''
  expect 'chunks are where the frame is' "$(awk '($12 > 0) != $1 { print; exit }' fields.txt)" ''
  # Right of a pixel of a chunk is what is right of it in the source, and what is
  # copied so has one colour.
  accept guide sphere -s 200 -c normal -o sphere.exr
  accept stylize five --guide sphere.exr -o p.png --nnf nnf.png --chunks chunks.png
  paste -d' ' <(dump nnf.png R,G,A 65535) <(dump chunks.png R,G,B,A 255) |
    awk '$5 { x[$1 " " $2] = $3; y[$1 " " $2] = $4; c[$1 " " $2] = $8 " " $9 " " $10 }
      END { for (k in x) { split(k, p, " "); q = p[1] - 1 " " p[2]; if (!(q in x)) continue
        n++; next_to = x[k] == x[q] + 1 && y[k] == y[q]; together += next_to; torn += c[k] == c[q] && !next_to }
        printf "%.3f %.3f\n", together / n, torn / n }' >shares.txt
  expect_less 'neighbours copied together' 0.4 "$(cut -d' ' -f1 shares.txt)"
  expect_less 'torn neighbours of one colour' "$(cut -d' ' -f2 shares.txt)" 0.02
}

@test "frames as EXR, 8- and 16-bit PNG: nearly the same picture" {
  bring five frame.exr frame8.png frame16.png
  accept stylize five --guide frame.exr -o exr.png
  accept stylize five --guide frame8.png -o p8.png
  accept stylize five --guide frame16.png -o p16.png
  local file
  for file in p8 p16; do
    paste -d' ' <(dump exr.png R,G,B,A 255) <(dump $file.png R,G,B,A 255) |
      awk '($6 > 0) != ($12 > 0) { lost++ } $6 { n++; d = $3 - $9; s += d < 0 ? -d : d } END { print lost + 0, (n > 0 && s / n < 12) }' >difference.txt
    expect "$file" "$(cat difference.txt)" '0 1'
  done
}

@test "coverage becomes alpha" {
  bring five frame8.png
  oiiotool --no-autopremult frame8.png --mulc 1,1,1,0.5 -d uint8 -o half.png
  accept stylize five --guide frame8.png --style oil -o whole_out.png
  accept stylize five --guide half.png --style oil -o half_out.png
  # x y A | x y R G B A | x y R G B A
  paste -d' ' <(dump half.png A 255) <(dump whole_out.png R,G,B,A 255) <(dump half_out.png R,G,B,A 255) >all.txt
  expect 'alpha' "$(awk '{ d = $9 * $3 / 255 - $15; if (d > 1 || d < -1) { print; exit } }' all.txt)" ''
  expect 'colour' "$(awk '$15 && ($6 != $12 || $7 != $13 || $8 != $14) { print; exit }' all.txt)" ''
}

# itself GUIDE EXEMPLAR BUNDLE: styled by its own guide, an exemplar is itself.
itself() {
  accept stylize "$3" --guide "$1" -o self.png || return 1
  paste -d' ' <(dump "$1" A) <(dump "$2" "${4:-R,G,B,A}" 255) <(dump self.png R,G,B,A 255) >self.txt
  expect "$3 by $1: covered pixels that differ" "$(awk '$3 > 0 && ($6 != $12 || $7 != $13 || $8 != $14 || (NF == 15 && $9 != $15))' self.txt | wc -l)" 0
  expect_less 'covered pixels' 1000 "$(awk '$3 > 0' self.txt | wc -l)"
}

@test "an exemplar styled by its own guide is itself: default settings, 128 pixels" {
  bring 'sphere128.*' pencil128.png
  write_styles 'pencil pencil128.png' >self.json
  accept pack self.json --allow-outside -o bundle
  beside itself sphere128.exr pencil128.png bundle
  beside itself sphere128.png pencil128.png bundle
  wait
}

@test "an exemplar styled by its own guide is itself: 512 pixels, a centre table of 512" {
  write_styles "oil $exemplars/spheres/oil.png \"lut\": {\"size\": 512, \"sampling\": \"centre\"}" >self.json
  accept pack self.json --allow-outside -o bundle
  accept guide sphere -o sphere.exr
  itself sphere.exr "$exemplars/spheres/oil.png" bundle
}

@test "the silhouette is the frame's" {
  bring 'frame*' oil128.png
  write_styles 'oil oil128.png' >oil.json
  accept pack oil.json --allow-outside -o bundle
  local frame
  for frame in frame.exr frame8.png frame16.png; do beside check_silhouette $frame; done
  wait
}
check_silhouette() { # FRAME
  accept stylize bundle --guide "$1" -o out.png
  expect "silhouette of $1" "$(dump out.png A 255)" "$(dump "$1" A 255)"
}

@test "parameters of the manifest rule the picture" {
  bring oil128.png frame.exr
  local params number=0
  for params in '{}' '{"threshold": 0}' '{"top_level": 0}' '{"radius": 0}' '{"radius": 8}' '{"threshold": 766, "top_level": 12}'; do
    number=$((number + 1))
    beside style_with "$params" $number
  done
  wait
  expect 'share without a chunk, threshold 0' "$(json 2.json r.fallback)" 1
  expect_less 'share without a chunk, any threshold' "$(json 6.json r.fallback)" 0.9
  # Chunks of one pixel are what remains without chunks.
  expect_same 2.png 3.png
  expect 'distinct pictures' "$(sha256sum [1-6].png | cut -d' ' -f1 | sort -u | wc -l)" 5
}

style_with() { # PARAMS NUMBER
  write_styles "oil oil128.png \"params\": $1" >p.json
  accept pack p.json --allow-outside -o bundle
  accept stylize bundle --guide frame.exr --no-history -o p.png --format json -q
  cp p.png "$BATS_TEST_TMPDIR/desk/$2.png"
  printf '%s' "$output" >"$BATS_TEST_TMPDIR/desk/$2.json"
}

@test "the example programs run on a bundle" {
  [ -x "$STYLUT_BUILD/use_runtime" ] || skip "no use_runtime in the build"
  bring oil128.png
  write_styles 'oil oil128.png' >oil.json
  accept pack oil.json --allow-outside -o bundle
  local program
  for program in use_runtime:256x256 animate_runtime:192x1536; do
    local size=${program#*:} bytes
    program=${program%:*} bytes=$((${size%x*} * ${size#*x} * 3))
    "$STYLUT_BUILD/$program" bundle >picture.ppm 2>said.txt || complain "$program: $(cat said.txt)"
    expect "$program: header" "$(head -n 1 picture.ppm)" "P6 ${size/x/ } 255"
    expect "$program: bytes" "$(tail -n +2 picture.ppm | wc -c)" "$bytes"
    expect_less "$program: colours" 1000 "$(tail -c "$bytes" picture.ppm | od -An -v -tx1 -w3 | sort -u | wc -l)"
    expect_refused_by "$program" missing
    cp -r bundle bad
    truncate -s 200 bad/luts.ktx2
    expect_refused_by "$program" bad
    rm -r bad
  done
  # Frames move on, and none is empty.
  local frame
  for frame in 0 1 2 3 4 5 6 7; do tail -c "$bytes" picture.ppm | tail -c +$((frame * 110592 + 1)) | head -c 110592 | sha256sum; done >frames.txt
  expect 'distinct frames' "$(sort -u frames.txt | wc -l)" 8
}

expect_refused_by() { # PROGRAM BUNDLE: one line, no crash
  local status=0
  "$STYLUT_BUILD/$1" "$2" >refused.ppm 2>said.txt || status=$?
  [[ $status != 0 && $status -lt 128 ]] || complain "$1 on bundle '$2': exit $status"
  expect "$1 on bundle '$2': lines said" "$(wc -l <said.txt)" 1
}

@test "holes in an exemplar's paint are never copied" {
  bring sphere128.exr pencil128.png
  # A window without paint, on the sphere; the rest stays.
  oiiotool --no-autopremult pencil128.png --fill:color=0,0,0,0 20x20+40+50 -d uint8 -o holed.png
  write_styles 'pencil holed.png' >holed.json
  accept pack holed.json --allow-outside -o bundle
  accept stylize bundle --guide sphere128.exr -o out.png
  expect 'covered pixels left open' "$(paste -d' ' <(dump sphere128.exr A) <(dump out.png A 255) | awk '$3 > 0 && $6 < 128' | wc -l)" 0
}
