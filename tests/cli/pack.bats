#!/usr/bin/env bats
# stylut pack with all that a manifest may say; params; unpack.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  local style
  for style in oil pencil; do
    oiiotool --no-autopremult "$exemplars/spheres/$style.png" --resize 96x96 -d uint8 -o $style.png
  done
  oiiotool --no-autopremult "$exemplars/spheres/charcoal.png" --resize 64x48 -d uint8 -o small.png
  "$STYLUT" guide sphere -s 96 --bits 8 -q -o sphere.png
  # One colour each, painted where the sphere is.
  oiiotool --no-autopremult sphere.png --mulc 0,0,0,1 --addc 0,0,1,0 -d uint8 -o blue.png
  oiiotool --no-autopremult sphere.png --mulc 0,0,0,1 --addc 1,0,0,0 -d uint8 -o red.png
  "$STYLUT" guide scene "$exemplars/lit/lit.json" -s 120x90 -c normal,luma,style,depth,object,albedo -q -o lit.exr
  printf '%s\n' '{"schema": "stylut-bundle/1", "styles": [
    {"name": "two.lights", "exemplars": [{"image": "blue.png", "luma": 0.2}, {"image": "red.png", "luma": 0.8}],
     "base": 2.5, "lut": {"size": 64, "engine": "brute", "resolve": "coherent", "slack": 1}, "params": {"radius": 3, "objects": true}},
    {"name": "a=b", "exemplar": "oil.png", "lut": {"size": 64, "sampling": "centre"},
     "params": {"threshold": 60, "depth_tolerance": 0.1, "colour_weight": 0.3, "jitter_amount": 0.7, "jitter_period": 2,
                "scale": 0.5, "scatter": 6}}]}' >all.json
}

first_style() { # MORE: a manifest of one style
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", %s}]}\n' "$1"
}

# texels FILE: all bytes of a texture's layers, as pack says where they are.
texels() {
  local bundle=${1%/*} name=${1##*/} offset
  offset=$(json "$bundle/import-settings.json" "r.textures['$name'].offset")
  tail -c +$((offset + 1)) "$1"
}

same_textures() {
  local name
  for name in exemplars guides luts params jitter; do expect_same "$1/$name.ktx2" "$2/$name.ktx2"; done
}

@test "light chooses among exemplars" {
  bring blue.png red.png lit.exr
  first_style '"exemplars": [{"image": "blue.png", "luma": 0.2}, {"image": "red.png", "luma": 0.8}], "params": {"radius": 0}' >m.json
  accept pack m.json -o bundle
  accept info bundle
  expect_holds info "$output" 'exemplars for luma 0.2, 0.8, threshold 24'
  expect_holds info "$output" 'exemplars.ktx2  96x96, 2 layer(s)'
  accept stylize bundle --guide lit.exr -o out.png --style 1
  # Light is luma less what the surface's colour takes of it.
  paste -d' ' <(dump lit.exr A,luma.Y,albedo.R,albedo.G,albedo.B) <(dump out.png R,G,B,A 255) |
    awk '{ albedo = 0.2126 * $5 + 0.7152 * $6 + 0.0722 * $7; if (albedo > 0) $4 /= albedo; print $1, $2, $3, $4, 0, 0, $10, $11, $12 }' >all.txt
  # A piece has the light of its seed: a few reach over the edges of shadows.
  expect_less 'dark pixels of another colour' "$(awk '$3 == 1 && $4 < 0.49 && $9 != 255' all.txt | wc -l)" 30
  expect_less 'bright pixels of another colour' "$(awk '$3 == 1 && $4 > 0.51 && $7 != 255' all.txt | wc -l)" 30
  expect_less 'dark pixels' 200 "$(awk '$3 == 1 && $4 < 0.49' all.txt | wc -l)"
  expect_less 'bright pixels' 200 "$(awk '$3 == 1 && $4 > 0.51' all.txt | wc -l)"
}

@test "what chooses among exemplars is light, not paint" {
  bring blue.png red.png
  first_style '"exemplars": [{"image": "blue.png", "luma": 0.2}, {"image": "red.png", "luma": 0.8}]' >m.json
  accept pack m.json -o bundle
  local colour
  for colour in '1, 1, 1' '0.2, 0.1, 0.1'; do
    printf '{"schema": "stylut-scene/1", "spheres": [{"center": [0, 0, 0], "radius": 1, "color": [%s]}]}\n' "$colour" >ball.json
    accept guide scene ball.json -s 64 -c normal,luma,albedo -o "$colour.exr"
    accept stylize bundle --guide "$colour.exr" --no-history -o "$colour.png"
  done
  expect_same '1, 1, 1.png' '0.2, 0.1, 0.1.png'
}

