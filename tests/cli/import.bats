#!/usr/bin/env bats
# stylut guide import: other programs' files. What is in them is tests/guide/test_foreign.c's;
# here they are 16-bit floats, parts of files, and command lines.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  cat >shot.json <<'END'
{ "schema": "stylut-scene/1",
  "camera": { "type": "perspective", "position": [2.5, 1.8, 4], "target": [-0.2, 0.3, 0], "up": [0.1, 1, 0.2], "fov": 42 },
  "spheres": [ { "center": [0.3, 0.2, -0.4], "radius": 1, "style": 3 }, { "center": [-1.4, 0.5, 0.6], "radius": 0.6, "style": 10 } ] }
END
  "$STYLUT" guide scene shot.json -s 60x44 -c all --no-history -q -o guide.exr
  "$STYLUT" guide scene shot.json -s 60x44 --no-history -q -o guide.png
  # Camera space, so that names alone make a file of Houdini's.
  oiiotool guide.exr --ch normal.X,normal.Y,normal.Z,depth.Z --chnames N.x,N.y,N.z,Pz -d float -o houdini.exr
  oiiotool houdini.exr -d half -o half.exr
  # Nothing is turned by a camera that looks along -Z, so neither are a world's normals.
  sed 's/"position".*"fov"/"position": [0, 0, 5], "target": [0, 0, 0], "fov"/' shot.json >front.json
  "$STYLUT" guide scene front.json -s 60x44 -c all --no-history -q -o front.exr
  oiiotool front.exr --ch normal.X,normal.Y,normal.Z,depth.Z,position.X,position.Y,position.Z \
    --chnames ViewLayer.Normal.X,ViewLayer.Normal.Y,ViewLayer.Normal.Z,ViewLayer.Depth.Z,ViewLayer.Position.X,ViewLayer.Position.Y,ViewLayer.Position.Z \
    -d float -o blender.exr
}

values=A,normal.X,normal.Y,normal.Z,depth.Z
expect_guides_near() { # FOUND EXPECTED TOLERANCE
  paste -d' ' <(dump "$1" $values) <(dump "$2" $values) >both.txt
  expect 'pixels' "$(wc -l <both.txt)" 2640
  awk -v t="$3" '{ for (k = 3; k <= 7; k++) if ($k != $(k + 7)) { d = $k - $(k + 7); if (!(d <= t && -d <= t)) { print; exit } } }' both.txt >wrong.txt
  expect "$1 beside $2" "$(cat wrong.txt)" ''
}

@test "float and half: what went out comes back" {
  bring '*.exr' '*.json'
  accept guide import houdini.exr --as houdini -o float.exr
  expect_guides_near float.exr guide.exr 1e-7
  accept guide import half.exr --as houdini -o half_guide.exr
  expect_guides_near half_guide.exr guide.exr 0.002 # depths of 2 to 8 have steps of 0.004
  accept guide import blender.exr --as blender --camera front.json -o front_guide.exr
  expect_guides_near front_guide.exr front.exr 1e-6
  # The camera is all that is read of its file.
  sed 's/"spheres.*/"objects": [ { "mesh": "missing.obj" } ] }/' front.json >other.json
  accept guide import blender.exr --as blender --camera other.json --no-history -o a.exr
  accept guide import blender.exr --as blender --camera front.json --no-history -o b.exr -j 1
  expect_same a.exr b.exr
}

@test "a file of parts" {
  bring '*.exr'
  oiiotool houdini.exr --ch N.x,N.y,N.z --chnames x,y,z --attrib oiio:subimagename N \
    houdini.exr --ch Pz --chnames Pz --attrib oiio:subimagename Pz --siappend -d float -o parts.exr
  accept guide import parts.exr --as houdini -o parts_guide.exr
  expect_guides_near parts_guide.exr guide.exr 1e-7
}

@test "pictures: as every command reads them" {
  bring 'guide.*'
  accept guide import guide.png --as png --no-history -o imported.png
  accept compare imported.png guide.png
  accept lut guide.png -s 16 --no-history -o a.exr
  accept guide import guide.png --as png --no-history -o imported.exr
  accept lut imported.exr -s 16 --no-history -o b.exr
  accept compare a.exr b.exr
  # Y down is Y up upside down, but for alpha.
  oiiotool --no-autopremult guide.png --ch R,G,B --mulc 1,-1,1 --addc 0,1,0 guide.png --ch A --chappend -d uint8 -o directx.png
  accept guide import directx.png --as png --flip-y -o flipped.png
  oiiotool --no-autopremult guide.png --ch A,A,A,A flipped.png --mul -o masked.png
  accept compare masked.png guide.png --fail 0.005
}

@test "a picture that is no map of normals is warned of" {
  oiiotool --pattern fill:topleft=0.2,0.3,0.1:topright=0.9,0.7,0.5:bottomleft=0.3,0.2,0.2:bottomright=0.6,0.6,0.4 40x30 3 -d uint8 -o photo.png
  local options
  for options in '' --flip-y; do
    # shellcheck disable=SC2086
    "$STYLUT" guide import photo.png --as png $options -o g.exr >/dev/null 2>said.txt
    expect_match "warnings $options" "$(cat said.txt)" '^stylut: warning: photo.png: found normals more than 10 % off length 1 in 9[0-9.]+ % of the covered pixels, left as they are; expected a map of unit normals: is it another picture\?
stylut: warning: photo.png: found normals facing away from the viewer in (9[0-9]|100) % of the covered pixels'
  done
  # One pixel in a hundred is but an edge.
  oiiotool --create 10x10 3 --addc 0.5,0.5,1 --box:color=0.5,0.5,0.5:fill=1 4,4,4,4 -d uint8 -o edge.png
  accept_warned '1.00 % of the covered pixels, left as they are; expected unit normals, without anti-aliasing' guide import edge.png --as png -o g.exr
}

