#!/usr/bin/env bats
# stylut guide scene: the channels of light paths.
load helpers

# A grey floor and a glossy ball over it, lit by a lamp and by surroundings.
make_scene() {
  printf 'v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3 4\n' >floor.obj
  cat >scene.json <<'END_OF_SCENE'
{ "schema": "stylut-scene/1",
  "camera": { "type": "perspective", "position": [0, 1.5, 3], "target": [0, 0.3, 0], "fov": 40 },
  "objects": [ { "mesh": "floor.obj", "color": [0.8, 0.4, 0.2] } ],
  "spheres": [ { "center": [0, 0.5, 0], "radius": 0.5, "color": [0.5, 0.5, 0.5], "specular": 0.4, "shininess": 100 } ],
  "lights": [ { "type": "point", "position": [1, 2, 2], "intensity": 5 } ],
  "ambient": 0.2 }
END_OF_SCENE
}

rgb() { printf '%s.R,%s.G,%s.B' "$1" "$1" "$1"; }

@test "the five groups are asked for by name, or together as paths" {
  make_scene
  accept guide scene scene.json -s 16 -c paths --spp 4 -o paths.exr
  accept info paths.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" \
    A,LD12E.B,LD12E.G,LD12E.R,LDE.B,LDE.G,LDE.R,LIE.B,LIE.G,LIE.R,LSE.B,LSE.G,LSE.R,full.B,full.G,full.R
  local name
  for name in full LDE LSE LD12E LIE; do
    accept guide scene scene.json -s 16 -c $name --spp 4 -o one.exr
    expect "pixels of $name" "$(dump one.exr "A,$(rgb $name)")" "$(dump paths.exr "A,$(rgb $name)")"
  done
  accept guide scene scene.json -s 16 -c all -o all.exr
  accept info all.exr --format json
  expect 'channels of all' "$(json - 'r.channels.filter(c => /^L|full/.test(c.name)).length' <<<"$output")" 0
}

@test "what full holds, and what the parts do" {
  make_scene
  accept guide scene scene.json -s 24 -c paths --spp 16 -o paths.exr
  dump paths.exr "A,$(rgb full),$(rgb LDE),$(rgb LSE),$(rgb LD12E),$(rgb LIE)" | awk '
    $3 == 0 { for (c = 4; c <= NF; c++) if ($c != 0) bad = 1; missed++ }
    $3 == 1 {
      for (k = 4; k <= 6; k++) {
        rest = $k - $(k + 3) - $(k + 6) - $(k + 12)
        if (rest < -1e-5 || $(k + 9) < $(k + 3)) bad = 1
        if (rest > 0.01) mirrored++
        if ($(k + 6) > 0.05) glossy++
      }
      if ($16 > 0) bounced++
    }
    bad { print; exit }
    END { if (!bad && !(missed && mirrored && glossy && bounced)) print missed, mirrored, glossy, bounced }' >wrong.txt
  expect 'wrong pixel' "$(cat wrong.txt)" ''
}

@test "the same bytes on any number of threads; another seed, other noise" {
  make_scene
  accept guide scene scene.json -s 40x200 -c paths --spp 2 --no-history -j 1 -o one.exr
  accept guide scene scene.json -s 40x200 -c paths --spp 2 --no-history -j 4 -o four.exr
  accept guide scene scene.json -s 40x200 -c paths --spp 2 --no-history --seed 1 -o other.exr
  expect_same one.exr four.exr
  expect_other one.exr other.exr
  accept guide scene scene.json -s 8 -c full --no-history -o default.exr
  accept guide scene scene.json -s 8 -c full --no-history --spp 64 --seed 0 -o same.exr
  expect_same default.exr same.exr
}

@test "textures colour light, also by bounces" {
  printf 'v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n' >wall.obj
  oiiotool --pattern checker:width=4:height=4:color1=1,0,0:color2=0,0.5,1 16x16 3 -d uint8 -o tiles.png
  cat >tiles.json <<'END_OF_SCENE'
{ "schema": "stylut-scene/1",
  "camera": { "type": "orthographic", "position": [0, 0, 9], "target": [0, 0, 0], "height": 2 },
  "objects": [ { "mesh": "wall.obj", "texture": "tiles.png" } ],
  "lights": [ { "type": "directional", "direction": [0, 0, -1] } ], "ambient": 0 }
END_OF_SCENE
  accept guide scene tiles.json -s 16 -c paths,albedo --spp 1 --texture-filter nearest -o tiles.exr
  expect 'lit tiles' "$(dump tiles.exr "$(rgb LDE)")" "$(dump tiles.exr "$(rgb albedo)")"
  expect 'colours' "$(dump tiles.exr "$(rgb LDE)" | cut -d' ' -f3- | sort -u | wc -l)" 2
  sed 's/"texture": "tiles.png" }/"texture": "tiles.png" }, { "mesh": "wall.obj", "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0.5, 0,0,0,1] }/
    s/"position": \[0, 0, 9\]/"position": [0, 0, 0.3]/; s/"target": \[0, 0, 0\]/"target": [0, 0, 1]/
    s/"ambient": 0/"shadows": false, "ambient": 0/' tiles.json >lid.json
  accept guide scene lid.json -s 16 -c LIE,LDE --spp 256 -o lid.exr
  expect 'direct light' "$(dump lid.exr LDE.R | cut -d' ' -f3 | sort -u)" 0.000000000
  dump lid.exr "$(rgb LIE)" | awk '{ r += $3; g += $4; b += $5 } END { exit !(r > 1 && g > 0.1 * r && g < 0.4 * r && b > 0.9 * r && b < 1.1 * r) }' ||
    complain "bounced light isn't that of the tiles"
}

@test "a sphere in white surroundings" {
  accept guide sphere -s 8 -c paths -o sphere.exr
  expect 'middle' "$(dump sphere.exr full.R,LDE.G,LSE.B,LD12E.R,LIE.G | sed -n 's/^4 4 //p')" \
    '1.000000000 1.000000000 0.000000000 1.000000000 0.000000000'
}

@test "channels of light paths make a match" {
  make_scene
  accept guide scene scene.json -s 32 -c paths,normal --spp 4 -o source.exr
  accept guide scene scene.json -s 20 -c paths,normal --spp 4 -o target.exr
  accept match source.exr target.exr --channels full,LDE,LSE,LD12E,LIE -o field.exr
}

@test "what --spp refuses" {
  make_scene
  local wrong
  for wrong in 0 -1 65537 1.5 64x '' nan 99999999999999999999; do
    refuse 1 --spp guide scene scene.json -s 8 -c full --spp="$wrong" -o out.exr
  done
  refuse 1 'expected it with a channel of light paths' guide scene scene.json -s 8 -c normal --spp 4 -o out.exr
  refuse 1 "'--spp'" guide sphere -s 8 -c full --spp 4 -o out.exr
  refuse 1 'LIE, paths or all' guide scene scene.json -s 8 -c lde -o out.exr
  refuse 1 'holds normals only' guide scene scene.json -s 8 -c full -o out.png
}
