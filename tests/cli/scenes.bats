#!/usr/bin/env bats
# stylut guide scene: scenes at the limits of what can be seen, and beyond.
load helpers

write_cube() { # [SIZE [X]]
  awk -v s="${1:-1}" -v at="${2:-0}" 'BEGIN {
    for (v = 0; v < 8; v++) printf "v %.9g %.9g %.9g\n", at + (v % 2 * 2 - 1) * s, (int(v / 2) % 2 * 2 - 1) * s, (int(v / 4) * 2 - 1) * s
    print "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 2 4 8 6\nf 1 5 7 3" }'
}

# write_scene REST: the head of a scene file, and what follows.
write_scene() { printf '{ "schema": "stylut-scene/1", %s }\n' "$1" >"${2:-scene.json}"; }

# place_cube SIZE X: one cube through its transform.
place_cube() { printf '{ "mesh": "cube.obj", "transform": [%s,0,0,%s, 0,%s,0,0, 0,0,%s,0, 0,0,0,1] }' "$1" "$2" "$1" "$1"; }

# render NAME [SIZE]: NAME.json to NAME.exr and its pixels to NAME.txt: x, y, A, object.I, the normal, and the depth in
# millionths of SIZE.
render() {
  accept guide scene "$1.json" -s 40 -c normal,depth,object,luma,uv,curvature,contour -o "$1.exr" || return 1
  dump "$1.exr" depth.Z "$(awk -v s="${2:-1}" 'BEGIN { print 1e6 / s }')" | cut -d' ' -f3 >depth.txt
  dump "$1.exr" A,object.I,normal.X,normal.Y,normal.Z | paste -d' ' - depth.txt >"$1.txt"
}

# expect_alike WHAT A B: the same pixels, all values to 1e-5.
expect_alike() {
  expect_less "covered pixels of $1" 300 "$(awk '$3 == 1' "$2" | wc -l)"
  paste -d' ' "$2" "$3" | awk '
    function differ(a, b, most) { return !(a - b <= most && b - a <= most) }
    $3 != $11 || $4 != $12 { print; exit }
    $3 == 1 && (differ($5, $13, 1e-5) || differ($6, $14, 1e-5) || differ($7, $15, 1e-5) || differ($8, $16, 10)) { print; exit }' >wrong.txt
  expect "$1" "$(cat wrong.txt)" ''
}

@test "from inside a closed mesh, and from inside a sphere" {
  write_cube >cube.obj
  local camera='"camera": { "type": "perspective", "position": [0.5, 0, 0], "target": [1, 0, 0], "fov": 30 }'
  write_scene "$camera, \"objects\": [ { \"mesh\": \"cube.obj\" } ]" box.json
  render box
  # One wall, half a unit away, that faces the camera.
  expect 'pixels of the wall' "$(awk '$3 == 1 && $5 == 0 && $6 == 0 && $7 == 1 && $8 == 500000' box.txt | wc -l)" 1600
  write_scene "$camera, \"spheres\": [ { \"center\": [0.5, 0, 0], \"radius\": 3 } ]" ball.json
  accept guide scene ball.json -s 40 -c position,normal,luma -o ball.exr
  dump ball.exr A,position.X,position.Y,position.Z,normal.X,normal.Y,normal.Z,luma.Y | awk '
    { r = sqrt(($4 - 0.5) ^ 2 + $5 ^ 2 + $6 ^ 2) - 3
      # Its normals lead back to the camera; the view axis is +X, right is +Z.
      ok = $3 == 1 && r < 1e-5 && r > -1e-5 && ($7 * 3 + $6) ^ 2 < 1e-9 && ($8 * 3 + $5) ^ 2 < 1e-9 && $9 > 0.9 && $10 == 1
      if (!ok) { print; exit } }' >wrong.txt
  expect 'walls of the ball' "$(cat wrong.txt)" ''
}

