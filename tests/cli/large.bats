#!/usr/bin/env bats
# Large meshes: what they take, what is said before and what is shown while it lasts.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  "$STYLUT_BUILD/tests/bench/big_mesh" 2e6 torus.ply
  "$STYLUT_BUILD/tests/bench/big_mesh" 2e5 torus.obj
}
torus=$BATS_FILE_TMPDIR/torus.ply

# Sanitizers keep memory of their own.
need_plain_memory() {
  if [ "$STYLUT_CONFIG" = sanitize ]; then skip "memory of a build with sanitizers isn't the tool's"; fi
}

@test "reading a binary PLY of 2 million triangles takes at most 1.5 times its vertices and indices" {
  need_plain_memory
  local idle
  accept guide scene "$exemplars/creature.ply" -s 64 -c normal -o small.exr --format json
  idle=$(json - r.read_bytes <<<"$output")
  accept guide scene "$torus" -s 64 -c normal -o out.exr --format json
  expect bytes "$(json - r.mesh_bytes <<<"$output")" 48000000
  expect_less 'reading, over an idle process and in meshes' "$(json - "(r.read_bytes - $idle) / r.mesh_bytes" <<<"$output")" 1.5
  # With normals that no two triangles share there are more vertices, and as little beside them.
  accept guide scene "$torus" -s 64 -c normal --crease 0 -o out.exr --format json
  expect_less 'vertices' 48000000 "$(json - r.mesh_bytes <<<"$output")"
  expect_less 'reading with hard edges' "$(json - "(r.read_bytes - $idle) / r.mesh_bytes" <<<"$output")" 1.5
}

@test "beside the tree and the bands a mesh is held once" {
  need_plain_memory
  local idle peak
  accept guide scene "$exemplars/creature.ply" -s 256 -c normal -o small.exr --format json
  idle=$(json - r.peak_bytes <<<"$output")
  accept guide scene "$torus" -s 256 -c normal -o out.exr --format json
  peak=$(json - r.peak_bytes <<<"$output")
  accept guide scene "$torus" -s 256 -c normal -o out.exr --format json --dry-run
  expect_less 'peak, less the tree, over an idle process and in meshes' \
    "$(json - "($peak - r.estimate.tree_bytes - $idle) / r.estimate.mesh_bytes" <<<"$output")" 1.5
}

# estimate OPTIONS...: what --dry-run says and what is then measured agree within a tenth.
check_estimate() {
  local said
  accept guide scene "$@" -o out.exr --dry-run --format json
  said=$(json - r.estimate.peak_bytes <<<"$output")
  [ ! -e out.exr ] || complain "--dry-run wrote"
  accept guide scene "$@" -o out.exr --format json
  expect_near "$* in what was estimated" "$(json - "r.peak_bytes / $said" <<<"$output")" 1 0.1
  rm out.exr
}

@test "--dry-run estimates the most memory within a tenth" {
  need_plain_memory
  check_estimate "$torus" -s 512
  check_estimate "$torus" -s 512 -c uv,albedo # which the mesh has none of
  check_estimate "$BATS_FILE_TMPDIR/torus.obj" -s 1024 -c normal
  check_estimate "$exemplars/creature.ply" -s 2048 -c all
  check_estimate "$exemplars/box/box.json" -s 64 -c paths --spp 1
  # Wide pictures are what OpenEXR takes, textures what they are looked up in.
  check_estimate "$exemplars/creature.ply" -s 16384x64 -c all
  accept guide sphere -s 3000 -o texture.png
  cat >scene.json <<'END'
{ "schema": "stylut-scene/1", "spheres": [ { "center": [0, 0, 0], "radius": 1, "texture": "texture.png" } ] }
END
  check_estimate scene.json -s 1024 -c albedo
}

# write_crowd COUNT FILE: a scene of so many objects of one mesh, in rows.
write_crowd() {
  local i separator=
  {
    echo '{ "schema": "stylut-scene/1", "camera": { "view": "three-quarter" }, "objects": ['
    for ((i = 0; i < $1; i++)); do
      echo "$separator{ \"mesh\": \"creature.ply\", \"transform\": [1,0,0,$((i % 10 * 2)), 0,1,0,0, 0,0,1,$((i / 10 * -2)), 0,0,0,1] }"
      separator=,
    done
    echo '] }'
  } >"$2"
}

@test "objects that share a mesh: held once, and estimated so" {
  need_plain_memory
  cp "$exemplars/creature.ply" .
  write_crowd 1 one.json
  write_crowd 60 crowd.json
  local figures='(e => [e.triangles, e.mesh_bytes].join(" "))(r.estimate)' bytes
  accept guide scene one.json -s 64 -o out.exr --dry-run --format json
  bytes=$(json - r.estimate.mesh_bytes <<<"$output")
  accept guide scene crowd.json -s 64 -o out.exr --dry-run --format json
  expect 'triangles, bytes of meshes' "$(json - "$figures" <<<"$output")" "$((60 * 31632)) $bytes"
  check_estimate crowd.json -s 640x480 -c all
}

