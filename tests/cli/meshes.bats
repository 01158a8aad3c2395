#!/usr/bin/env bats
# Meshes as they come: stylut guide scene --repair and --simplify, stylut info MESH.
load helpers

cube_points=('-1 -1 -1' '1 -1 -1' '1 1 -1' '-1 1 -1' '-1 -1 1' '1 -1 1' '1 1 1' '-1 1 1')
write_off() { # FACE...
  printf '%s\n' OFF "8 $# 0" "${cube_points[@]}"
  printf '3 %s\n' "$@"
}
clean=('0 3 2' '0 2 1' '4 5 6' '4 6 7' '0 1 5' '0 5 4' '2 3 7' '2 7 6' '1 2 6' '1 6 5' '0 4 7' '0 7 3')

write_cubes() {
  write_off "${clean[@]}" >clean.off
  # Turned: 0 3 2, 4 5 6 and 0 5 4; twice: 4 5 6 and 0 2 1; repeated indices twice.
  write_off '0 2 3' '0 2 1' '4 6 5' '0 0 1' "${clean[@]:3:2}" '4 5 6' '0 4 5' '0 2 1' "${clean[@]:6}" '0 0 0' >dirty.off
  # Without its front.
  write_off "${clean[@]:0:2}" "${clean[@]:4}" >open.off
}

# Figures of a repair or a survey, in the order of the words.
get() { json - "(s => [${2//,/,s.}].join(' '))(${1})" <<<"$output"; }

