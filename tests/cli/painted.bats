#!/usr/bin/env bats
# The committed artwork is what its programs make today.
load helpers

make_program() { # NAME
  local build=build/${STYLUT_BUILD##*/} suffix=${STYLUT_BUILD##*/"$STYLUT_CONFIG"}
  local arguments=(config="$STYLUT_CONFIG")
  [[ $suffix != *-nocgal ]] || arguments+=(CGAL=0)
  suffix=${suffix%-nocgal}
  [ -z "$suffix" ] || arguments+=(CC="${suffix#-}")
  make -s -C "$STYLUT_ROOT" "${arguments[@]}" "$build/$1" >make.log 2>&1 || { cat make.log; return 1; }
}

@test "the painted spheres" {
  make_program paint
  mkdir spheres
  "$STYLUT_BUILD/paint" spheres
  local file
  expect files "$(ls spheres)" "$(ls "$exemplars/spheres")"
  for file in "$exemplars"/spheres/*; do expect_same "$file" "spheres/${file##*/}"; done
}

@test "the creature" {
  "$STYLUT" --version | grep -q 'CGAL [0-9]' || skip "built without CGAL, which meshes it"
  make_program creature
  "$STYLUT_BUILD/creature" creature.ply
  expect_same creature.ply "$exemplars/creature.ply"
}

@test "every style of styles.json has its sphere" {
  expect exemplars "$(json "$exemplars/styles.json" 'r.styles.map(s => s.exemplar).sort().join("\n")')" "$(cd "$exemplars" && ls spheres/*.png)"
  local file
  for file in "$exemplars"/spheres/*.png; do
    accept info "$file" --format json
    expect "size of $file" "$(json - r.size <<<"$output")" '[512,512]'
  done
}