@test "--dry-run counts rays" {
  cat >scene.json <<'END'
{ "schema": "stylut-scene/1", "spheres": [ { "center": [0, 0, 0], "radius": 1 } ],
  "lights": [ { "type": "directional", "direction": [0, 0, -1] }, { "type": "directional", "direction": [0, -1, 0] } ] }
END
  local rays='(e => [e.triangles, e.camera_rays, e.paths, e.most_path_rays, e.most_shadow_rays].join(" "))(r.estimate)'
  accept guide scene scene.json -s 10x20 -c normal -o out.exr --dry-run --format json
  expect 'no light' "$(json - "$rays" <<<"$output")" '0 200 0 0 0'
  accept guide scene scene.json -s 10x20 -c luma -o out.exr --dry-run --format json
  expect luma "$(json - "$rays" <<<"$output")" '0 200 0 0 400'
  accept guide scene scene.json -s 10x20 -c LD12E --spp 4 -o out.exr --dry-run --format json
  expect 'two bounces' "$(json - "$rays" <<<"$output")" '0 200 800 1600 2000'
  accept guide scene scene.json -s 10x20 -c LDE,luma --spp 4 -o out.exr --dry-run
  expect_match text "$output" '^would write out.exr: 10x20 pixels, 0 triangles; rays: 200 from the camera, 800 light paths of at most 800 rays, at most 800 for shadows; memory: about [0-9]+ MB at its most'
}

@test "stages of a large mesh have names, in order, and a time left" {
  "$STYLUT" guide scene "$torus" -s 64 --crease 60 -o out.exr --progress json >/dev/null 2>progress.txt
  expect 'lines that are not progress' "$(grep -vcE '^\{"stage": "[a-z]+", "percent": [0-9]+, "left_s": (null|[0-9.]+)\}$' progress.txt)" 0
  sed -e '1s/^/[/; $s/$/]/; $!s/$/,/' progress.txt >progress.json
  expect stages "$(json progress.json 'r.map(p => p.stage).filter((s, i, all) => s !== all[i - 1]).join()')" reading,smoothing,building,tracing
  expect 'each begins at 0, and rises' "$(json progress.json 'r.every((p, i) => !i || r[i - 1].stage !== p.stage ? p.percent === 0 : p.percent >= r[i - 1].percent)')" true
  expect_less 'steps of reading' 2 "$(json progress.json 'r.filter(p => p.stage === "reading").length')"
  expect_less 'steps of building' 10 "$(json progress.json 'r.filter(p => p.stage === "building").length')"
  # Where it takes more than a second, some time is left in the middle, and none in the end.
  "$STYLUT" guide scene "$exemplars/box/box.json" -s 400 -c paths --spp 8 -j 1 -o out.exr --progress json >/dev/null 2>progress.txt
  sed -e '1s/^/[/; $s/$/]/; $!s/$/,/' progress.txt >progress.json
  expect 'time left' "$(json progress.json 'const t = r.filter(p => p.stage === "tracing" && p.left_s !== null); t.length > 5 && t[0].left_s > 0 && t[t.length - 1].left_s < t[0].left_s')" true
  "$STYLUT" guide scene "$torus" -s 64 -o out.exr -v >/dev/null 2>stages.txt
  expect 'stages, --verbose' "$(sed -n 's/^stylut: \([a-z]*\) took .*/\1/p' stages.txt | paste -sd,)" reading,smoothing,building,tracing
}

@test "a terminal shows stage and time left, a pipe nothing" {
  "$STYLUT" guide scene "$torus" -s 64 -q -o out.exr 2>pipe.txt
  expect 'in a pipe' "$(cat pipe.txt)" ''
  command -v script >/dev/null || skip "no script(1) to make a terminal with"
  script -qec "'$STYLUT' guide scene '$torus' -s 64 -o out.exr" /dev/null </dev/null >terminal.txt 2>&1
  local stage
  for stage in reading smoothing building tracing; do
    expect_match "$stage on a terminal" "$(tr '\r' '\n' <terminal.txt)" "$stage +\[#*\.*\] +[0-9]+ %"
  done
  script -qec "'$STYLUT' guide scene '$exemplars/box/box.json' -s 400 -c paths --spp 8 -j 1 -o out.exr" /dev/null </dev/null >terminal.txt 2>&1
  expect_match 'time left' "$(tr '\r' '\n' <terminal.txt)" 'tracing +\[#+\.*\] +[0-9]+ %, [0-9]+ (s|min) left'
}