@test "exemplars that no sphere fits, or without paint" {
  bring small.png oil.png
  first_style '"exemplar": "small.png", "lut": {"size": 16}' >m.json
  accept_warned "style 'one': found an exemplar of 64x48 pixels, whose guide is an ellipse" pack m.json -o bundle
  oiiotool oil.png --mulc 1,1,1,0.4 -d uint8 -o faint.png
  first_style '"exemplar": "faint.png"' >m.json
  refuse 3 "style 'one': found no paint in exemplar faint.png, expected pixels that are at least half opaque" pack m.json -o bundle
  "$STYLUT" batch m.json -o bundles >/dev/null 2>said && complain 'batch packed what has no paint'
  expect_holds 'what batch says' "$(cat said)" "m, exemplars: style 'one': found no paint in exemplar"
}

@test "exemplars and lights that can't be are refused" {
  bring blue.png red.png small.png
  local image='{"image": "blue.png", "luma": 0.2}'
  first_style "\"exemplars\": [$image, {\"image\": \"small.png\", \"luma\": 0.8}]" >sizes.json
  refuse 3 'blue.png of 96x96 and small.png of 64x48' pack sizes.json -o bundle
  refuse 3 'blue.png of 96x96 and small.png of 64x48' pack sizes.json --fit pad -o bundle
  first_style "\"exemplars\": [$image, {\"image\": \"red.png\", \"luma\": 0.2}]" >twice.json
  refuse 3 'twice.json:1' pack twice.json -o bundle
  first_style "\"exemplars\": [{\"image\": \"blue.png\", \"luma\": 1.5}]" >beyond.json
  refuse 3 '1.5' pack beyond.json -o bundle
  first_style "\"exemplars\": [$image, $image, $image, $image, $image]" >five.json
  refuse 3 '1 to 4' pack five.json -o bundle
  first_style "\"exemplars\": [$image], \"exemplar\": \"blue.png\"" >both.json
  refuse 3 'either' pack both.json -o bundle
  first_style "\"exemplar\": \"blue.png\", \"base\": 0" >base.json
  refuse 3 'above 0' pack base.json -o bundle
}

@test "bases are low frequencies of the paint alone" {
  bring oil.png
  first_style '"exemplar": "oil.png", "base": 3' >m.json
  accept pack m.json -o bundle
  accept info bundle
  expect_holds info "$output" 'exemplars.ktx2  96x96, 2 layer(s)'
  expect_holds info "$output" 'bases of 3 pixels'
  texels bundle/exemplars.ktx2 | od -An -v -tu1 -w4 >all.txt
  texels bundle/guides.ktx2 | od -An -v -tu1 -w4 | paste all.txt - >with_guide.txt
  # By the definition: a Gaussian over painted pixels, weighed by alpha; here at 40 places of the sphere.
  awk -v n=96 '
    { r[NR - 1] = $1; a[NR - 1] = $8 ? $4 : 0 }
    END {
      for (k = 0; k < 40; k++) {
        x = (k * 37) % n; y = (k * 59) % n; i = y * n + x
        if (!a[i]) continue
        s = w = 0
        for (v = 0; v < n; v++) for (u = 0; u < n; u++) {
          d2 = (u - x) ^ 2 + (v - y) ^ 2; j = v * n + u
          if (!a[j] || (u - x) ^ 2 > 81 || (v - y) ^ 2 > 81) continue
          g = exp(-d2 / 18) * a[j]; s += g * r[j]; w += g
        }
        e = s / w - r[n * n + i]; if (e < 0) e = -e
        if (e > most) most = e
        seen++; differ += r[i] != r[n * n + i]
      }
      print seen, differ, most
    }' with_guide.txt >found.txt
  read -r seen differ most <found.txt
  expect_less 'places looked at' 15 "$seen"
  expect_less 'places where the base differs from the exemplar' 10 "$differ"
  expect_less 'error, levels' "$most" 1.1
  expect 'alpha of both' "$(head -n 9216 all.txt | awk '{ print $4 }' | cksum)" "$(tail -n 9216 all.txt | awk '{ print $4 }' | cksum)"
}

