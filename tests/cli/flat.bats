#!/usr/bin/env bats
# Flat surfaces: where they are, and scatter, which is for them.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  printf '{ "schema": "stylut-bundle/1", "styles": [
    { "name": "plain", "exemplar": "%s/spheres/oil.png" },
    { "name": "same", "exemplar": "%s/spheres/oil.png", "params": { "scatter": 0 } },
    { "name": "scattered", "exemplar": "%s/spheres/oil.png", "params": { "scatter": 12 } } ] }\n' \
    "$exemplars" "$exemplars" "$exemplars" >styles.json
  "$STYLUT" pack styles.json --allow-outside -o bundle -q
  # A wall on the left, a ball on the right.
  printf '{ "schema": "stylut-scene/1", "camera": { "type": "orthographic", "position": [0,0,9], "target": [0,0,0], "height": 4 },
    "objects": [ { "mesh": "%s/box/wall.obj", "transform": [2,0,0,-2, 0,2,0,0, 0,0,1,0, 0,0,0,1] } ],
    "spheres": [ { "center": [2,0,0], "radius": 1.5 } ] }\n' "$exemplars" >scene.json
  "$STYLUT" guide scene scene.json -s 384x192 -c normal,object -o guide.exr -q
}

@test "a mask of the flat areas" {
  bring bundle guide.exr
  accept stylize bundle --guide guide.exr -o out.png --flat flat.png
  # Windows of 64 pixels, every 32: the wall takes the left half, of which all is in windows.
  paste -d' ' <(dump flat.png Y 255) <(dump guide.exr object.I | cut -d' ' -f3) |
    awk '$3 != ($4 == 1 ? 255 : 0)' >wrong.txt
  expect 'pixels of the mask that are wrong' "$(head -n 1 wrong.txt)" ''
  expect 'pixels that are flat' "$(dump flat.png Y count)" $((192 * 192))
  refuse 1 flat.jpg stylize bundle --guide guide.exr -o out.png --flat flat.jpg
  refuse 1 out.png stylize bundle --guide guide.exr -o out.png --flat out.png
}

@test "scatter moves pieces on flat areas alone, and is off by default" {
  bring bundle guide.exr
  local style
  for style in plain same scattered; do
    accept stylize bundle --guide guide.exr --style $style -o $style.png --nnf $style.nnf.png --no-history
  done
  expect_same plain.png same.png
  expect_same plain.nnf.png same.nnf.png
  paste -d' ' <(dump guide.exr object.I) <(dump plain.nnf.png R,G | cut -d' ' -f3-) <(dump scattered.nnf.png R,G | cut -d' ' -f3-) |
    awk '{ if ($4 != $6 || $5 != $7) moved[$3 + 0]++ } END { print moved[1] + 0, moved[2] + 0 }' >moved.txt
  local wall ball
  read -r wall ball <moved.txt
  expect_less 'pixels of the wall that moved' 10000 "$wall"
  expect_less 'pixels of the ball that moved' "$ball" 1500
}

@test "wrong scatter" {
  local value
  for value in -1 65 1.5 '"12"'; do
    printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "a", "exemplar": "%s/spheres/oil.png", "params": { "scatter": %s } } ] }\n' \
      "$exemplars" "$value" >styles.json
    refuse 3 'params.scatter: found' pack styles.json -o bundle
  done
}
