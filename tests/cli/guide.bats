#!/usr/bin/env bats
# stylut guide: what the pixels of guide maps hold.
load helpers

# Every pixel of a sphere guide of WxH, by the formula, in the order of dump.
sphere_channels=A,normal.X,normal.Y,normal.Z,depth.Z,position.X,position.Y,position.Z,object.I,style.I,albedo.R,albedo.G,albedo.B,luma.Y
check_sphere() { # FILE WIDTH HEIGHT
  dump "$1" $sphere_channels >pixels.txt
  expect "pixels of $1" "$(wc -l <pixels.txt)" $(($2 * $3))
  awk -v w="$2" -v h="$3" '
    function near(a, b) { return a - b < 2e-6 && b - a < 2e-6 }
    {
      x = ($1 + 0.5) / w * 2 - 1; y = 1 - ($2 + 0.5) / h * 2; r = x * x + y * y
      z = r <= 1 ? sqrt(1 - r) : 0
      if (r <= 1) ok = $3 == 1 && near($4, x) && near($5, y) && near($6, z) && near($7, 1 - z) &&
                       near($8, x) && near($9, y) && near($10, z) && $11 == 1 && $12 == 1 &&
                       $13 == 1 && $14 == 1 && $15 == 1 && $16 == 1
      else ok = $3 == 0 && $4 == 0 && $5 == 0 && $6 == 0 && $7 == "inf" && $8 == 0 && $9 == 0 && $10 == 0 && $11 == 0 && $12 == 0 &&
                $13 == 0 && $14 == 0 && $15 == 0 && $16 == 0
      if (!ok) { print "at " $0; exit 1 }
    }' pixels.txt >wrong.txt || complain "$1 of $2x$3: $(cat wrong.txt)"
}

@test "sphere: every value of every channel" {
  accept guide sphere -s 24 -c all -o square.exr
  check_sphere square.exr 24 24
  accept guide sphere -s 25x16 -c all -o wide.exr
  check_sphere wide.exr 25 16
}

# What oiiotool finds at a pixel, all channels in its own order.
ask_oiiotool() { oiiotool --no-autopremult "$1" --cut "1x1+$2+$3" -d float -o cut.exr && oiiotool --dumpdata cut.exr | sed -n 's/^ *Pixel (0, 0): //p'; }

@test "another reader sees the same values" {
  accept guide sphere -s 24 -o s.exr
  local place
  for place in '3 7' '12 12' '0 0'; do
    # shellcheck disable=SC2086
    expect "pixel $place" "$(ask_oiiotool s.exr $place)" "$(dump s.exr A,depth.Z,normal.X,normal.Y,normal.Z | sed -n "s/^$place //p")"
  done
  expect_near 'normal.X at 3 7' "$(ask_oiiotool s.exr 3 7 | cut -d' ' -f3)" -0.7083333 1e-6
  accept guide sphere -s 24 --bits 16 -o s.png
  for place in '3 7' '20 5' '0 0'; do
    # EXR files list their channels R G B A.
    # shellcheck disable=SC2086
    expect_near "pixel $place" "$(ask_oiiotool s.png $place)" "$(dump s.png R,G,B,A | sed -n "s/^$place //p")" 1e-6
  done
}

@test "sphere: channels are those asked for" {
  accept guide sphere -s 8 -c normal -o normal.exr
  accept guide sphere -s 8 -o default.exr
  accept guide sphere -s 8 -c position,object,position -o some.exr
  accept info normal.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" A,normal.X,normal.Y,normal.Z
  accept info default.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" A,depth.Z,normal.X,normal.Y,normal.Z
  accept info some.exr --format json
  expect channels "$(json - 'r.channels.map(c => c.name).sort().join()' <<<"$output")" A,object.I,position.X,position.Y,position.Z
  expect schema "$(json - 'r.schema' <<<"$output")" stylut-info/1
  expect bits "$(json - 'r.bits' <<<"$output")" 32
}