skip_without_cgal() {
  if [[ ${STYLUT_BUILD##*/} = *-nocgal ]]; then skip 'a build without CGAL'; fi
}

@test "info tells what is broken" {
  write_cubes
  local words='s.points,triangles,repeated_index_faces,degenerate_faces,duplicate_triangles,non_manifold_edges,holes,border_edges,connected_components'
  accept info clean.off --format json
  expect 'clean cube' "$(get r.survey "$words")" '8 12 0 0 0 0 0 0 1'
  expect schema "$(json - 'r.schema + r.kind' <<<"$output")" stylut-info/1mesh
  accept info dirty.off --format json
  expect 'dirty cube' "$(get r.survey "$words")" '8 14 2 0 2 0 0 0 1'
  expect_less 'clashing edges' 0 "$(json - r.survey.clashing_edges <<<"$output")"
  accept info open.off --format json
  expect 'open cube' "$(get r.survey "$words")" '8 10 0 0 0 0 1 4 1'
  accept info open.off
  expect_holds report "$output" '1 hole(s) of 4 border edges'
  refuse 2 missing.off info missing.off
}

@test "a dirty cube is repaired and renders as the clean one" {
  skip_without_cgal
  write_cubes
  local view=(--view 30,20 --crease 120 -s 64 -c normal,depth,object --no-history)
  accept guide scene clean.off "${view[@]}" -o clean.exr
  accept_warned 'neighbours wound against each other' guide scene dirty.off "${view[@]}" -o dirty.exr
  expect_other clean.exr dirty.exr
  accept guide scene dirty.off "${view[@]}" --repair -o repaired.exr --format json
  expect repair "$(get r.repair s.removed,turned,manifold)" '2 3 true'
  expect triangles "$(json - r.triangles <<<"$output")" 12
  accept compare clean.exr repaired.exr --fail 1e-5
  accept guide scene clean.off "${view[@]}" --repair -o same.exr
  expect_same clean.exr same.exr
}

@test "what was found, mended and remains is said" {
  skip_without_cgal
  write_cubes
  local whole='remains: nothing; surfaces are closed and wound one way'
  accept guide scene clean.off -s 16 --repair -o a.exr
  expect_holds clean "$output" 'repair: nothing to remove or to turn, nothing was changed'
  expect_holds clean "$output" "$whole"
  accept guide scene dirty.off -s 16 --repair -o a.exr
  expect_holds dirty "$output" 'repair: 2 duplicate triangle(s) removed, 3 turned round'
  expect_holds dirty "$output" "$whole"
  expect_match dirty "$output" 'before:[[:space:]]+14 triangles on 8 points'
  accept guide scene open.off -s 16 --repair -o a.exr
  expect_holds open "$output" 'nothing was changed'
  expect_holds open "$output" 'remains: 1 hole(s) of 4 border edges, which aren'"'"'t filled'
  # Twice the same, and open.
  write_off "${clean[@]:0:2}" "${clean[@]:4}" "${clean[0]}" >both.off
  accept guide scene both.off -s 16 --repair -o a.exr
  expect_holds both "$output" 'repair: 1 duplicate triangle(s) removed, 0 turned round'
  expect_holds both "$output" 'remains: 1 hole(s) of 4 border edges'
  # A fin on an edge, and triangles that have nothing to do with each other.
  write_off "${clean[@]}" '0 1 6' >fin.off
  accept guide scene fin.off -s 16 --repair -o a.exr
  expect_holds fin "$output" 'remains: 2 edge(s) of three or more triangles, 0 wound against each other'
  expect_holds fin "$output" 'remains: 1 hole(s) of 1 border edges'
  expect 'wrong word' "$(grep -cE 'manifold|nothing; surfaces' <<<"${output%%before:*}")" 0
  printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' '0 0 1' '1 0 1' '0 1 1' >loose.obj
  printf 'f %s\n' '1 2 3' '4 5 6' >>loose.obj
  accept guide scene loose.obj -s 16 --repair -o a.exr
  expect_holds loose "$output" 'remains: loose triangles, no two of which share an edge'
  accept guide scene fin.off -s 16 --repair -o a.exr --format json
  expect 'what is left' "$(get r.repair.left s.non_manifold_edges,holes)" '2 1'
}

@test "a hole stays a hole" {
  skip_without_cgal
  write_cubes
  accept guide scene open.off -s 32 --repair -o open.exr --format json
  expect holes "$(json - r.repair.found.holes <<<"$output")" 1
  accept guide scene open.off -s 32 -c depth -o before.exr --no-history
  accept guide scene open.off -s 32 -c depth --repair -o after.exr --no-history
  expect_same before.exr after.exr
}

@test "a soup renders" {
  # Triangles anywhere, some through others, some sharing an edge by threes.
  awk 'BEGIN { srand(7); for (i = 0; i < 600; i++) printf "v %.4f %.4f %.4f\n", rand(), rand(), rand()
    for (i = 1; i <= 600; i += 3) print "f", i, i + 1, i + 2
    for (i = 1; i <= 300; i += 3) { print "f", i, i + 1, i + 3; print "f", i + 1, i, i + 5 } }' >soup.obj
  accept guide scene soup.obj -s 48 -o soup.exr --format json -q
  expect_less covered 200 "$(json - r.covered <<<"$output")"
  skip_without_cgal
  accept guide scene soup.obj -s 48 --repair -o repaired.exr --format json
  expect manifold "$(json - r.repair.manifold <<<"$output")" false
  accept guide scene soup.obj -s 48 --simplify auto --max-error 2 -o simple.exr --format json
  expect_less 'error' "$(json - r.simplify.normal_deg.p99 <<<"$output")" 2.000001
}

@test "simplified: reported, within the budget, and the same for any number of threads" {
  skip_without_cgal
  awk -v shape=torus -f "$exemplars/shapes.awk" | awk '1' >torus.obj
  local options=(torus.obj --view three-quarter -s 128 --simplify auto --max-error 2 --no-history)
  accept guide scene "${options[@]}" -o a.exr -j 1 --format json
  expect keys "$(json - 'Object.keys(r.simplify).sort().join()' <<<"$output")" \
    compared,full,normal_deg,search_ms,silhouette_px,simple,simpler,trials
  expect_less p99 "$(json - r.simplify.normal_deg.p99 <<<"$output")" 2.000001
  expect_less silhouette "$(json - r.simplify.silhouette_px <<<"$output")" 0.500001
  expect_less 'triangles' "$(json - r.triangles <<<"$output")" 10000
  expect 'triangles traced' "$(json - 'r.triangles === r.simplify.simple.triangles' <<<"$output")" true
  expect_less memory "$(json - r.simplify.simple.tree_bytes <<<"$output")" "$(json - r.simplify.full.tree_bytes <<<"$output")"
  accept guide scene "${options[@]}" -o b.exr -j 3
  expect_same a.exr b.exr
  expect_match report "$output" 'simplified: [0-9]+ of 102400 triangles'
  expect_holds report "$output" 'verified: normals change by'
}

@test "simplified: where nothing can go, the mesh stays and that is said" {
  skip_without_cgal
  write_cubes
  accept guide scene clean.off -s 32 --view 30,20 --simplify auto -o c.exr --no-history
  expect_holds report "$output" 'simplified: no; all 12 triangles stay, since nothing can be removed'
  accept guide scene clean.off -s 32 --view 30,20 -o full.exr --no-history
  expect_same c.exr full.exr
}

@test "simplified: why all triangles stay" {
  skip_without_cgal
  write_cubes
  accept guide scene clean.off -s 16 --simplify 12 -o c.exr
  expect_holds 'as many' "$output" 'simplified: no; all 12 triangles stay, since 12 were asked for'
  accept guide scene clean.off -s 16 --crease 0 --simplify 8 -o c.exr
  expect_holds 'hard edges' "$output" 'simplified: no; all 12 triangles stay, since nothing can be removed'
  accept guide scene clean.off -s 16 --crease 0 --simplify 8 -o c.exr --format json
  expect 'figures' "$(get r.simplify s.simpler,trials,compared)" 'false 0 0'
  accept guide scene "$exemplars/creature.ply" -s 512 --simplify auto --max-error 0.001 -o c.exr
  expect_match 'no budget' "$output" 'stay, since none of [1-9][0-9]* trial\(s\) kept normals within 0.001 degrees'
  accept guide scene clean.off -s 16 --simplify 8 --dry-run -o never.exr
  expect_holds 'dry run' "$output" '12 triangles (--simplify is left out of a dry run); rays'
  accept guide scene clean.off -s 16 --repair --dry-run -o never.exr
  expect_holds 'dry run without' "$output" '12 triangles; rays'
}

@test "simplified: every mesh of a scene" {
  skip_without_cgal
  awk -v shape=torus -f "$exemplars/shapes.awk" >torus.obj
  awk 'BEGIN { n = 40; for (j = 0; j <= n; j++) for (i = 0; i <= n; i++) print "v", i / 10, j / 10, 0
    for (j = 0; j < n; j++) for (i = 0; i < n; i++) { a = j * (n + 1) + i + 1; print "f", a, a + 1, a + n + 2, a + n + 1 } }' >wall.obj
  cat >scene.json <<'END'
{ "schema": "stylut-scene/1", "objects": [
  { "mesh": "torus.obj", "transform": [1,0,0,-2, 0,1,0,0, 0,0,1,0, 0,0,0,1] },
  { "mesh": "torus.obj", "transform": [0.5,0,0,2, 0,0.5,0,0, 0,0,0.5,1, 0,0,0,1] },
  { "mesh": "wall.obj", "transform": [2,0,0,-4, 0,2,0,-4, 0,0,1,-1, 0,0,0,1], "style": 2 } ] }
END
  accept guide scene scene.json -s 96 --simplify auto --max-error 2 -c normal,object -o s.exr --format json
  expect 'full' "$(json - r.simplify.full.triangles <<<"$output")" $((2 * 102400 + 3200))
  expect_less 'simple' "$(json - r.simplify.simple.triangles <<<"$output")" 20000
  expect_less p99 "$(json - r.simplify.normal_deg.p99 <<<"$output")" 2.000001
}

@test "what is refused" {
  write_cubes
  refuse 1 --simplify guide scene clean.off -s 8 --simplify some -o out.exr
  refuse 1 --simplify guide scene clean.off -s 8 --simplify 0 -o out.exr
  refuse 1 --simplify guide scene clean.off -s 8 --simplify 2.5 -o out.exr
  refuse 1 --max-error guide scene clean.off -s 8 --max-error 1 -o out.exr
  refuse 1 --max-error guide scene clean.off -s 8 --simplify 8 --max-error 1 -o out.exr
  refuse 1 --max-error guide scene clean.off -s 8 --simplify auto --max-error 181 -o out.exr
  refuse 1 --max-error guide scene clean.off -s 8 --simplify auto --max-error nan -o out.exr
  refuse 1 --previous guide scene clean.off -s 8 --simplify auto --previous clean.off -o out.exr
  # Before anything is read.
  refuse 1 'found a picture of 9000x9000' guide scene missing.off -s 9000 --simplify auto -o out.exr
  refuse 2 missing.off guide scene missing.off -s 9000 --repair -o out.exr
  refuse 1 --repair guide sphere -s 8 --repair -o out.exr
  refuse 1 --simplify guide sphere -s 8 --simplify auto -o out.exr
}

@test "a build without CGAL says so" {
  [[ ${STYLUT_BUILD##*/} = *-nocgal ]] || skip 'a build with CGAL'
  write_cubes
  refuse 5 CGAL guide scene dirty.off -s 8 --repair -o out.exr
  refuse 5 CGAL guide scene clean.off -s 8 --simplify auto -o out.exr
}

@test "neighbours that clash are warned of where normals are computed from them" {
  # Two of the cube's triangles turned round, with nothing else wrong: one side's four edges clash.
  write_off '0 2 3' '0 1 2' "${clean[@]:2}" >turned.off
  write_off "${clean[@]}" >clean.off
  accept_warned 'turned.off: found 4 edges' guide scene turned.off -s 16 -o out.exr
  accept guide scene clean.off -s 16 -o out.exr
  accept guide scene turned.off -s 16 -c depth,uv -o out.exr
  accept guide scene turned.off -s 16 --flat -o out.exr
  skip_without_cgal
  accept guide scene turned.off -s 16 --repair -o out.exr
}

@test "fewer triangles than can be: said so" {
  skip_without_cgal
  # A ball whose poles have a vertex for each triangle.
  awk 'BEGIN { pi = atan2(0, -1); for (r = 0; r <= 16; r++) for (c = 0; c <= 32; c++) {
    a = pi * r / 16; b = 2 * pi * c / 32; print "v", sin(a) * cos(b), cos(a), sin(a) * sin(b); print "vt", c / 32, r / 16 }
    for (r = 0; r < 16; r++) for (c = 0; c < 32; c++) { i = r * 33 + c + 1
      printf "f %d/%d %d/%d %d/%d %d/%d\n", i, i, i + 1, i + 1, i + 34, i + 34, i + 33, i + 33 } }' >ball.obj
  accept_warned "triangles stay, expected 50" guide scene ball.obj --simplify 50 -s 64 -o out.exr
  accept guide scene ball.obj --simplify 600 -s 64 -o out.exr
}
