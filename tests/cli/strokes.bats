#!/usr/bin/env bats
# stylut guide strokes: a picture's colour, luminance, orientation and detail at every scale.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  # A ramp to the right, grey, 8 bit; a float picture with a hole; a painting.
  oiiotool --pattern fill:left=0,0,0:right=0.5,0.5,0.5 33x17 3 -d uint8 -o ramp.png
  oiiotool --pattern fill:topleft=0.1,0.2,0.3,1:topright=0.8,0.1,0.3,1:bottomleft=0.5,0.6,0.2,1:bottomright=0.2,0.2,0.9,0 20x13 4 \
    --chnames R,G,B,A -d float -o float.exr
  oiiotool --no-autopremult "$exemplars/spheres/oil.png" --cut 128x128+190+60 -o oil.png
}

@test "a ramp: orientation, detail, and no frame around it" {
  bring ramp.png
  accept guide strokes ramp.png --space srgb -c all -o g.exr
  dump g.exr A,orientation.X,orientation.Y,detail.Y,line.X,line.Y >pixels.txt
  expect pixels "$(wc -l <pixels.txt)" $((33 * 17))
  # Lighter to the right, so it is on the left of what runs down.
  expect 'wrong pixels' "$(awk '!($3 == 1 && $4 < 0.001 && $4 > -0.001 && $5 < -0.999 && $6 > 0.0115 && $6 < 0.0198 && $7 < -0.999)' pixels.txt | head -n 3)" ''
}

@test "channels are those asked for, at the picture's size" {
  bring oil.png float.exr
  accept guide strokes oil.png -o default.exr
  accept info default.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" \
    A,color.B,color.G,color.R,detail.Y,luma.Y,orientation.X,orientation.Y
  expect size "$(json - r.size <<<"$output")" '[128,128]'
  expect space "$(json - 'r.attributes["stylut:space"]' <<<"$output")" linear
  accept guide strokes float.exr -c line,luma --levels 3 -o some.exr
  accept info some.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" \
    A,line.0.X,line.0.Y,line.1.X,line.1.Y,line.2.X,line.2.Y,luma.0.Y,luma.1.Y,luma.2.Y
  accept guide strokes float.exr -c detail --levels all -o all.exr
  accept info all.exr --format json
  expect 'channels of all levels' "$(json - 'r.channels.length' <<<"$output")" 7
}

@test "one level is what all levels hold of it" {
  bring float.exr
  accept guide strokes float.exr --levels all -o all.exr
  local level
  for level in 0 2 5; do
    accept guide strokes float.exr --level $level -o one.exr
    dump one.exr A,color.R,luma.Y,orientation.X,detail.Y >one.txt
    dump all.exr A,color.$level.R,luma.$level.Y,orientation.$level.X,detail.$level.Y >all.txt
    expect_same one.txt all.txt
  done
}

@test "colours agree with another box filter" {
  bring oil.png
  oiiotool oil.png --ch R,G,B -d float -o opaque.exr
  accept guide strokes opaque.exr --level 4 -o g.exr
  oiiotool opaque.exr --resize:filter=box:highlightcomp=0 8x8 -o small.exr
  join -j 1 <(dump small.exr R,G,B | awk '{ print $1 * 16 + 8 "_" $2 * 16 + 3, $3, $4, $5 }' | sort) \
    <(dump g.exr color.R,color.G,color.B | awk '{ print $1 "_" $2, $3, $4, $5 }' | sort) >pairs.txt
  expect 'pixels compared' "$(wc -l <pairs.txt)" 64
  expect 'pixels that differ' "$(awk 'function far(a, b) { return a - b > 1e-5 || b - a > 1e-5 } far($2, $5) || far($3, $6) || far($4, $7)' pairs.txt | head -n 3)" ''
}

@test "the same bytes on any number of threads" {
  bring oil.png
  local options
  for options in '--levels 4 -c all' '--level 3 --upsample linear --space srgb'; do
    # shellcheck disable=SC2086
    accept guide strokes oil.png $options -j 1 -o one.exr --no-history
    # shellcheck disable=SC2086
    accept guide strokes oil.png $options -j 3 -o three.exr --no-history
    expect_same one.exr three.exr
  done
}