# Luminances that covered pixels have.
list_luma() { dump "$1" A,luma.Y | awk '$3 == 1 { print $4 }' | sort -u | tr '\n' ' '; }

@test "luma where there is no light" {
  local ball='"spheres": [ { "color": [1, 0.5, 0] } ]'
  write_scene "$ball" none.json
  write_scene "$ball, \"lights\": []" empty.json
  write_scene "$ball, \"lights\": [], \"ambient\": 0" dark.json
  local name
  for name in none empty dark; do accept guide scene $name.json -s 16 -c luma -o $name.exr; done
  expect_near 'evenly lit' "$(list_luma none.exr)" 0.5702 1e-6 # 0.2126 + 0.7152 / 2
  expect_near 'an empty list' "$(list_luma empty.exr)" 0.5702 1e-6
  expect 'no ambient light either' "$(list_luma dark.exr)" '0.000000000 '
}

@test "transforms that leave nothing, or too little, to see" {
  write_cube >cube.obj
  local rows
  refuse_transform() { # NAMED ROWS
    write_scene "\"objects\": [ { \"mesh\": \"cube.obj\", \"transform\": [$2, 0,0,0,1] }, { \"mesh\": \"cube.obj\" } ]"
    refuse 3 "$1" guide scene scene.json -s 8 -o out.exr
    refuse 3 "$1" info scene.json
  }
  for rows in 0,0,0,0,0,0,0,0,0,0,0,0 1,0,0,0,0,1,0,0,0,0,0,0 1,2,3,0,4,5,6,0,7,8,9,0 1,0,0,0,1,0,0,0,0,0,1,0 \
    1,0,0,0,0,1,0,0,1,1,1e-8,0; do
    refuse_transform 'objects[0].transform' "$rows"
  done
  refuse_transform 'invalid JSON' NaN,0,0,0,0,1,0,0,0,0,1,0
  refuse_transform 'invalid JSON' 1e999,0,0,0,0,1,0,0,0,0,1,0
  refuse_transform 'objects[0].transform[0]' 2e30,0,0,0,0,1,0,0,0,0,1,0
  # So thin, or so small beside the other cube, that floats can't trace it.
  for rows in 1,0,0,0,0,1,0,0,0,0,1e-30,0 1e-20,0,0,0,0,1e-20,0,0,0,0,1e-20,0; do
    refuse_transform 'found object 1 only' "$rows"
  done
  write_scene "\"objects\": [ $(place_cube 1e-9 0), { \"mesh\": \"cube.obj\" } ]"
  accept_warned 'object 1: found it to be 1e-09' guide scene scene.json -s 8 -o out.exr
}

@test "tiny and huge: through a transform, and in the mesh's file" {
  write_cube >cube.obj
  local size
  write_scene "\"camera\": { \"view\": \"30,20\" }, \"objects\": [ $(place_cube 1 0) ]" one.json
  render one
  for size in 1e-30 1e-12 1e12 1e30; do
    write_scene "\"camera\": { \"view\": \"30,20\" }, \"objects\": [ $(place_cube $size 0) ]" sized.json
    render sized $size
    expect_alike "a cube times $size" one.txt sized.txt
    write_cube $size >cube$size.obj
    write_scene "\"camera\": { \"view\": \"30,20\" }, \"objects\": [ { \"mesh\": \"cube$size.obj\" } ]" sized.json
    render sized $size
    expect_alike "a cube of size $size" one.txt sized.txt
  done
  write_cube 1.001e30 >large.obj
  refuse 3 'large.obj' guide scene large.obj -s 8 -o out.exr
  write_cube >cube.obj
  local place='"center": [1e30, 0, 0]'
  write_scene "\"objects\": [ $(place_cube 1e30 0) ], \"spheres\": [ { $place } ]"
  accept_warned 'sphere 1: found it to be 1e-30' guide scene scene.json -s 8 -o out.exr
  write_scene "\"spheres\": [ { ${place/1e30/1.001e30} } ]"
  refuse 3 'spheres[0].center[0]: found 1.001e+30, expected a number from -1e+30 to 1e+30' guide scene scene.json -s 8 -o none.exr
}