@test "sphere: sizes and ranges as info tells them" {
  accept guide sphere -s 30x20 -o wide.exr
  accept info wide.exr --format json
  expect size "$(json - 'r.size' <<<"$output")" '[30,20]'
  local count
  count=$(awk 'BEGIN { for (j = 0; j < 20; j++) for (i = 0; i < 30; i++) {
    x = (i + 0.5) / 15 - 1; y = 1 - (j + 0.5) / 10; n += x * x + y * y > 1 } print n }')
  expect 'depths that are infinite' "$(json - 'r.channels.find(c => c.name == "depth.Z").not_finite' <<<"$output")" "$count"
  expect_near 'range of normal.X' "$(json - '(c => c.minimum + " " + c.maximum)(r.channels.find(c => c.name == "normal.X"))' <<<"$output")" \
    '-0.966667 0.966667' 1e-4
  accept guide sphere -o default.exr --format json
  expect 'default size' "$(json - 'r.size' <<<"$output")" '[512,512]'
}

check_png() { # BITS
  local bits=$1 top
  top=$(((1 << bits) - 1))
  accept guide sphere -s 17x20 --bits "$bits" -o map.png
  accept info map.png --format json
  expect bits "$(json - r.bits <<<"$output")" "$bits"
  dump map.png R,G,B,A $top | awk -v w=17 -v h=20 -v top=$top '
    function off(a, n) { d = a - (n / 2 + 0.5) * top; return d > 0.501 || d < -0.501 }
    {
      x = ($1 + 0.5) / w * 2 - 1; y = 1 - ($2 + 0.5) / h * 2; r = x * x + y * y
      if (r > 1) bad = $3 || $4 || $5 || $6
      else bad = off($3, x) || off($4, y) || off($5, sqrt(1 - r)) || $6 != top
      if (bad) { print; exit }
    }
    END { if (NR != w * h) print NR " pixels" }' >wrong.txt
  expect "wrong pixels of $bits bits" "$(cat wrong.txt)" ''
}

@test "sphere: PNG in 8 and 16 bits" {
  beside check_png 8
  beside check_png 16
  wait
  accept guide sphere -s 8 -o eight.png
  accept guide sphere -s 8 --bits 8 -o also.png --no-history
  accept guide sphere -s 8 -o plain.png --no-history
  expect_same also.png plain.png
}

# What holds for every guide of a scene: A is 0 or 1, misses have their values,
# normals are of unit length and never face away (from an orthographic camera).
check_scene() { # FILE [LEAST-NORMAL.Z]
  dump "$1" $sphere_channels >pixels.txt
  awk -v least="${2:--0.001}" '
    {
      n = sqrt($4 * $4 + $5 * $5 + $6 * $6)
      if ($3 == 1) ok = n > 0.99999 && n < 1.00001 && $6 > least + 0 && $7 > -1e-6 && $7 != "inf" && $11 >= 1 && $11 == int($11)
      else ok = $3 == 0 && n == 0 && $7 == "inf" && $8 == 0 && $9 == 0 && $10 == 0 && $11 == 0
      if (!ok) { print "at " $0; exit 1 }
    }' pixels.txt >wrong.txt || complain "$1: $(cat wrong.txt)"
}

check_creature() { # VIEW CAMERA NAME [LEAST-NORMAL.Z]
  local covered
  accept guide scene "$exemplars/creature.ply" -s 96x80 -c all --view="$1" --camera "$2" -o c.exr --format json
  covered=$(json - r.covered <<<"$output")
  check_scene c.exr "${4:-}"
  expect 'covered pixels' "$covered" "$(awk '$3 == 1' pixels.txt | wc -l)"
  expect_less 'share covered' 0.05 "$(awk -v c="$covered" 'BEGIN { print c / 96 / 80 }')"
  expect_less 'share covered' "$(awk -v c="$covered" 'BEGIN { print c / 96 / 80 }')" 0.8
  cp pixels.txt "$BATS_TEST_TMPDIR/desk/$3.txt"
}