@test "match takes it for a guide, at all scales at once" {
  bring float.exr
  accept guide strokes float.exr -c color,line --levels 3 -o g.exr
  accept match g.exr g.exr --channels color,line:0.5 -o field.exr --format json
  expect channels "$(json - r.dims <<<"$output")" 15
  expect 'largest distance' "$(json - r.max_distance <<<"$output")" 0
}

@test "the report" {
  bring ramp.png float.exr
  accept guide strokes ramp.png -o g.exr --format json
  expect schema "$(json - r.schema <<<"$output")" stylut-guide-strokes/1
  expect levels "$(json - 'r.levels.map(l => l.size.join("x")).join()' <<<"$output")" 33x17,17x9,9x5,5x3,3x2,2x1,1x1
  expect 'without an orientation' "$(json - 'r.levels.map(l => l.without_orientation).join()' <<<"$output")" 0,0,0,0,0,0,1
  expect 'percentiles in order' "$(json - 'r.levels.every(l => l.detail.p50 <= l.detail.p90 && l.detail.p90 <= l.detail.p99 && l.detail.p99 <= l.detail.max)' <<<"$output")" true
  accept guide strokes ramp.png -o g.exr
  expect_match report "$output" '^g\.exr: 33x17, level 0 of scene-linear values
level '
  accept guide strokes ramp.png --levels 3 --space srgb -o g.exr
  expect_match levels "$output" '^g\.exr: 33x17, levels 0 to 2 of sRGB values'
  accept guide strokes ramp.png --level 2 -o g.exr --format json
  expect written "$(json - r.written <<<"$output")" '{"first":2,"last":2}'
  accept guide strokes ramp.png -o g.exr -q
  expect 'quiet report' "$output" ''
  rm g.exr
  accept guide strokes ramp.png -o g.exr --dry-run
  [ ! -e g.exr ] || complain 'a dry run wrote g.exr'
}

@test "history and help" {
  bring ramp.png
  accept guide strokes ramp.png --level 1 -o g.exr
  accept info g.exr --format json
  expect command "$(json - 'r.attributes["stylut:command"]' <<<"$output")" 'stylut guide strokes --level=1 ramp.png'
  expect input "$(json - 'r.attributes["stylut:input1"]' <<<"$output")" "$(sha256sum ramp.png | cut -d' ' -f1)"
  accept guide strokes --help
  expect_match help "$output" '^Usage: stylut guide strokes '
  local option
  for option in $(grep -oE -- '--[a-z-]+' <<<"$output" | sort -u); do
    [ "$option" != --help ] || continue
    said=$("$STYLUT" guide strokes "$option=" 2>&1 >/dev/null) || true
    [[ $said != *"expected an option that"* ]] || complain "$option: $said"
  done
}

@test "what is refused" {
  bring ramp.png float.exr
  swap 1 2 seven guide strokes ramp.png --level 2 -o out.exr
  swap 1 2 7 guide strokes ramp.png --level 2 -o out.exr
  swap 1 2 17 guide strokes ramp.png --level 2 -o out.exr
  swap 1 2 0 guide strokes ramp.png --levels 2 -o out.exr
  refuse 1 "0 to 6" guide strokes ramp.png --levels 8 -o out.exr
  swap 1 luma light guide strokes ramp.png -c luma -o out.exr
  swap 1 luma luma, guide strokes ramp.png -c luma -o out.exr
  swap 1 srgb xyz guide strokes ramp.png --space srgb -o out.exr
  swap 1 linear cubic guide strokes ramp.png --upsample linear -o out.exr
  swap 1 0.1 -1 guide strokes ramp.png --threshold 0.1 -o out.exr
  swap 1 0.1 nan guide strokes ramp.png --threshold 0.1 -o out.exr
  swap 1 out.exr out.png guide strokes ramp.png -o out.exr
  swap 2 out.exr none/out.exr guide strokes ramp.png -o out.exr
  swap 2 ramp.png none.png guide strokes ramp.png -o out.exr
  refuse 1 --level guide strokes ramp.png --level 1 --levels 2 -o out.exr
  refuse 1 argument guide strokes -o out.exr
  refuse 1 float.exr guide strokes ramp.png float.exr -o out.exr
  refuse 1 --output guide strokes ramp.png
  refuse 1 --output guide strokes float.exr -o float.exr
  refuse 1 --size guide strokes ramp.png -o out.exr --size 8
  refuse 3 full.R guide strokes float.exr --layer full -o out.exr
  printf 'text' >text.png
  refuse 3 text.png guide strokes text.png -o out.exr
  head -c 100 ramp.png >short.png
  refuse 3 short.png guide strokes short.png -o out.exr
  "$STYLUT" guide sphere -s 8 -q -o sphere.exr
  "$STYLUT" lut sphere.exr -s 8 -q -o lut.exr
  refuse 3 lut.exr guide strokes lut.exr -o out.exr
  refuse 3 sphere.exr guide strokes sphere.exr -o out.exr
  wait
}