@test "a hundred million units from the origin: objects, lights and cameras" {
  write_cube >cube.obj
  write_far() { # X FILE
    local x=$1
    write_scene "\"camera\": { \"type\": \"perspective\", \"position\": [$((x + 2)), 2, 6], \"target\": [$x, 0, 0] },
      \"objects\": [ $(place_cube 1 "$x"), $(place_cube 0.5 $((x + 2))) ],
      \"spheres\": [ { \"center\": [$((x - 2)), 0, 0], \"radius\": 0.7 } ],
      \"lights\": [ { \"type\": \"point\", \"position\": [$((x + 3)), 4, 5], \"intensity\": 30 } ]" "$2"
  }
  write_far 0 near.json
  write_far 100000000 far.json
  render near
  render far
  expect_alike 'the scene far away' near.txt far.txt
  dump near.exr luma.Y >near.txt
  dump far.exr luma.Y >far.txt
  paste -d' ' near.txt far.txt | awk '{ d = $3 - $6; if (d > 1e-4 || d < -1e-4) n++ } END { print n + 0 }' >wrong.txt
  expect_less 'pixels lit otherwise' "$(cat wrong.txt)" 3
}

@test "a camera too far away" {
  local stand='"position": [1e8, 0, 0], "target": [0, 0, 0]'
  write_scene "\"camera\": { \"type\": \"perspective\", $stand, \"fov\": 1 }, \"spheres\": [ {} ]"
  refuse 3 'scene.json: camera: found it 5e+07 scene sizes away' guide scene scene.json -s 8 -o out.exr
  write_scene "\"camera\": { \"type\": \"orthographic\", $stand, \"height\": 2 }, \"spheres\": [ {} ]"
  refuse 3 'scene.json: camera: found it 5e+07 scene sizes away' guide scene scene.json -s 8 -o out.exr
  write_scene '"camera": { "type": "orthographic", "position": [9, 0, 0], "target": [0, 0, 0], "height": 1e9 }, "spheres": [ {} ]'
  refuse 3 'film 5e+08 wide' guide scene scene.json -s 8 -o out.exr
  # Beside a scene as large as that it is near.
  write_scene "\"camera\": { \"type\": \"orthographic\", $stand, \"height\": 2e6 }, \"spheres\": [ { \"radius\": 1e6 } ]"
  accept guide scene scene.json -s 8 -o out.exr --format json
  expect covered "$(json - r.covered <<<"$output")" 52
}