@test "scene: the creature from all sides, orthographic and in perspective" {
  local view
  for view in front three-quarter 90,0 -120,-35.5 0,90; do beside check_creature $view orthographic "$view"; done
  for view in three-quarter 0,90; do beside check_creature $view perspective "$view.p" -0.5; done
  wait
  expect 'distinct views' "$(sha256sum ./*.txt | cut -d' ' -f1 | sort -u | wc -l)" 7
  accept guide scene "$exemplars/creature.ply" -s 64 --view three-quarter --no-history -o a.exr
  accept guide scene "$exemplars/creature.ply" -s 64 --view 35,20 --no-history -o b.exr
  expect_same a.exr b.exr
  accept guide scene "$exemplars/creature.ply" -s 64 --view front --no-history -o a.exr
  accept guide scene "$exemplars/creature.ply" -s 64 --no-history -o b.exr
  expect_same a.exr b.exr
}

@test "scene: what is right in a view is right in the picture" {
  # A slab that faces +Z, its left half nearer; seen from the front and from +X.
  printf '%s\n' 'v -2 -1 1' 'v 0 -1 1' 'v 0 1 1' 'v -2 1 1' 'v 0 -1 0' 'v 1 -1 0' 'v 1 1 0' 'v 0 1 0' 'f 1 2 3 4' 'f 5 6 7 8' >slab.obj
  accept guide scene slab.obj -s 30x20 -c all --margin 0 -o front.exr
  check_scene front.exr
  local row
  row=$(awk '$2 == 10 && $3 == 1' pixels.txt)
  expect 'row covered' "$(wc -l <<<"$row")" 30
  expect_near 'position at the left' "$(awk '$1 == 0 { print $8, $10 }' <<<"$row")" '-1.95 1' 1e-4
  expect_near 'position at the right' "$(awk '$1 == 29 { print $8, $10 }' <<<"$row")" '0.95 0' 1e-4
  expect_near 'depth between the halves' "$(awk '$1 == 0 { a = $7 } $1 == 29 { print $7 - a }' <<<"$row")" 1 1e-4
  expect_near 'normal' "$(awk '$1 == 3 { print $4, $5, $6 }' <<<"$row")" '0 0 1' 1e-6
  expect_near 'position.Y of the top row' "$(awk '$1 == 3 && $2 == 0 { print $9 }' pixels.txt)" 0.95 1e-4
  accept guide scene slab.obj -s 30x20 -c normal --view 60,0 -o side.exr
  expect_near 'normal from +X' "$(dump side.exr A,normal.X,normal.Y,normal.Z | awk '$3 == 1 { print $4, $5, $6; exit }')" '-0.8660254 0 0.5' 1e-5
  accept guide scene slab.obj -s 30x20 -c normal --view 0,30 -o above.exr
  expect_near 'normal from above' "$(dump above.exr A,normal.X,normal.Y,normal.Z | awk '$3 == 1 { print $4, $5, $6; exit }')" '0 -0.5 0.8660254' 1e-5
}

write_cube() {
  printf 'v %s\n' '-1 -1 -1' '1 -1 -1' '1 1 -1' '-1 1 -1' '-1 -1 1' '1 -1 1' '1 1 1' '-1 1 1'
  printf 'f %s\n' '5 6 7 8' '2 1 4 3' '6 2 3 7' '1 5 8 4' '8 7 3 4' '1 2 6 5'
}
count_normals() { dump "$1" A,normal.X,normal.Y,normal.Z | awk '$3 == 1 { printf "%.4f %.4f %.4f\n", $4, $5, $6 }' | sort -u | wc -l; }

@test "scene: flat and smooth normals" {
  write_cube >cube.obj
  local view=(-s 40 -c normal --view 30,20 --no-history)
  accept guide scene cube.obj "${view[@]}" --flat -o flat.exr
  accept guide scene cube.obj "${view[@]}" --crease 30 -o hard.exr
  accept guide scene cube.obj "${view[@]}" --crease 120 -o smooth.exr
  accept guide scene cube.obj "${view[@]}" -o default.exr
  expect 'normals of facets' "$(count_normals flat.exr)" 3
  expect_same flat.exr hard.exr
  expect_same default.exr hard.exr
  expect_less 'normals when smooth' 100 "$(count_normals smooth.exr)"
  # Flat: the view frame of (1,0,0) from azimuth 30, elevation 20 is among them.
  dump flat.exr A,normal.X,normal.Y,normal.Z | awk '$3 == 1 { printf "%.4f %.4f %.4f\n", $4, $5, $6 }' | sort -u |
    grep -qx '0.8660 -0.1710 0.4698' || complain "flat.exr lacks the normal of the side that faces +X"
}