@test "a budget chooses the smallest table that meets it" {
  bring oil.png pencil.png sphere.png blue.png
  first_style '"exemplar": "oil.png", "lut": {"budget": {"p99": 5}}' >m.json
  accept pack m.json -o bundle
  local size
  size=$(json bundle/bundle.json r.styles[0].lut.size)
  expect_less 'size' 8 "$size"
  expect_less 'size' "$size" 1024
  first_style '"exemplar": "oil.png", "lut": {"budget": {"p99": 0.0001}}' >never.json
  refuse 6 "style 'one': budget: found p99" pack never.json -o never
  expect_less 'the error that the index tells' "$(json bundle/bundle.json r.styles[0].lut.error.p99)" 5.0001
  expect 'the budget in the index' "$(json bundle/bundle.json r.styles[0].lut.budget.p99)" 5
  first_style '"exemplar": "blue.png", "lut": {"budget": {"p99": 5}}' >blue.json
  accept pack blue.json -o blue
  "$STYLUT" guide sphere -s 96 -q -o guide.exr
  "$STYLUT" lut guide.exr -s "$(json blue/bundle.json r.styles[0].lut.size)" --sampling unorm8 -q -o lut.exr
  "$STYLUT" check lut.exr --guide guide.exr --format json >audit.json
  expect 'the same by audit' "$(json blue/bundle.json 'r.styles[0].lut.error.p99')" \
    "$(json audit.json '+r.lookup.p99.toPrecision(4)')"
  # The largest need rules; a size that someone insists on must suffice; who asks for nothing gets 256 at least.
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png", "lut": {"budget": {"p99": 5}}}, {"name": "two", "exemplar": "pencil.png", "lut": {"size": 8}}]}' >small.json
  refuse 3 "8 texels a side for style 'two', expected the $size that the budget of style 'one' takes" pack small.json -o small
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png", "lut": {"budget": {"p99": 5}}}, {"name": "two", "exemplar": "pencil.png", "lut": {"budget": {"p99": 9}}}]}' >both.json
  accept pack both.json -o both
  expect 'size for both' "$(json both/bundle.json 'r.styles.map(s => s.lut.size).join()')" "$size,$size"
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png", "lut": {"budget": {"p99": 5}}}, {"name": "two", "exemplar": "pencil.png"}]}' >free.json
  accept pack free.json -o free
  expect 'size for both' "$(json free/bundle.json 'r.styles.map(s => s.lut.size).join()')" "256,256"
}

@test "an enlargement beyond reason is refused at once" {
  oiiotool --create 3x200 4 --fill:color=1,1,0,1 3x200 -d uint8 -o thin.png
  oiiotool --create 4096x1 4 --fill:color=1,1,0,1 4096x1 -d uint8 -o flat.png
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "a", "exemplar": "thin.png"}, {"name": "b", "exemplar": "flat.png"}]}' >m.json
  refuse 3 'thin.png of 3x200 pixels for a bundle of 4096x200, expected at most 16 times' pack m.json -o bundle --fit resize
}

@test "what doesn't belong together is said: a guide of another picture, a table for what was erased" {
  bring oil.png pencil.png sphere.png
  oiiotool oil.png --resize 32x32 --create 96x96 4 --over -o corner.png
  first_style '"exemplar": "corner.png"' >corner.json
  accept_warned 'of what its guide covers without paint' pack corner.json -o corner
  first_style '"exemplar": "oil.png"' >m.json
  accept pack m.json -o bundle
  accept unpack bundle -o again
  oiiotool again/001-one.png --fill:color=0,0,0,0 30x30+33+33 -o again/001-one.png
  accept_warned 'where the exemplar has no paint' pack again/manifest.json -o holes
}

@test "a table that keeps neighbours together, and one for frames, are those of lut" {
  bring oil.png sphere.png lit.exr
  oiiotool --no-autopremult oil.png --ch R,G,B -d uint8 -o painted.png # all of it counts
  accept lut sphere.png -s 64 --sampling unorm8 --resolve coherent --slack 1.5 -o coherent.exr
  accept lut sphere.png -s 64 --sampling unorm8 --resolve frames --frames lit.exr -o frames.exr
  first_style '"exemplar": "painted.png", "guide": "sphere.png", "lut": {"size": 64, "resolve": "coherent", "slack": 1.5}' >m.json
  accept pack m.json -o built
  first_style '"exemplar": "painted.png", "guide": "sphere.png", "lut": "coherent.exr"' >m.json
  accept pack m.json -o brought
  same_textures built brought
  first_style '"exemplar": "painted.png", "guide": "sphere.png", "lut": {"size": 64, "resolve": "frames", "frames": "lit.exr"}' >m.json
  accept pack m.json -o built2
  first_style '"exemplar": "painted.png", "guide": "sphere.png", "lut": "frames.exr"' >m.json
  accept pack m.json -o brought2
  same_textures built2 brought2
  expect_other built/luts.ktx2 built2/luts.ktx2
}

