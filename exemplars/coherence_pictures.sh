#!/usr/bin/env bash
# The README's pictures of what `lut --resolve` gives, from what coherence.sh
# made: per figure the table and a piece of a frame it wasn't given, by the
# nearest, the coherent and both; and the creature turning slowly, as an APNG.
# Usage: coherence_pictures.sh STYLUT STUDY FOLDER
set -euo pipefail

stylut=$1
study=$2
out=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$out"

# Without metadata, so that the same pixels are the same bytes.
plain=(-d uint8 --compression zip:9 --eraseattrib '.*' --attrib DateTime '2000:01:01 00:00:00')

# coarse IN OUT: five bits a colour keep pictures of paint small.
coarse() {
  oiiotool "$1" --mulc 0.121569 -d uint8 -o "$scratch/coarse.tif"
  oiiotool --nosoftwareattrib "$scratch/coarse.tif" --mulc 8.225806 --clamp:max=1 "${plain[@]}" -o "$2"
}

# shellcheck disable=SC2054 # commas are oiiotool's, not the array's
{
  over_white=(--premult --create 1024x1024 3 --fill:color=1,1,1 1024x1024 --ch R,G,B,A=1 --over --ch R,G,B)
  paper=(--create 784x384 3 --fill:color=1,1,1 784x384 --chnames R,G,B)
}

# compare FIGURE X Y: above, the tables' feasible texels (red is the source's x,
# green its y); below, a piece of a frame from (X, Y).
compare() {
  local choice x=0 parts=()
  for choice in nearest coherent both; do
    # shellcheck disable=SC2054
    parts+=("$study/$1/$choice.exr" --ch u,v,error=0 --chnames R,G,B "$scratch/disc.png" --ch A,A,A --mul
      "$scratch/disc.png" --ch A,A,A --mulc -1 --addc 1 --add --swap --paste "+$x+0"
      "$study/$1/$choice.3.png" "${over_white[@]}" --cut "256x112+$2+$3" --origin +0+0 --swap --paste "+$x+272")
    x=$((x + 264))
  done
  oiiotool --no-autopremult "${paper[@]}" "${parts[@]}" -o "$scratch/compare.tif"
  coarse "$scratch/compare.tif" "$out/coherence-$1.png"
}

# animate FIGURE X Y: 240 pixels from (X, Y) while it turns slowly, there and back,
# by the nearest, the coherent and both; in grey of five bits.
animate() {
  local choice k frames=() tiles
  for k in 1 2 3 4 5 6 7 8; do
    tiles=()
    # shellcheck disable=SC2054
    for choice in nearest coherent both; do
      tiles+=("$study/$1/$choice.slow.$k.png" "${over_white[@]}" --cut "240x240+$2+$3" --ch G --chnames Y)
    done
    oiiotool --no-autopremult "${tiles[@]}" --mosaic:pad=4 3x1 -o "$scratch/strip.tif"
    coarse "$scratch/strip.tif" "$scratch/frame.$k.png"
  done
  for k in 1 2 3 4 5 6 7 8 7 6 5 4 3 2; do
    frames+=("$scratch/$(printf 'step.%02d.png' ${#frames[@]})")
    cp "$scratch/frame.$k.png" "${frames[-1]}"
  done
  apngasm "$scratch/turn.png" "${frames[@]}" 1 6 >"$scratch/apngasm.log" || {
    cat "$scratch/apngasm.log" >&2
    return 1
  }
  mv "$scratch/turn.png" "$out/coherence-$1-turning.png"
}

"$stylut" guide sphere -s 256 -c normal -o "$scratch/disc.png" -q
compare creature 430 500
compare torus 180 180
compare bust 380 180
animate creature 390 215