# Bounds of the covered pixels: left top right bottom, counted from the borders.
get_margins() { dump "$1" A | awk -v w="$2" -v h="$3" '$3 == 1 {
  if (l == "" || $1 < l) l = $1; if ($1 > r) r = $1; if (t == "" || $2 < t) t = $2; if ($2 > b) b = $2 }
  END { print l, t, w - 1 - r, h - 1 - b }'; }

check_margins() { # CAMERA MARGIN REGEX
  accept guide scene cube.obj -s 60x40 ${2:+--margin $2} --camera "$1" -o m.exr
  expect_match "$1, margin '$2'" "$(get_margins m.exr 60 40)" "$3"
}

@test "scene: margins" {
  write_cube >cube.obj
  local camera
  for camera in orthographic perspective; do
    beside check_margins $camera 0 '^(9|1[0-2]) 0 (9|1[0-2]) 0$'
    beside check_margins $camera 0.25 '^(19|20|21) (9|10) (19|20|21) (9|10)$'
  done
  beside check_margins orthographic '' '^12 2 12 2$'
  wait
}

@test "scene: a mirrored mesh gives the mirrored guide" {
  # A bumpy sheet, nowhere symmetric.
  write_sheet() { # SIGN
    awk -v s="$1" 'BEGIN {
      n = 12
      for (j = 0; j <= n; j++) for (i = 0; i <= n; i++) {
        x = i / n * 2.1 - 0.9; y = j / n * 1.7 - 0.8 + 0.1 * x * x
        printf "v %.7f %.7f %.7f\n", s * x, y, 0.4 * sin(2.3 * x + 1) * cos(3.1 * y) - 0.3 * x }
      for (j = 0; j < n; j++) for (i = 0; i < n; i++) {
        a = j * (n + 1) + i + 1; b = a + 1; c = b + n + 1; d = a + n + 1
        if (s > 0) printf "f %d %d %d\nf %d %d %d\n", a, b, c, a, c, d
        else printf "f %d %d %d\nf %d %d %d\n", a, c, b, a, d, c } }'
  }
  write_sheet 1 >right.obj
  write_sheet -1 >left.obj
  beside check_mirrored '--view 25,10'
  beside check_mirrored '--view 25,10 --camera perspective'
  beside check_mirrored '--flat --view 25,10'
  wait
}

check_mirrored() { # OPTIONS
  local options=$1 angle=-25
  # shellcheck disable=SC2086
  accept guide scene right.obj -s 61x50 -c all $options -o right.exr
  # shellcheck disable=SC2086
  accept guide scene left.obj -s 61x50 -c all ${options/25,10/$angle,10} -o left.exr
  dump right.exr $sphere_channels | awk '{ $1 = 60 - $1; $4 = 0 - $4; $8 = 0 - $8; print }' | sort -k2,2n -k1,1n >a.txt
  dump left.exr $sphere_channels | sort -k2,2n -k1,1n >b.txt
  expect_less 'covered' 500 "$(awk '$3 == 1' a.txt | wc -l)"
  expect 'pixels' "$(wc -l <b.txt)" 3050
  paste -d' ' a.txt b.txt | awk '{ for (k = 1; k <= 16; k++) { d = $k - $(k + 16); if ($k != $(k + 16) && (d > 1e-5 || d < -1e-5 || d != d)) { print; exit } } }' >wrong.txt
  expect "mirrored with $options" "$(cat wrong.txt)" ''
}