@test "what it took, assumed, and left out" {
  bring '*.exr' '*.json'
  oiiotool blender.exr guide.exr --ch object.I --chnames ViewLayer.Mist.Z --chappend -d float -o mist.exr
  accept guide import mist.exr --as blender --camera front.json -o g.exr
  expect_holds report "$output" 'g.exr: 60x44, '
  expect_holds report "$output" 'taken    normal.X .Y .Z from ViewLayer.Normal.X .Y .Z'
  expect_holds report "$output" 'assumed  normals are right-handed world space; the camera turned them'
  expect_holds report "$output" 'left out ViewLayer.Mist.Z'
  accept guide import mist.exr --as blender --camera front.json -o g.exr --format json
  expect schema "$(json - 'r.schema + r.as + r.size' <<<"$output")" stylut-import/1blender60,44
  expect lists "$(json - '[r.taken.length, r.assumed.length, r.warnings.length, r.left_out.join()].join()' <<<"$output")" 3,2,0,ViewLayer.Mist.Z
  accept guide import mist.exr --as blender --camera front.json -o g.exr -q
  expect 'quiet report' "$output" ''
  accept guide import mist.exr --as blender --camera front.json -o other.exr --dry-run
  expect 'other.exr' "$(list_files | grep -c other.exr || true)" 0
  accept info g.exr --format json
  expect command "$(json - 'r.attributes["stylut:command"]' <<<"$output")" 'stylut guide import --as=blender --camera=front.json mist.exr'
  expect inputs "$(json - 'r.attributes["stylut:input1"] + r.attributes["stylut:input2"]' <<<"$output")" "$(sha256sum mist.exr front.json | cut -d' ' -f1 | tr -d '\n')"
  accept_warned 'camera sees' guide import mist.exr --as blender --camera shot.json -o g.exr
}

@test "what is refused" {
  bring '*.exr' '*.json' guide.png
  prove guide import houdini.exr --as houdini -o out.exr
  refuse 1 --as guide import houdini.exr -o out.exr
  refuse 1 maya guide import houdini.exr --as maya -o out.exr
  refuse 1 'the file to import' guide import --as houdini -o out.exr
  refuse 1 --output guide import houdini.exr --as houdini
  refuse 1 out.jpg guide import houdini.exr --as houdini -o out.jpg
  refuse 1 houdini.exr guide import houdini.exr --as houdini -o houdini.exr
  refuse 1 front.json guide import blender.exr --as blender --camera front.json -o front.json
  refuse 1 --space guide import houdini.exr --as houdini --space object -o out.exr
  refuse 1 --camera guide import blender.exr --as blender -o out.exr
  refuse 1 --camera guide import houdini.exr --as houdini --space world -o out.exr
  refuse 2 missing.exr guide import missing.exr --as houdini -o out.exr
  refuse 2 missing.json guide import blender.exr --as blender --camera missing.json -o out.exr
  refuse 3 'found no normals of blender among 4 channels (Pz, N.x, N.y, N.z), expected Normal.X, Normal.Y and Normal.Z, or --as houdini' guide import houdini.exr --as blender -o out.exr
  refuse 3 'found channel Pz, which is of houdini, expected channels of arnold, or --as houdini' guide import houdini.exr --as arnold -o out.exr
  refuse 3 'R, G and B of 8 or 16 bit, or --as houdini' guide import houdini.exr --as png -o out.exr
  refuse 3 'expected Ns.X, Ns.Y and Ns.Z, or --as png' guide import guide.png --as pbrt -o out.exr
  oiiotool houdini.exr --chnames Z,N.x,N.y,N.z -o arnold.exr
  refuse 3 'found channel Z, which is of arnold, expected channels of houdini, or --as arnold' guide import arnold.exr --as houdini -o out.exr
  head -c 600 houdini.exr >short.exr
  refuse 3 short.exr guide import short.exr --as houdini -o out.exr
  : >empty.exr
  refuse 3 empty.exr guide import empty.exr --as houdini -o out.exr
  printf '{"schema": "stylut-scene/1"}' >none.json
  refuse 3 'no key "camera"' guide import blender.exr --as blender --camera none.json -o out.exr
  printf '{"schema": "stylut-scene/1", "camera": {"type": "fit"}}' >fit.json
  refuse 3 'fit.json:1:49: camera.type: found "fit"' guide import blender.exr --as blender --camera fit.json -o out.exr
  printf '{"schema": "stylut-scene/1", "camera": {}}' >bare.json
  refuse 3 'bare.json:1:40: camera' guide import blender.exr --as blender --camera bare.json -o out.exr
}

@test "a value that isn't finite names its pixel, where it is covered" {
  bring houdini.exr
  oiiotool --create 60x44 1 --addc 1 --box:color=inf:fill=1 30,22,30,22 --chnames N.x houdini.exr --ch N.y,N.z,Pz --chappend -d float -o hole.exr
  refuse 3 'at pixel (30, 22), expected a finite value' guide import hole.exr --as houdini -o out.exr
}

@test "a map in the axes of a world whose z is up is warned of" {
  accept guide sphere -s 64 -o sphere.png
  oiiotool --no-autopremult sphere.png --ch R,B,G,A -o world.png
  accept guide import sphere.png --as png -o view.exr
  local said
  said=$("$STYLUT" guide import world.png --as png -o world.exr 2>&1 >/dev/null)
  expect_match warning "$said" 'warning: world.png: found normals facing away from the viewer in 4[0-9] % of the covered pixels'
}
