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

@test "the lit scene: its models and pictures, and what they look like in the light" {
  mkdir lit
  "$exemplars/lit.sh" lit
  local file
  for file in urn.obj glaze.png tiles.png; do expect_same "$exemplars/lit/$file" lit/$file; done
  accept guide scene "$exemplars/lit/lit.json" -s 150x133 -c albedo,luma,style -o lit.exr
  # Where neither light comes there is the ambient 0.12 alone; the urn wears two colours.
  dump lit.exr style.I,luma.Y,albedo.R >pixels.txt
  expect_less 'floor in the shade of both lights' 50 "$(awk '$3 == 3 && $4 < 0.13 * $5' pixels.txt | wc -l)"
  expect_less 'floor in the light' 2000 "$(awk '$3 == 3 && $4 > 0.6 * $5' pixels.txt | wc -l)"
  expect_less 'dark glaze' 100 "$(awk '$3 == 2 && $5 < 0.06' pixels.txt | wc -l)"
  expect_less 'bare clay' 100 "$(awk '$3 == 2 && $5 > 0.3' pixels.txt | wc -l)"
}

@test "every style of styles.json has its sphere" {
  expect exemplars "$(json "$exemplars/styles.json" 'r.styles.map(s => s.exemplar).sort().join("\n")')" "$(cd "$exemplars" && ls spheres/*.png)"
  local file
  for file in "$exemplars"/spheres/*.png; do
    accept info "$file" --format json
    expect "size of $file" "$(json - r.size <<<"$output")" '[512,512]'
  done
}