# write_fbx: t.obj, with a material whose picture is on another computer's disk.
write_fbx() {
  awk '
    /^v / { points = points (n++ ? "," : "") $2 "," $3 "," $4 }
    /^f / { corners = corners (m++ ? "," : "") ($2 - 1) "," ($3 - 1) "," (-$4) }
    END {
      print "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXHeaderVersion: 1003\n FBXVersion: 7400\n}\nObjects: {"
      print " Geometry: 1, \"Geometry::t\", \"Mesh\" {\n  Vertices: *" 3 * n " {\n a: " points "\n }"
      print "  PolygonVertexIndex: *" 3 * m " {\n a: " corners "\n }"
      print "  LayerElementMaterial: 0 {\n MappingInformationType: \"AllSame\"\n ReferenceInformationType: \"IndexToDirect\"\n Materials: *1 {\n a: 0\n }\n }"
      print "  Layer: 0 {\n LayerElement: {\n Type: \"LayerElementMaterial\"\n TypedIndex: 0\n }\n }\n }"
      print " Model: 2, \"Model::t\", \"Mesh\" {\n Version: 232\n }"
      print " Material: 3, \"Material::cloth\", \"\" {\n ShadingModel: \"phong\"\n }"
      print " Texture: 4, \"Texture::cloth\", \"\" {\n FileName: \"D:\\art\\cloth.png\"\n RelativeFilename: \"..\\art\\cloth.png\"\n }"
      print "}\nConnections: {\n C: \"OO\",1,2\n C: \"OO\",2,0\n C: \"OO\",3,2\n C: \"OP\",4,3,\"DiffuseColor\"\n}" }' t.obj
}

@test "scene: the same shape in OBJ, PLY, OFF, STL and FBX gives the same guide" {
  printf 'v 0 0 0\nv 1 0 0.2\nv 0 1 0\nv 0.3 0.3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >t.obj
  printf 'OFF\n4 4 0\n0 0 0\n1 0 0.2\n0 1 0\n0.3 0.3 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n' >t.off
  {
    printf '%s\n' ply 'format ascii 1.0' 'element vertex 4' 'property float x' 'property float y' 'property float z' \
      'element face 4' 'property list uchar int vertex_indices' end_header
    sed '1,2d' t.off
  } >t.ply
  {
    echo 'solid t'
    awk '/^v/ { p[++n] = $2 " " $3 " " $4 } /^f/ { print "facet normal 0 0 0\nouter loop"; for (k = 2; k <= 4; k++) print "vertex " p[$k]; print "endloop\nendfacet" }' t.obj
    echo 'endsolid t'
  } >t.stl
  write_fbx >t.fbx
  local ending channels=normal,depth,position,object,uv,curvature,contour
  accept guide scene t.obj -s 32 -c $channels --view 40,30 --crease 0 --no-history -o obj.exr
  for ending in off ply stl fbx; do
    accept guide scene t.$ending -s 32 -c $channels --view 40,30 --crease 0 --no-history -o $ending.exr -q
    expect_same obj.exr $ending.exr
  done
}

@test "scene: an FBX file that says so has z up" {
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 5\nf 1 2 3\n' >t.obj
  write_fbx | sed '/RelativeFilename/d; /FileName/d' >y.fbx
  sed 's/^Objects: {/GlobalSettings: {\nProperties70: {\nP: "UpAxis", "int", "Integer", "",2\n}\n}\n&/' y.fbx >z.fbx
  accept info y.fbx --format json -q
  expect 'y up' "$(json - 'r.minimum.concat(r.maximum).join()' <<<"$output")" 0,0,0,1,1,5
  accept info z.fbx --format json -q
  expect 'z up' "$(json - 'r.minimum.concat(r.maximum).join()' <<<"$output")" 0,0,-1,1,5,0
}

@test "scene: a picture that an FBX file has elsewhere is looked for beside it" {
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >t.obj
  write_fbx >t.fbx
  refuse 2 cloth.png guide scene t.fbx -s 8 -c albedo -o out.exr
  oiiotool --create 2x2 3 --addc 0,1,0 -d uint8 -o cloth.png
  accept_warned 'no texture coordinates' guide scene t.fbx -s 8 -c albedo -o out.exr
  expect colours "$(dump out.exr A,albedo.R,albedo.G,albedo.B | awk '$3 == 1 { print $4, $5, $6 }' | sort -u)" '0.000000000 1.000000000 0.000000000'
}