@test "a scene as guide is that scene's guide, and its meshes are in the history" {
  oiiotool --create 80x60 3 --fill:color=0.5,0.2,0.7 80x60 -d uint8 -o flat.png
  cp -r "$exemplars/lit" "$exemplars/creature.ply" .
  accept guide scene lit/lit.json -s 80x60 --bits 8 -o guide.png
  first_style '"exemplar": "flat.png", "guide": "lit/lit.json", "lut": {"size": 64}' >scene.json
  first_style '"exemplar": "flat.png", "guide": "guide.png", "lut": {"size": 64}' >file.json
  accept pack scene.json -o scene
  accept pack file.json -o file
  expect_same scene/guides.ktx2 file/guides.ktx2
  expect 'hashes of meshes' "$(json scene/bundle.json 'Object.keys(r.history.inputs).filter(n => n.endsWith(".obj")).length > 0')" true
}

@test "--fit: sizes that differ are refused, padded or filtered" {
  bring oil.png small.png sphere.png
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png"}, {"name": "two", "exemplar": "small.png"}]}' >m.json
  refuse 3 'oil.png of 96x96 and small.png of 64x48' pack m.json -o bundle
  accept_warned "style 'two': found an exemplar of 64x48 pixels, whose guide is an ellipse" pack m.json --fit pad -o padded
  accept validate padded
  expect 'true sizes' "$(json padded/bundle.json 'r.styles.map(s => s.size.join("x")).join()')" 96x96,64x48
  texels padded/exemplars.ktx2 | od -An -v -tu1 -w4 | sed 's/^ *//; s/  */ /g' | tail -n 9216 >two.txt
  expect 'its pixels at the upper left' "$(awk '{ x = (NR - 1) % 96; y = int((NR - 1) / 96); if (x < 64 && y < 48) print x, y, $0 }' two.txt)" "$(dump small.png R,G,B,A 255)"
  expect 'the rest' "$(awk '{ x = (NR - 1) % 96; y = int((NR - 1) / 96); if (!(x < 64 && y < 48)) print }' two.txt | sort -u)" '0 0 0 0'
  texels padded/guides.ktx2 | od -An -v -tu1 -w4 | tail -n 9216 | awk '{ x = (NR - 1) % 96; y = int((NR - 1) / 96); if ($4 && !(x < 64 && y < 48)) print }' >covered.txt
  expect 'guide beside it' "$(cat covered.txt)" ''
  accept_warned "style 'two': found an exemplar of 64x48 pixels, whose guide is an ellipse" pack m.json --fit resize -o resized
  accept validate resized
  # Enlarged by the same filter elsewhere, with alpha multiplied in.
  oiiotool small.png --resize 96x96 -d uint8 -o larger.png
  texels resized/exemplars.ktx2 | od -An -v -tu1 -w4 | sed 's/^ *//; s/  */ /g' | tail -n 9216 |
    paste -d' ' - <(dump larger.png R,G,B,A 255) | awk '$4 == 255 { n++; for (k = 1; k <= 3; k++) { d = $k - $(k + 6); if (d > 2 || d < -2) bad++ } } END { print (n > 2000), bad + 0 }' >found.txt
  expect 'filtered' "$(cat found.txt)" '1 0'
  # A guide that is a file is never filtered: no value that wasn't there.
  accept guide sphere -s 64x48 --bits 8 -o small_guide.png
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png"}, {"name": "two", "exemplar": "small.png", "guide": "small_guide.png"}]}' >file.json
  accept pack file.json --fit resize -o file
  texels file/guides.ktx2 | od -An -v -tu1 -w4 | sed 's/^ *//; s/  */ /g' | tail -n 9216 | awk '$4' | sort -u >used.txt
  dump small_guide.png R,G,B,A 255 | cut -d' ' -f3- | sort -u >there.txt
  expect 'values of no pixel' "$(comm -23 used.txt there.txt)" ''
  expect_less 'values' 500 "$(wc -l <used.txt)"
}

