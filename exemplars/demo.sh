#!/usr/bin/env bash
# The whole way, step by step: from a mesh and painted spheres to stylized
# pictures. Usage: demo.sh STYLUT FOLDER
set -euo pipefail

stylut=$1
out=$2
here=$(cd "$(dirname "$0")" && pwd)
styles=(pencil stipple watercolour oil charcoal)
side=512        # of the exemplars
frame=900x1024 # of the stylized pictures

mkdir -p "$out"
out=$(cd "$out" && pwd)
declare -A took

say() { printf '%s\n' "$*" >&2; }

# step NAME COMMAND...: runs it and adds its milliseconds to NAME.
step() {
  local name=$1 start=${EPOCHREALTIME/./}
  shift
  "$@"
  took[$name]=$((${took[$name]:-0} + (${EPOCHREALTIME/./} - start) / 1000))
}

say "creature: guide of the frame, $frame"
step frame "$stylut" guide scene "$here/creature.ply" --view three-quarter -s $frame -o "$out/frame.exr" -q

manifest=$out/styles.json
printf '{ "schema": "stylut-bundle/1",\n  "styles": [' >"$manifest"
separator=
for style in "${styles[@]}"; do
  say "$style: guide, table, check"
  step "$style guide" "$stylut" guide sphere -s $side -c normal -o "$out/$style.guide.exr" -q
  step "$style lut" "$stylut" lut "$out/$style.guide.exr" -s 256 --sampling unorm8 -o "$out/$style.lut.exr" -q
  step "$style check" "$stylut" check "$out/$style.lut.exr" --guide "$out/$style.guide.exr" \
    --max-mean 0.5 --max-p99 2 --min-coverage 0.999 -q
  printf '%s\n    { "name": "%s", "exemplar": "%s/spheres/%s.png",\n      "guide": "%s.guide.exr", "lut": "%s.lut.exr" }' \
    "$separator" "$style" "$here" "$style" "$style" "$style" >>"$manifest"
  separator=,
done
printf ' ] }\n' >>"$manifest"

say "bundle of ${#styles[@]} styles"
step pack "$stylut" pack "$manifest" --allow-outside -o "$out/bundle" -q
step validate "$stylut" validate "$out/bundle" -q
for style in "${styles[@]}"; do
  say "$style: stylize"
  step "$style stylize" "$stylut" stylize "$out/bundle" --guide "$out/frame.exr" --style "$style" -o "$out/$style.png" \
    --nnf "$out/$style.nnf.png" --chunks "$out/$style.chunks.png" -q
done

# The contact sheet, a column per style: exemplar, its guide, its table, the
# stylized creature. Each lies on white paper with a little air around.
# shellcheck disable=SC2054 # commas are oiiotool's, not the array's
on_paper=(--premult --fit:pad=1 380x380 --origin +10+10
  --create 400x400 3 --fill:color=1,1,1 400x400 --ch R,G,B,A=1 --over --ch R,G,B)
sheet=()
for style in "${styles[@]}"; do sheet+=("$here/spheres/$style.png" "${on_paper[@]}"); done
for style in "${styles[@]}"; do
  # shellcheck disable=SC2054
  sheet+=("$out/$style.guide.exr" --ch normal.X,normal.Y,normal.Z,A --mulc 0.5,0.5,0.5,1 --addc 0.5,0.5,0.5,0
    --chnames R,G,B,A "${on_paper[@]}")
done
# shellcheck disable=SC2054
for style in "${styles[@]}"; do
  sheet+=("$out/$style.lut.exr" --ch u,v,error,A=1 --chnames R,G,B,A --mulc 1,1,4,1 "${on_paper[@]}")
done
for style in "${styles[@]}"; do sheet+=("$out/$style.png" "${on_paper[@]}"); done
say "contact sheet"
step sheet oiiotool --no-autopremult "${sheet[@]}" --mosaic ${#styles[@]}x4 -d uint8 -o "$out/contact.png"

printf '\n%-12s %9s %9s %9s %9s\n' 'time, ms' guide lut check stylize
for style in "${styles[@]}"; do
  printf '%-12s %9d %9d %9d %9d\n' "$style" "${took[$style guide]}" "${took[$style lut]}" "${took[$style check]}" \
    "${took[$style stylize]}"
done
printf '%-12s %9d\n' "frame guide" "${took[frame]}" pack "${took[pack]}" validate "${took[validate]}"
printf '\n%s\n' "look at $out/contact.png"