@test "the report as JSON" {
  accept guide scene "$exemplars/creature.ply" -s 64x48 -o c.exr --format json
  expect schema "$(json - r.schema <<<"$output")" stylut-guide/1
  expect size "$(json - r.size <<<"$output")" '[64,48]'
  expect triangles "$(json - r.triangles <<<"$output")" "$(sed -n 's/^element face //p;/^end_header/q' <"$exemplars/creature.ply")"
  expect keys "$(json - 'Object.keys(r).sort().join()' <<<"$output")" covered,mesh_bytes,mpixels_per_s,peak_bytes,read_bytes,schema,size,time_ms,tree_bytes,triangles
  expect times "$(json - 'Object.keys(r.time_ms).sort().join()' <<<"$output")" build,first,read,render,trace,write
  expect 'numbers' "$(json - 'Object.values(r.time_ms).every(t => t >= 0) && r.peak_bytes > 1e6 && r.mpixels_per_s > 0' <<<"$output")" true
}

@test "text reports, and silence with --quiet" {
  accept guide sphere -s 8 -o s.exr
  expect_match report "$output" '^s.exr: 8x8, 8[0-9.]* % covered$'
  accept guide scene "$exemplars/creature.ply" -s 8 -o s.exr
  expect_holds report "$output" 'triangles; read'
  accept guide sphere -s 8 -o s.exr -q
  expect 'quiet report' "$output" ''
}

@test "--dry-run writes nothing and still checks the input" {
  accept guide sphere -s 8 -o s.exr --dry-run
  expect_holds report "$output" 'would write s.exr'
  accept guide scene "$exemplars/creature.ply" -s 8 -o s.exr --dry-run
  expect 'files' "$(list_files)" /
  refuse 2 missing.ply guide scene missing.ply -s 8 -o s.exr --dry-run
}

@test "history: version, command and input hashes, unless --no-history" {
  cp "$exemplars/creature.ply" mesh.ply
  beside check_history exr
  beside check_history png
  wait
}
check_history() { # ENDING
  local version ending=$1
  version=$("$STYLUT" --version | sed -n '1s/stylut //p')
  accept guide scene mesh.ply --view 30,10 -s 16 -o c.$ending
  accept info c.$ending --format json
  expect version "$(json - 'r.attributes["stylut:version"]' <<<"$output")" "$version"
  expect hash "$(json - 'r.attributes["stylut:input1"]' <<<"$output")" "$(sha256sum mesh.ply | cut -d' ' -f1)"
  expect command "$(json - 'r.attributes["stylut:command"]' <<<"$output")" 'stylut guide scene --view=30,10 --size=16 mesh.ply'
  accept guide scene mesh.ply --view 30,10 -s 16 -o c.$ending --no-history
  accept info c.$ending --format json
  expect attributes "$(json - 'Object.keys(r.attributes).length' <<<"$output")" 0
}

@test "an output replaces an older file, and gets the permissions of any new file" {
  (umask 027 && "$STYLUT" guide sphere -s 8 -q -o s.exr)
  expect permissions "$(stat -c %a s.exr)" 640
  echo old >s.exr
  accept guide sphere -s 8 -o s.exr
  accept info s.exr
  expect 'files' "$(list_files | wc -l)" 2
}

# A scene of two cubes from one file, side by side, and a sphere above the left one.
make_scene() {
  printf 'v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n' >cube.obj
  cat >scene.json <<'END'
{ "schema": "stylut-scene/1",
  "camera": { "type": "orthographic", "position": [0, 0, 9], "target": [0, 0, 0], "height": 8 },
  "objects": [ { "mesh": "cube.obj", "transform": [1,0,0,-2, 0,1,0,-2, 0,0,1,0, 0,0,0,1], "style": 3 },
               { "mesh": "cube.obj", "transform": [1,0,0,2, 0,1,0,-2, 0,0,1,1, 0,0,0,1] } ],
  "spheres": [ { "center": [-2, 2, 0], "radius": 1, "style": 5 } ] }
END
}