@test "a table brought along is fitted with its exemplar" {
  bring oil.png small.png
  accept guide sphere -s 64x48 -o small.exr
  accept lut small.exr -s 64 --sampling unorm8 -o small_lut.exr
  local how
  for how in pad resize; do
    printf '{"schema": "stylut-bundle/1", "styles": [{"name": "one", "exemplar": "oil.png", "lut": {"size": 64}}, {"name": "two", "exemplar": "small.png", "guide": "small.exr", "lut": "small_lut.exr"}]}' >m.json
    accept pack m.json --fit $how -o $how
    accept validate $how --format json
    expect "$how: findings" "$(json - r.findings.length <<<"$output")" 0
    # Each texel's pixel answers nearly as its value asks.
    accept unpack $how -o $how.files
    accept check $how.files/002-two.lut.png --guide $how.files/002-two.guide.png --max-mean 6
  done
}

@test "jitter: several tables, white and blue" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o one --no-history
  accept pack m.json --jitter-frames 1 --jitter-noise white -o same --no-history
  same_textures one same
  accept pack m.json --jitter-frames 3 -o three
  texels one/jitter.ktx2 >one.bin
  texels three/jitter.ktx2 | head -c 131072 >first.bin
  expect_same one.bin first.bin
  texels three/jitter.ktx2 | split -b 131072 - table.
  expect 'distinct tables' "$(sha256sum table.a? | cut -d' ' -f1 | sort -u | wc -l)" 3
  accept pack m.json --jitter-frames 2 --jitter-noise blue -j 1 -o blue1 --no-history
  accept pack m.json --jitter-frames 2 --jitter-noise blue -j 2 -o blue --no-history
  expect_same blue1/jitter.ktx2 blue/jitter.ktx2
  expect index "$(json blue/bundle.json '[r.jitter.tables, r.jitter.noise, r.jitter.seed].join()')" 2,blue,0
  # Blue: neighbours differ by more than they would by chance, which is 255/3.
  local kind mean
  for kind in three blue; do
    mean[${#mean[@]}]=$(texels $kind/jitter.ktx2 | tail -c 131072 | od -An -v -tu1 -w2 | awk '{ if (NR % 256 != 1) { d = $1 - p; s += d < 0 ? -d : d; n++ } p = $1 } END { print s / n }')
  done
  expect_less 'white neighbours' "${mean[0]}" 87
  expect_less 'blue neighbours' 95 "${mean[1]}"
  expect 'each byte of blue as often' "$(texels blue/jitter.ktx2 | head -c 131072 | od -An -v -tu1 -w2 | awk '{ print $2 }' | sort -n | uniq -c | awk '{ print ($1 == 257 || $1 == 258 || $1 == 256) }' | sort -u)" 1
  oiiotool --create 256x256 3 --noise:type=uniform:min=0:max=1:seed=3 -d uint8 -o a.png
  oiiotool --create 256x256 3 --noise:type=uniform:min=0:max=1:seed=4 -d uint8 -o b.png
  sed 's/^{/{"jitter": ["a.png", "b.png"], /' m.json >list.json
  accept pack list.json -o list
  expect 'both pictures' "$(texels list/jitter.ktx2 | od -An -v -tu1 -w2 | sed 's/^ *//; s/  */ /g' | cksum)" "$( (dump a.png R,G 255 && dump b.png R,G 255) | cut -d' ' -f3- | cksum)"
  refuse 1 --jitter-frames pack list.json --jitter-frames 2 -o bundle
  refuse 1 --jitter-noise pack list.json --jitter-noise blue -o bundle
  refuse 1 '0' pack m.json --jitter-frames 0 -o bundle
  refuse 1 '257' pack m.json --jitter-frames 257 -o bundle
  refuse 1 'white, blue' pack m.json --jitter-noise pink -o bundle
}

@test "params: printed, changed in place, the rest untouched" {
  bring blue.png red.png oil.png all.json lit.exr
  accept pack all.json --jitter-frames 2 -o bundle
  cp -r bundle before
  accept params bundle
  expect_holds params "$output" "1 'two.lights': threshold 24, top_level 6, radius 3"
  expect_holds params "$output" 'objects true'
  expect_same bundle/bundle.json before/bundle.json
  accept params bundle --set two.lights.threshold=30 --set a=b.scale=2 --set radius=2 --set 2.objects=true --format json
  expect report "$(json - '[r.schema, r.styles[0].params.threshold, r.styles[1].params.scale, r.styles[0].params.radius, r.styles[1].params.radius, r.styles[1].params.objects].join()' <<<"$output")" \
    stylut-params/1,30,2,2,2,true
  accept validate bundle
  expect index "$(json bundle/bundle.json '[r.styles[0].params.threshold, r.styles[1].params.scale, r.history.edits.length].join()')" 30,2,1
  expect_holds history "$(json bundle/bundle.json 'r.history.edits[0]')" 'stylut params --set=two.lights.threshold=30'
  local name
  for name in exemplars guides luts jitter; do expect_same bundle/$name.ktx2 before/$name.ktx2; done
  # As if they had been packed.
  sed 's/"radius": 3/"radius": 2, "threshold": 30/; s/"threshold": 60/"threshold": 60, "radius": 2, "objects": true/; s/"scale": 0.5/"scale": 2/' all.json >edited.json
  accept pack edited.json --jitter-frames 2 -o packed
  same_textures packed bundle
  # stylize --set is the same for one picture.
  accept stylize bundle --guide lit.exr --style 2 --no-history -o edited.png
  accept stylize before --guide lit.exr --style 2 --no-history -o set.png --set two.lights.threshold=30 --set a=b.scale=2 --set radius=2 --set 2.objects=true
  accept stylize before --guide lit.exr --style 2 --no-history -o unset.png
  expect_same edited.png set.png
  expect_other edited.png unset.png
  expect 'folders' "$(find . -maxdepth 1 -type d -name '.*' ! -name . | wc -l)" 0
  # Who may read it stays as it was.
  chmod 750 bundle
  chmod 640 bundle/*
  accept params bundle --set threshold=76
  expect modes "$(stat -c %a bundle bundle/* | sort -u | tr '\n' ' ')" '640 750 '
  refuse 1 'depth_tolerance=1e-50' params bundle --set depth_tolerance=1e-50
  ln -s bundle link
  accept params link/ --set threshold=77
  accept params bundle
  expect_holds 'through a link' "$output" "1 'two.lights': threshold 77"
  [ -L link ] || complain 'the link is gone'
}

@test "params that can't be are refused, and nothing changes" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o bundle
  refuse 1 "parameter 'treshold', expected one of threshold, top_level" params bundle --set one.treshold=3
  refuse 1 'threshold=767, expected a whole number from 0 to 766' params bundle --set threshold=767
  refuse 1 'threshold=2.5, expected a whole number' params bundle --set threshold=2.5
  refuse 1 'scale=3, expected 0.5, 1 or 2' params bundle --set one.scale=3
  refuse 1 'objects=maybe, expected true or false' params bundle --set objects=maybe
  refuse 1 'colour_weight=nan' params bundle --set colour_weight=nan
  refuse 1 "'two', expected a style's name ('one') or a number from 1 to 1" params bundle --set two.radius=1
  refuse 1 "'radius', expected KEY=VALUE" params bundle --set radius
  refuse 1 "parameter 'layer'" params bundle --set layer=0
  refuse 1 "parameter 'layer'" stylize bundle --guide oil.png -o out.png --set layer=0
  # The second is wrong: the first isn't done either.
  refuse 1 'radius=9' params bundle --set threshold=3 --set radius=9
  refuse 2 'missing' params missing --set radius=1
  accept params bundle --set threshold=3 --dry-run
  accept params bundle
  expect_holds params "$output" 'threshold 24'
}

@test "a manifest's files are in its folder, unless others are allowed" {
  bring oil.png
  local outside=$PWD/outside project=$PWD/project
  mkdir -p outside/parts project/in/deep
  cp oil.png outside
  cp oil.png project/in
  printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n' | tee outside/parts/a.obj >project/in/a.obj
  ln -s ../../outside/oil.png project/in/link.png
  ln -s ../../outside project/in/folder
  ln -s oil.png project/in/near.png
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": "../../outside/parts/a.obj"}]}' >project/in/far.json
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": "../in/a.obj"}]}' >project/in/near.json
  cd project || return 1
  local name rest='"lut": {"size": 16}'
  for name in ../outside/oil.png "$outside/oil.png" in/link.png in/folder/oil.png in/../../outside/oil.png; do
    first_style "\"exemplar\": \"$name\", $rest" >m.json
    refuse 3 "which is outside of the manifest's folder, expected a file inside, or --allow-outside" pack m.json -o bundle
    refuse 3 "m.json: style 'one': found '" pack m.json -o bundle --dry-run
    "$STYLUT" batch m.json -o bundles -q 2>said && complain "batch took $name"
    expect_holds "batch of $name" "$(cat said)" "outside of the manifest's folder"
    accept pack m.json --allow-outside -o ../allowed
  done
  first_style "\"exemplar\": \"in/oil.png\", \"guide\": \"in/far.json\", $rest" >m.json
  refuse 3 "far.json: found './in/../../outside/parts/a.obj', which is outside" pack m.json -o bundle
  echo 'no mesh' >../outside/parts/a.obj # it isn't even read
  refuse 3 "far.json: found './in/../../outside/parts/a.obj', which is outside" pack m.json -o bundle
  "$STYLUT" batch m.json -o bundles -q 2>said && complain 'batch took a mesh from outside'
  expect_holds 'batch of a scene' "$(cat said)" "outside of the manifest's folder"
  expect 'without a bundle' "$(ls bundles)" ''
  for name in '"lut": {"file": "../outside/oil.png"}' '"lut": {"size": 16, "resolve": "frames", "frames": "../outside/oil.png"}' \
    '"guide": "../outside/oil.png"'; do
    first_style "\"exemplar\": \"in/oil.png\", $name" >m.json
    refuse 3 "found './../outside/oil.png', which is outside" pack m.json -o bundle
  done
  printf '{"schema": "stylut-bundle/1", "styles": [{"glob": "../outside/*.png", %s}]}' "$rest" >m.json
  refuse 3 'outside/oil.png' pack m.json -o bundle
  printf '{"schema": "stylut-bundle/1", "jitter": "../outside/oil.png", "styles": [{"name": "one", "exemplar": "in/oil.png", %s}]}' "$rest" >m.json
  refuse 3 'outside/oil.png' pack m.json -o bundle
  for name in in/near.png in/deep/../oil.png "$project/in/oil.png"; do
    first_style "\"exemplar\": \"$name\", $rest" >m.json
    accept pack m.json -o bundle
  done
  first_style "\"exemplar\": \"in/oil.png\", \"guide\": \"in/near.json\", $rest" >m.json
  accept pack m.json -o bundle
}

@test "files of others in a bundle's folder stay" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o bundle
  echo guid >bundle/luts.ktx2.meta
  touch bundle/.DS_Store
  chmod 640 bundle/luts.ktx2.meta
  local files
  files=$(ls -A bundle)
  accept params bundle --set radius=3
  expect 'after params' "$(ls -A bundle)" "$files"
  accept pack m.json -o bundle
  expect 'after pack' "$(ls -A bundle)" "$files"
  expect 'what it says' "$(cat bundle/luts.ktx2.meta) $(stat -c %a bundle/luts.ktx2.meta)" 'guid 640'
  accept stylize bundle --guide "$BATS_FILE_TMPDIR/sphere.png" -o bundle/out.png
  accept params bundle --set radius=3
  expect 'beside the bundle' "$(find . -maxdepth 1 -type d | sort | tr '\n' ' ')" '. ./bundle '
}

# as_nobody COMMAND...: without root's rights.
as_nobody() {
  if [ "$(id -u)" = 0 ]; then setpriv --reuid 65534 --regid 65534 --clear-groups "$@"; else "$@"; fi
}

@test "a bundle that others own, or that is kept from writing" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o bundle
  local open
  open=$(mktemp -d)
  chmod 777 "$open"
  cp -r bundle "$open/kept"
  cp -r bundle "$open/theirs"
  chmod 555 "$open/kept"
  chmod -R 777 "$open/theirs"
  cd "$open" || return 1
  as_nobody "$STYLUT" --version >/dev/null || skip 'nobody may start the tool here'
  local told code=0
  told=$(as_nobody "$STYLUT" params kept --set radius=2 2>&1) || code=$?
  expect 'kept from writing' "$code ${told#*kept: }" '2 cannot write: Permission denied; expected a folder that can be written to'
  code=0
  told=$(as_nobody "$STYLUT" params kept --set radius=2 --dry-run 2>&1) || code=$?
  expect 'foretold' "$code ${told#*kept: }" '2 cannot write: Permission denied; expected a folder that can be written to'
  code=0
  told=$(as_nobody "$STYLUT" params theirs -q --set radius=2 2>&1) || code=$?
  expect 'theirs' "$code $told" '0 '
  expect_holds 'as set' "$(as_nobody "$STYLUT" params theirs)" 'radius 2'
  # The group that new files have may do what anybody may, if nothing more.
  expect 'rights' "$(stat -c %a theirs theirs/bundle.json | tr '\n' ' ')" '777 777 '
  expect 'folders' "$(ls "$open" | tr '\n' ' ')" 'kept theirs '
  cd / && chmod 755 "$open/kept" && rm -r "$open"
}

@test "params while someone reads: all old or all new" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o bundle --no-history
  (for i in $(seq 1 40); do "$STYLUT" params bundle -q --set threshold=$i --set radius=$((i % 9)) || echo bad; done) >writer.txt 2>&1 &
  local bad=0
  for i in $(seq 1 40); do "$STYLUT" validate bundle >/dev/null 2>&1 || bad=$((bad + 1)); done
  wait
  expect writer "$(cat writer.txt)" ''
  # A reader may find the folder between two of its files; it says so, and never takes a half-changed one.
  accept validate bundle
  expect_holds params "$("$STYLUT" params bundle)" 'threshold 40, top_level 6, radius 4'
  expect_less 'readers that met a change' "$bad" 40
}

@test "unpack: pictures and a manifest that packs to the same bytes" {
  bring blue.png red.png oil.png all.json
  accept pack all.json --jitter-frames 2 --jitter-noise blue -o bundle
  accept unpack bundle -o files/
  expect files "$(ls files | tr '\n' ' ')" '001-two_lights.1.png 001-two_lights.2.png 001-two_lights.guide.png 001-two_lights.lut.png 002-a_b.guide.png 002-a_b.lut.png 002-a_b.png jitter.001.png jitter.002.png manifest.json '
  accept pack files/manifest.json -o again
  same_textures bundle again
  expect 'params of both' "$(json again/bundle.json 'JSON.stringify(r.styles.map(s => [s.name, s.params, s.base]))')" "$(json bundle/bundle.json 'JSON.stringify(r.styles.map(s => [s.name, s.params, s.base]))')"
  expect 'the exemplar itself' "$(dump files/002-a_b.png R,G,B,A 255)" "$(dump oil.png R,G,B,A 255)"
  # Tables are tables: audited as any.
  accept check files/002-a_b.lut.png --guide files/002-a_b.guide.png --max-mean 3
  mkdir empty
  accept unpack bundle -o empty/
  expect 'in an empty folder' "$(ls empty)" "$(ls files)"
  refuse 2 'expected a new name or an empty folder' unpack bundle -o files
  refuse 2 'missing' unpack missing -o new
  refuse 1 output unpack bundle
  accept unpack bundle -o new --dry-run
  [ ! -e new ] || complain '--dry-run wrote'
}

@test "import settings are vouched for, and say where the texels are" {
  bring oil.png
  first_style '"exemplar": "oil.png", "lut": {"size": 16}' >m.json
  accept pack m.json -o bundle
  local file=bundle/import-settings.json engine
  expect 'its hash' "$(json bundle/bundle.json r.import_settings.sha256)" "$(sha256sum $file | cut -d' ' -f1)"
  for engine in unity unreal godot; do
    expect "$engine" "$(json $file "Object.keys(r.$engine).sort().join()")" exemplars.ktx2,guides.ktx2,jitter.ktx2,luts.ktx2,params.ktx2
  done
  expect 'no conversion' "$(json $file 'Object.values(r.unity).every(t => !t.sRGBTexture && !t.mipmapEnabled && t.filterMode == "Point")')" true
  expect 'texels' "$(json $file 'Object.entries(r.textures).map(([n, t]) => t.offset + t.layers * t.layer_bytes).join()')" \
    "$(stat -c %s bundle/exemplars.ktx2 bundle/guides.ktx2 bundle/luts.ktx2 bundle/params.ktx2 bundle/jitter.ktx2 | paste -sd,)"
  sed -i 's/Point/Other/' $file
  refuse 3 '' validate bundle
  expect_holds validate "$("$STYLUT" validate bundle 2>/dev/null || true)" 'B4 error: import-settings.json'
  rm $file
  refuse 2 '' validate bundle
}
