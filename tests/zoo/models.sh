#!/usr/bin/env bash
# Every file of Debian's assimp-testmodels, broken ones too: rendered, refused with one line and
# code 3 (or 2 for a texture that isn't there), or a format that isn't taken. Prints the tally; fails on anything else, such as a
# crash, more than one line, more than 20 seconds, or a process with more than 2 GiB.
# Usage: models.sh STYLUT
set -uo pipefail
stylut=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
most_memory=$((2 << 20)) # KiB
largest=0 largest_model=
declare -A tally=([rendered]=0 [refused]=0 [untaken]=0 [bad]=0)

# is_refusal CODE FILE
is_refusal() {
  [ "$(wc -l <"$2")" -eq 1 ] || return 1
  [ "$1" -eq 3 ] || { [ "$1" -eq 2 ] && grep -q 'No such file' "$2"; }
}

while read -r model; do
  [ -f "$model" ] || continue
  /usr/bin/time -q -f %M -o "$scratch/memory" timeout 21 "$stylut" guide scene "$model" -c normal,albedo -s 64 -q -o "$scratch/guide.exr" 2>"$scratch/error"
  code=$?
  memory=$(tail -n 1 "$scratch/memory") # the most that stylut, or the process that imports, held
  if [ "$memory" -gt "$largest" ]; then largest=$memory largest_model=${model##*/}; fi
  if [ "$memory" -gt $most_memory ]; then
    outcome=bad
    printf 'models: %s: found %d KiB of memory, expected at most %d\n' "$model" "$memory" $most_memory >&2
  elif [ $code -eq 0 ]; then
    outcome=rendered
  elif is_refusal "$code" "$scratch/error"; then
    if grep -q 'found the file ending' "$scratch/error"; then outcome=untaken; else outcome=refused; fi
  else
    outcome=bad
    printf 'models: %s: found code %d and %s, expected a guide or one line and code 2 or 3\n' "$model" $code \
      "$(head -c 300 "$scratch/error" | tr '\n' ' ')" >&2
  fi
  tally[$outcome]=$((tally[$outcome] + 1))
done < <(dpkg -L assimp-testmodels)
printf 'assimp-testmodels: %d rendered, %d refused with a line, %d of formats that are not taken, %d otherwise\n' \
  "${tally[rendered]}" "${tally[refused]}" "${tally[untaken]}" "${tally[bad]}"
printf 'the most memory: %d MiB, for %s\n' $((largest >> 10)) "$largest_model"
[ "${tally[bad]}" -eq 0 ]