@test "a scene file: objects, spheres, styles, a camera that stands" {
  make_scene
  accept guide scene scene.json -s 8 -c all -o scene.exr
  # Two pixels a side for each: depth, id and style at (2, 6), (6, 6) and (2, 2), one world unit a pixel.
  dump scene.exr A,depth.Z,position.X,position.Y,object.I,style.I >pixels.txt
  expect 'left cube' "$(grep '^1 5 ' pixels.txt)" '1 5 1.000000000 8.000000000 -2.500000000 -1.500000000 1.000000000 3.000000000'
  expect 'right cube' "$(grep '^5 6 ' pixels.txt)" '5 6 1.000000000 7.000000000 1.500000000 -2.500000000 2.000000000 1.000000000'
  expect 'sphere' "$(grep '^2 2 ' pixels.txt | cut -d' ' -f 1-3,5-)" '2 2 1.000000000 -1.500000000 1.500000000 3.000000000 5.000000000'
  expect_near 'depth of the sphere' "$(awk '$1 == 2 && $2 == 2 { print $4 }' pixels.txt)" 8.2928932 1e-5
  expect 'covered pixels' "$(awk '$3 == 1' pixels.txt | wc -l)" 12
  accept info scene.json
  expect_holds info "$output" 'scene.json: scene of 2 object(s) from 1 mesh(es), 24 triangles, and 1 sphere(s)'
  expect_holds info "$output" 'object 2: ./cube.obj, 12 triangles, style 1, object.I 2'
  accept info scene.json --format json
  expect 'info as JSON' "$(json - '[r.kind, r.meshes, r.triangles, r.objects[0].style, r.spheres[0].id, r.minimum[0], r.maximum[1]].join()' <<<"$output")" scene,1,24,3,3,-3,3
  accept guide scene scene.json -s 8 -c all -o other.exr --dry-run
  expect_holds 'dry run' "$output" '24 triangles'
  # The scene has a camera of its own.
  refuse 1 --view guide scene scene.json --view front -s 8 -o other.exr
  refuse 1 --fov guide scene scene.json --camera perspective --fov 30 -s 8 -o other.exr
  # Paths are relative to the file.
  mkdir -p sub/folder
  mv scene.json cube.obj sub/
  accept guide scene sub/scene.json -s 8 -c all --no-history -o again.exr
  expect 'from elsewhere' "$(dump again.exr A,depth.Z,position.X,position.Y,object.I,style.I)" "$(cat pixels.txt)"
}

@test "a camera of the scene's own that looks away is named" {
  make_scene
  sed 's/"target": \[0, 0, 0\]/"target": [0, 0, 12]/' scene.json >away.json
  accept_warned "no pixel's centre shows the scene, expected its camera, at (0, 0, 9), to see it: it looks at (0, 0, 12)" \
    guide scene away.json -s 8 -o out.exr
  printf 'v 0 0 0\nv 1 1 0\nv 0.001 0 0\nf 1 3 2\n' >sliver.obj
  accept_warned "no pixel's centre shows the mesh, expected more pixels or another view" guide scene sliver.obj --view 90,0 -s 8 -o out.exr
}