@test "textures that are missing or no whole pictures" {
  accept guide sphere -s 40 -o whole.png
  cp whole.png good.png
  head -c 300 whole.png >cut.png
  echo 'no picture' >text.png
  : >empty.png
  mkdir folder.png
  write_textured() { write_scene "\"spheres\": [ { \"texture\": \"$1.png\" } ]"; }
  write_textured good
  accept guide scene scene.json -s 8 -c albedo -o good.exr
  local name channel
  for name in missing:2 folder:2 cut:3 text:3 empty:3; do
    write_textured ${name%:*}
    for channel in albedo luma full; do
      refuse ${name#*:} "scene.json: spheres[0].texture: ./${name%:*}.png: " guide scene scene.json -s 8 -c $channel -o out.exr
    done
    # Not asked for: a file that isn't there is a mistake all the same.
    if [ ${name#*:} = 2 ]; then
      accept_warned "scene.json: spheres[0].texture: ./${name%:*}.png: " guide scene scene.json -s 8 -c normal,uv -o normal.exr
      accept_warned "./${name%:*}.png: " guide scene scene.json -s 8 --dry-run -o none.exr
      accept_warned "./${name%:*}.png: " info scene.json
    else
      accept guide scene scene.json -s 8 -c normal,uv -o normal.exr
    fi
  done
}

@test "textures of layers: the plain one by name, or none" {
  accept guide sphere -s 40 -c normal,depth -o layers.exr
  write_scene '"spheres": [ { "texture": "layers.exr" } ]'
  refuse 3 'layers.exr: found the channels A, depth.Z, normal.X, normal.Y, normal.Z, expected R, G and B, or Y alone' \
    guide scene scene.json -s 8 -c albedo -o out.exr
}

@test "textures and materials of meshes: who names what isn't there" {
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nusemtl skin\nf 1/1 2/1 3/1\n' >body.obj
  printf 'mtllib skin.mtl\n' | cat - body.obj >wall.obj
  accept_warned 'wall.obj: found no material file skin.mtl' guide scene wall.obj -s 8 -o out.exr
  accept_warned 'wall.obj: found no material file skin.mtl' guide scene wall.obj -s 8 -c albedo -o out.exr
  printf 'newmtl skin\nmap_Kd skin.png\n' >skin.mtl
  accept_warned 'wall.obj: ./skin.png: ' guide scene wall.obj -s 8 -o out.exr
  refuse 2 'wall.obj: ./skin.png: ' guide scene wall.obj -s 8 -c albedo -o none.exr
  write_scene '"objects": [ { "mesh": "wall.obj" } ]'
  refuse 2 'wall.obj: ./skin.png: ' guide scene scene.json -s 8 -c albedo -o none.exr
  accept guide sphere -s 8 -o skin.png
  accept guide scene wall.obj -s 8 -c albedo -o out.exr
}

@test "textures on meshes without texture coordinates" {
  write_cube >cube.obj
  accept guide sphere -s 8 -o skin.png
  write_scene '"objects": [ { "mesh": "cube.obj" }, { "mesh": "cube.obj", "texture": "skin.png" } ]'
  accept_warned 'object 2: found a texture on part 1 of ./cube.obj, which has no texture coordinates' guide scene scene.json -s 8 -c albedo -o out.exr
  (echo 'mtllib skin.mtl'; echo 'usemtl skin'; cat cube.obj) >wall.obj
  printf 'newmtl skin\nmap_Kd skin.png\n' >skin.mtl
  accept_warned 'object 1: found a texture on part 1 of wall.obj, which has no texture coordinates' guide scene wall.obj -s 8 -c albedo -o out.exr
  # Painted over, the mesh's own doesn't count.
  write_scene '"objects": [ { "mesh": "wall.obj", "color": [1, 0, 0] } ]'
  accept guide scene scene.json -s 8 -c albedo -o out.exr
}

@test "meshes of a scene that hold nothing, or nothing with an area" {
  write_cube >cube.obj
  printf 'OFF\n0 0 0\n' >none.off
  : >none.obj
  printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\nf 2 2 2\n' >flat.obj
  local name
  for name in none.off none.obj flat.obj; do
    write_scene "\"objects\": [ { \"mesh\": \"cube.obj\" }, { \"mesh\": \"$name\" } ]"
    refuse 3 "$name" guide scene scene.json -s 8 -o out.exr
  done
  # Those without an area are left out where others have one.
  sed 's/^f 1 2 3/f 9 10 11/; s/^f 1 1 2/f 9 9 10/; s/^f 2 2 2/f 9 9 9/' flat.obj | cat cube.obj - >most.obj
  accept guide scene most.obj -s 16 -o most.exr --no-history
  accept guide scene cube.obj -s 16 -o cube.exr --no-history
  expect_same most.exr cube.exr
}

@test "nothing that a scene names is written over, whatever is asked of it" {
  write_cube >cube.obj
  sed -e '/^f/d' cube.obj >soft.obj
  printf 'vt 0 0\nvt 1 0\nvt 1 1\nmtllib soft.mtl\nusemtl cloth\nf 1/1 2/2 4/3\nf 5/1 6/2 8/3\n' >>soft.obj
  printf 'newmtl cloth\nmap_Kd cloth.exr\n' >soft.mtl
  local name
  for name in cloth ball last; do accept guide sphere -s 8 -o $name.exr; done
  write_scene '"objects": [ { "mesh": "soft.obj" } ], "spheres": [ { "center": [0, 0, 0], "radius": 1, "texture": "ball.exr" } ]' now.json
  write_scene '"objects": [ { "mesh": "soft.obj" } ], "spheres": [ { "center": [0, 0, 0], "radius": 1, "texture": "last.exr" } ]' then.json
  for name in normal albedo; do
    refuse 1 'which is an input' guide scene now.json -c $name -s 16 -o cloth.exr
    refuse 1 'which is an input' guide scene now.json -c $name -s 16 -o ball.exr
    refuse 1 'which is an input' guide scene soft.obj -c $name -s 16 -o cloth.exr
  done
  refuse 1 'which is an input' guide scene now.json --previous then.json -c motion -s 16 -o last.exr
}

@test "--dry-run refuses what tracing would" {
  write_cube >cube.obj
  write_scene '"objects": [ { "mesh": "cube.obj", "texture": "none.png" } ]' bare.json
  write_scene '"objects": [ { "mesh": "cube.obj" }, { "mesh": "cube.obj" } ]' two.json
  write_scene '"objects": [ { "mesh": "cube.obj" } ]' one.json
  echo 'not a picture' >none.png
  refuse 3 none.png guide scene bare.json -s 16 -c albedo --dry-run -o out.exr
  refuse 3 'found 2 objects' guide scene one.json --previous two.json -s 16 -c motion --dry-run -o out.exr
}

@test "--previous: a scene of other things" {
  write_cube >cube.obj
  (sed '/^f/d' cube.obj; grep '^f' cube.obj | sort -r) >other.obj
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >less.obj
  write_cube 2 >moved.obj
  accept guide scene cube.obj --previous moved.obj -s 8 -c motion -o out.exr
  refuse 3 '--previous other.obj: object 1: found that triangle' guide scene cube.obj --previous other.obj -s 8 -o none.exr
  refuse 3 '--previous other.obj: object 1: found that triangle' guide scene cube.obj --previous other.obj -s 8 -o none.exr --dry-run
  refuse 3 '--previous less.obj: object 1: found 1 triangle, expected 12' guide scene cube.obj --previous less.obj -s 8 -o none.exr
  write_scene '"spheres": [ {} ]' ball.json
  refuse 3 '--previous ball.json: found 0 objects and 1 sphere, expected 1 object and 0 spheres' \
    guide scene cube.obj --previous ball.json -s 8 -o none.exr
}

# write_quad TEXTURE [EXTENSION]: quad.gltf, whose first coordinates go over the picture once and whose second
# ones all are (0.75, 0.25).
write_quad() {
  node -e '
    const [material, used] = process.argv.slice(1)
    const floats = [0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, /* */ 0, 1, 1, 1, 1, 0, 0, 0, /* */ ...Array(4).fill([0.75, 0.75]).flat()]
    const bytes = Buffer.concat([Buffer.from(new Float32Array(floats).buffer), Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3]).buffer)])
    const view = (byteOffset, byteLength) => ({ buffer: 0, byteOffset, byteLength })
    console.log(JSON.stringify({
      asset: { version: "2.0" }, extensionsUsed: used ? [used] : undefined, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
      meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1, TEXCOORD_1: 2 }, indices: 3, material: 0 }] }],
      materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0, ...JSON.parse(material) } } }],
      textures: [{ source: 0 }], images: [{ uri: "two%20by%20two.png" }],
      buffers: [{ byteLength: bytes.length, uri: "data:application/octet-stream;base64," + bytes.toString("base64") }],
      bufferViews: [view(0, 48), view(48, 32), view(80, 32), view(112, 12)],
      accessors: [
        { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [0, 0, 0], max: [4, 4, 0] },
        { bufferView: 1, componentType: 5126, count: 4, type: "VEC2" }, { bufferView: 2, componentType: 5126, count: 4, type: "VEC2" },
        { bufferView: 3, componentType: 5123, count: 6, type: "SCALAR" }] }))' "$@" >quad.gltf
}