@test "pixels that are no numbers, unless nothing is there" {
  node -e '
    const { writeFileSync } = require("fs"), w = 4, h = 3, names = ["A", "Y"]
    const text = s => Buffer.from(s + "\0", "latin1"), int = v => { const b = Buffer.alloc(4); b.writeInt32LE(v); return b }
    const float = v => { const b = Buffer.alloc(4); b.writeFloatLE(v); return b }
    const attribute = (n, t, ...d) => { const v = Buffer.concat(d); return Buffer.concat([text(n), text(t), int(v.length), v]) }
    const channel = n => Buffer.concat([text(n), int(2), int(0), int(1), int(1)])
    const write = (file, a, y) => {
      const box = Buffer.concat([int(0), int(0), int(w - 1), int(h - 1)])
      const head = Buffer.concat([int(20000630), int(2), attribute("channels", "chlist", ...names.map(channel), Buffer.alloc(1)),
        attribute("compression", "compression", Buffer.alloc(1)), attribute("dataWindow", "box2i", box),
        attribute("displayWindow", "box2i", box), attribute("lineOrder", "lineOrder", Buffer.alloc(1)),
        attribute("pixelAspectRatio", "float", float(1)), attribute("screenWindowCenter", "v2f", float(0), float(0)),
        attribute("screenWindowWidth", "float", float(1)), Buffer.alloc(1)])
      const line = 8 + 4 * w * names.length, offsets = [], rows = []
      for (let j = 0; j < h; j++) {
        const o = Buffer.alloc(8)
        o.writeBigUInt64LE(BigInt(head.length + 8 * h + line * j))
        offsets.push(o)
        rows.push(int(j), int(4 * w * names.length))
        for (const plane of [a, y]) for (let i = 0; i < w; i++) rows.push(float(plane(i, j)))
      }
      writeFileSync(file, Buffer.concat([head, ...offsets, ...rows]))
    }
    const at = (x, y, v, rest) => (i, j) => i === x && j === y ? v : rest
    write("good.exr", () => 1, () => 0.5)
    write("nan.exr", () => 1, at(2, 1, NaN, 0.5))
    write("inf.exr", () => 1, at(3, 2, Infinity, 0.5))
    write("hidden.exr", at(2, 1, 0, 1), at(2, 1, NaN, 0.5))
    write("empty.exr", () => 0, () => NaN)
    write("alpha.exr", at(0, 2, NaN, 1), () => 0.5)'
  accept guide strokes good.exr -o out.exr
  accept guide strokes hidden.exr -o out.exr
  expect 'values of the hidden pixel' "$(dump out.exr A,color.R,luma.Y,detail.Y | sed -n 's/^2 1 //p')" '0.000000000 0.000000000 0.000000000 0.000000000'
  accept_warned 'no covered pixel' guide strokes empty.exr -o out.exr
  rm out.exr
  refuse 3 '(2, 1)' guide strokes nan.exr -o out.exr
  refuse 3 '(3, 2)' guide strokes inf.exr -o out.exr
  refuse 3 '(0, 2)' guide strokes alpha.exr -o out.exr
}