@test "info lists all that a scene file says" {
  make_scene
  accept guide sphere -s 8 -o skin.png
  sed 's|"style": 3|"style": 3, "texture": "skin.png", "color": [0.5,1,1], "specular": 0.4|
    s|"spheres"|"lights": [ { "type": "point", "position": [1,2,3], "intensity": 5 },\
      { "type": "directional", "direction": [0,-1,0], "color": [1,0.5,0] } ], "ambient": 0.25, "shadows": false, "spheres"|' scene.json >full.json
  accept_warned 'no texture coordinates' info full.json
  local line
  while IFS= read -r line; do expect_holds info "$output" "$line"; done <<'END'
  camera: placed, orthographic, at (0, 0, 9), looks at (0, 0, 0), up (0, 1, 0), height 8
  light 1: point, position (1, 2, 3), intensity 5, color (1, 1, 1)
  light 2: directional, direction (0, -1, 0), intensity 1, color (1, 0.5, 0)
  ambient 0.25, shadows off
    color (0.5, 1, 1), texture ./skin.png, specular 0.4, shininess 32
    transform 1 0 0 -2, 0 1 0 -2, 0 0 1 0
    color of its mesh's file
  sphere 1: center (-2, 2, 0), radius 1, style 5, object.I 3
  texture 1: ./skin.png
END
  accept info full.json --format json -q
  expect camera "$(json - 'r.camera' <<<"$output")" '{"type":"orthographic","position":[0,0,9],"target":[0,0,0],"up":[0,1,0],"height":8}'
  expect lights "$(json - 'r.lights.map(l => [l.type, l.position || l.direction, l.intensity, l.color].join()).join(" ")' <<<"$output")" \
    'point,1,2,3,5,1,1,1 directional,0,-1,0,1,1,0.5,0'
  expect light "$(json - '[r.ambient, r.shadows].join()' <<<"$output")" 0.25,false
  expect objects "$(json - 'r.objects.map(o => [o.file, o.texture, o.color, o.specular, o.transform[3]].join()).join(" ")' <<<"$output")" \
    './cube.obj,./skin.png,0.5,1,1,0.4,-2 ./cube.obj,,,0,2'
  expect spheres "$(json - 'r.spheres.map(s => [s.center, s.radius, s.color].join()).join(" ")' <<<"$output")" -2,2,0,1,1,1,1
  expect textures "$(json - 'r.textures.map(t => t.file + t.inside_mesh).join()' <<<"$output")" ./skin.pngfalse
  sed 's/"camera": {[^}]*}/"camera": { "view": "30,20", "fov": 40 }/' scene.json >fit.json
  accept info fit.json
  expect_holds info "$output" 'camera: fitted, perspective, azimuth 30, elevation 20, up y, fov 40'
}

@test "info tells JSON files by their schema" {
  printf '{ "schema": "stylut-pairs/1", "kind": "affine", "pairs": [ { "from": [1, 2], "to": [3, 4.5] } ] }' >pairs.json
  accept info pairs.json
  expect 'pairs as text' "$output" 'pairs.json: 1 pair of points, in pixels, warp affine, alpha 1
  pair 1: from (1, 2) to (3, 4.5)'
  accept info pairs.json --format json
  expect 'pairs as JSON' "$(json - '[r.kind, r.warp, r.units, r.pairs[0].from, r.pairs[0].to].join()' <<<"$output")" pairs,affine,pixels,1,2,3,4.5
  printf '{ "schema": "stylut-bundle/1" }' >manifest.json
  refuse 3 'manifest.json:1:13: schema: found "stylut-bundle/1", expected one of "stylut-scene/1", "stylut-pairs/1"' info manifest.json
  printf '{}' >nothing.json
  refuse 3 'nothing.json:1:1: found an object, expected a key "schema"' info nothing.json
}

@test "a scene file that is wrong names its line and column" {
  make_scene
  sed 's/"style": 3/"style": 300/' scene.json >style.json
  refuse 3 'style.json:3:100: objects[0].style: found 300' guide scene style.json -s 8 -o out.exr
  sed 's/"radius"/"radios"/' scene.json >key.json
  refuse 3 'found an unknown key' guide scene key.json -s 8 -o out.exr
  sed 's/cube.obj/cone.obj/' scene.json >mesh.json
  refuse 2 'cone.obj' guide scene mesh.json -s 8 -o out.exr
  head -c 100 scene.json >short.json
  refuse 3 'short.json' guide scene short.json -s 8 -o out.exr
  refuse 3 'key.json' info key.json
  printf '{"schema": "stylut-scene/1", "objects": []}' >empty.json
  refuse 3 'empty.json: found nothing in it' guide scene empty.json -s 8 -o out.exr
}
