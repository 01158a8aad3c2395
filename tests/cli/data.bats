#!/usr/bin/env bats
# Painters' files, where they are at hand: everything passes, with plausible figures.
load helpers

# stylize_all BUNDLE FRAME STYLE...: every covered pixel has a source. A few may
# stay clear: exemplars have a soft edge, and alpha is the exemplar's.
stylize_all() {
  local bundle=$1 frame=$2 style covered
  shift 2
  for style in "$@"; do
    accept stylize "$bundle" --guide "$frame" --style "$style" --nnf nnf.png -o out.png --format json -q || return 1
    covered=$(json - r.covered <<<"$output")
    fallback=$(json - r.fallback <<<"$output")
    expect_less "covered pixels of $frame" 1000 "$covered"
    expect "pixels in the field of $style on $frame" "$(count_above nnf.png A)" "$covered"
    expect_less "share of clear pixels of $style on $frame" "$(awk -v n="$(count_above out.png A)" -v c="$covered" 'BEGIN { print 1 - n / c }')" 0.005
  done
}
few_fallbacks() { expect_less 'share without a chunk' "$fallback" "${1:-0.1}"; }

# Pixels of a picture whose channel isn't 0.
count_above() { dump "$1" "$2" count; }

@test "the golem as a mesh" {
  need_data styleblit/golem.obj
  accept guide scene "$data/styleblit/golem.obj" -s 300x400 -c all --view three-quarter -o golem.exr --format json
  expect_less triangles 1000 "$(json - r.triangles <<<"$output")"
  expect_less 'least covered' 12000 "$(json - r.covered <<<"$output")"
  expect_less 'most covered' "$(json - r.covered <<<"$output")" 108000
  accept lut golem.exr -s 64 -o lut.exr
  accept check lut.exr --guide golem.exr --max-mean 10 --min-coverage 0.5
  accept pack "$exemplars/styles.json" -o bundle
  stylize_all bundle golem.exr pencil oil
  few_fallbacks
}

write_styles() { # FILE...
  local file separator=
  printf '{"schema": "stylut-bundle/1", "styles": ['
  for file in "$@"; do
    printf '%s{"name": "%s", "exemplar": "%s"%s}' "$separator" "$(basename "$file" .png)" "$file" "${guide:+, \"guide\": \"$guide\"}"
    separator=', '
  done
  printf ']}\n'
}

@test "painted spheres of 486 and 483 pixels" {
  local name files=()
  for name in 0 01c 05 10b 15; do files+=("$data/styleblit/$name.png"); done
  need_data styleblit/{0,01c,05,10b,15,new10,new11,new12}.png
  write_styles "${files[@]}" >large.json
  accept pack large.json --allow-outside -o large
  accept validate large
  files=()
  for name in new10 new11 new12; do files+=("$data/styleblit/$name.png"); done
  write_styles "${files[@]}" >small.json
  accept pack small.json --allow-outside -o small
  accept validate small
  accept guide scene "$exemplars/creature.ply" -s 300 -o frame.exr
  stylize_all large frame.exr 10b
  stylize_all small frame.exr new12
  few_fallbacks
  # Both sizes in one bundle are refused with both.
  write_styles "$data/styleblit/15.png" "$data/styleblit/new10.png" >mixed.json
  refuse 3 486x486 pack mixed.json --allow-outside -o mixed
  refuse 3 483x483 pack mixed.json --allow-outside -o mixed
}

@test "sources painted over a guide of their own" {
  need_data unity-plugin/{source_1,source_2,source_3,source_4,s_normals}.png frames/golem.001.png
  local unity=$data/unity-plugin guide=$data/unity-plugin/s_normals.png
  write_styles "$unity"/source_{1,2,3,4}.png >unity.json
  accept_warned 'facing away' pack unity.json --allow-outside -o bundle
  accept validate bundle
  accept lut "$guide" -s 256 --sampling unorm8 -o lut.exr --format json -q
  expect_less 'distinct values' 1000 "$(json - r.unique <<<"$output")"
  accept check lut.exr --guide "$guide" --max-mean 5 -q
  stylize_all bundle "$guide" source_1 source_4
  few_fallbacks
  # Their guide's z points away from the viewer, the golem's toward it: hardly
  # any chunk fits, but every pixel is served.
  stylize_all bundle "$data/frames/golem.001.png" source_1
  accept_warned 'found no piece of the exemplar that fits' stylize bundle --guide "$data/frames/golem.001.png" --style source_1 -o out.png
}

@test "frames of a turning golem" {
  need_data frames/golem.{001,045}.png styleblit/05.png
  write_styles "$data/styleblit/05.png" >manifest.json
  accept pack manifest.json --allow-outside -o bundle
  local frame
  for frame in 001 045; do beside serve_golem $frame; done
  accept lut "$data/frames/golem.001.png" -s 64 -o lut.png
  accept check lut.png --guide "$data/frames/golem.001.png" --max-mean 10
  wait
}
serve_golem() { stylize_all bundle "$data/frames/golem.$1.png" 1 && few_fallbacks; }
