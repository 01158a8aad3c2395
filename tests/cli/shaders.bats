#!/usr/bin/env bats
# The shaders on a real frame: beside the C path, and in another reader's hands.
load helpers

setup_file() {
  [[ $STYLUT_CONFIG != sanitize ]] || return 0
  cd "$BATS_FILE_TMPDIR" || return 1
  cat >styles.json <<JSON
{ "schema": "stylut-bundle/1",
  "styles": [
    { "name": "pencil", "exemplar": "$exemplars/spheres/pencil.png" },
    { "name": "stipple", "exemplar": "$exemplars/spheres/stipple.png", "params": { "radius": 2, "depth_tolerance": 0.02 } },
    { "name": "watercolour", "exemplar": "$exemplars/spheres/watercolour.png", "lut": { "sampling": "centre" } },
    { "name": "oil", "exemplar": "$exemplars/spheres/oil.png", "params": { "threshold": 40 } },
    { "name": "charcoal", "exemplar": "$exemplars/spheres/charcoal.png", "params": { "top_level": 4, "radius": 0 } } ] }
JSON
  "$STYLUT" pack styles.json --allow-outside -q -o bundle
  "$STYLUT" guide scene "$exemplars/lit/lit.json" -s 240x200 -c normal,depth,object,luma,albedo -q -o frame.exr
  mkdir frame
  "$STYLUT_BUILD/tests/shaders/draw_frame" bundle frame.exr frame >said.txt 2>&1 || true
}

# As the Makefile has it for tests/shaders.
skip_sanitized() { [[ $STYLUT_CONFIG != sanitize ]] || skip "Mesa doesn't get through in minutes under sanitizers"; }

@test "every pass equals the C path on a real frame, in both dialects" {
  skip_sanitized
  expect 'what is said' "$(cat "$BATS_FILE_TMPDIR/said.txt")" $'330: every pass equals its twin\nes300: every pass equals its twin'
}

# see_page ANGLE RENDERER: the page as Chromium draws it with ANGLE on RENDERER.
see_page() {
  skip_sanitized
  local modules seen
  modules=$("$STYLUT_ROOT/tests/pack/npm.sh" "$STYLUT_BUILD" 2>npm.log) || { complain "npm: $(cat npm.log)"; return 1; }
  seen=$(node "$STYLUT_ROOT/tests/shaders/webgl.mjs" "$STYLUT_BUILD" "$modules" "$BATS_FILE_TMPDIR/bundle" "$BATS_FILE_TMPDIR/frame" "$1" 2>browse.log) ||
    { complain "$1: $(cat browse.log)"; return 1; }
  expect 'errors of the page' "$(json - r.errors <<<"$seen")" '[]'
  expect 'error of the passes' "$(json - r.value.error <<<"$seen")" undefined
  expect_holds renderer "$(json - r.value.renderer <<<"$seen")" "$2"
  expect_less 'pixels that are stylized' 10000 "$(json - r.value.covered <<<"$seen")"
  expect 'matches that differ' "$(json - r.value.matches <<<"$seen")" 0
  expect_less 'largest difference of colours' "$(json - r.value.colours <<<"$seen")" 2
  expect_less 'pixels that have lines' 1000 "$(json - r.value.lined <<<"$seen")"
  expect 'lines that differ' "$(json - r.value.lines <<<"$seen")" 0
  expect_less 'largest difference of toon' "$(json - r.value.toon <<<"$seen")" 2
  expect_less 'largest difference of lines laid on it' "$(json - r.value.laid <<<"$seen")" 2
}

# Mesa keeps to the precision that a shader asks for; SwiftShader always takes the highest.
@test "ktx-parse and WebGL 2 on Mesa: the bundle as it is, all passes as the C path has them" {
  see_page gl-egl llvmpipe
}

@test "ktx-parse and WebGL 2 on SwiftShader: the bundle as it is, all passes as the C path has them" {
  see_page swiftshader SwiftShader
}