# Red and green above, blue and white below.
draw_two_by_two() {
  oiiotool --create 2x2 3 --point:color=1,0,0 0,0 --point:color=0,1,0 1,0 --point:color=0,0,1 0,1 --point:color=1,1,1 1,1 -d uint8 -o "$1"
}

# list_corners FILE: the colours of a 2x2 guide, row by row.
list_corners() { dump "$1" albedo.R,albedo.G,albedo.B | awk '{ printf "%s%g%g%g", (NR > 1 ? " " : ""), $3, $4, $5 }'; }

@test "textures of glTF: coordinates of their own, transforms, names with blanks" {
  draw_two_by_two 'two by two.png'
  local look=(-s 2 --margin 0 -c albedo,uv --texture-filter nearest -o out.exr)
  write_quad '{}'
  accept guide scene quad.gltf "${look[@]}"
  expect 'as they are' "$(list_corners out.exr)" '100 010 001 111'
  write_quad '{ "texCoord": 1 }'
  accept guide scene quad.gltf "${look[@]}"
  expect 'the second coordinates' "$(list_corners out.exr)" '111 111 111 111'
  write_quad '{ "extensions": { "KHR_texture_transform": { "offset": [0.5, 0] } } }' KHR_texture_transform
  accept guide scene quad.gltf "${look[@]}"
  expect moved "$(list_corners out.exr)" '010 100 111 001'
}

@test "a material that isn't in its file is named" {
  printf 'newmtl card\nKd 1 0 0\n' >k.mtl
  printf 'mtllib k.mtl\nusemtl crad\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >k.obj
  accept_warned 'k.obj: found no material crad' guide scene k.obj -s 16 -o out.exr
  sed -i s/crad/card/ k.obj
  accept guide scene k.obj -s 16 -o out.exr
}

@test "nearest texels hold their lower and left borders" {
  draw_two_by_two tex.png
  printf 'newmtl t\nKd 1 1 1\nmap_Kd tex.png\n' >k.mtl
  local u v
  for u in 0 0.5; do
    for v in 0 0.5; do
      printf 'mtllib k.mtl\nusemtl t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt %s %s\nvt 3 7\nf 1/1 2/1 3/1\n' $u $v >k.obj
      accept guide scene k.obj -s 2 --margin 0 -c albedo --texture-filter nearest -o k.exr -q
      list_corners k.exr | cut -d' ' -f3
    done
  done >found.txt
  expect colours "$(paste -sd' ' found.txt)" '001 100 111 010'
}

@test "things that are too small beside the scene are warned of" {
  write_scene '"spheres": [ { "center": [0, 0, 0], "radius": 1 }, { "center": [2, 0, 0], "radius": 1e-6 } ]'
  accept_warned 'sphere 2: found it to be' guide scene scene.json -s 8 -o out.exr
  write_cube >cube.obj
  write_scene "\"objects\": [ { \"mesh\": \"cube.obj\" }, $(place_cube 1e-6 2) ]"
  accept_warned 'object 2: found it to be' guide scene scene.json -s 8 -o out.exr
  # Thin ones aren't small.
  write_scene '"objects": [ { "mesh": "cube.obj" }, { "mesh": "cube.obj", "transform": [1,0,0,2, 0,1,0,0, 0,0,1e-8,0, 0,0,0,1] } ]'
  accept guide scene scene.json -s 8 -o out.exr
}
