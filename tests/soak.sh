#!/usr/bin/env bash
# Long runs: 2,000 frames stylized by one process under a cap of addresses, and
# 1,000 styles packed. Memory and open files may not grow, and the whole may not
# take longer than its parts by more than a tenth. Usage: soak.sh STYLUT FOLDER
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
stylut=$(realpath "$1")
mkdir -p "$2"
cd "$2"
threads=$(nproc)
failed=0
fail() {
  echo "FAIL: $*"
  failed=1
}

# watch PID FILE: its memory in KiB and its open files, ten times a second.
watch() {
  while kill -0 "$1" 2>/dev/null; do
    # shellcheck disable=SC2012 # names are numbers
    printf '%s %s\n' "$(awk '/^VmRSS/ { print $2 }' "/proc/$1/status" 2>/dev/null)" "$(ls "/proc/$1/fd" 2>/dev/null | wc -l)"
    sleep 0.1
  done >"$2"
}

# growth COLUMN FILE: the most of the last third over the most of the second.
growth() {
  awk -v c="$1" 'NF == 2 { v[++n] = $c } END { for (i = 1; i <= n; i++) { t = int(3 * (i - 1) / n); if (v[i] > m[t]) m[t] = v[i] }
    printf "%.3f", (m[1] > 0 ? m[2] / m[1] : 0) }' "$2"
}

echo "2,000 frames of 300x300, $threads threads"
"$stylut" pack "$here/../exemplars/styles.json" -q -o bundle
for i in 1 2 3 4; do
  "$stylut" guide scene "$here/../exemplars/creature.ply" --view $((10 * i)),10 -s 300 -c normal,depth,object -q -o turn.$i.exr
done
for i in $(seq 2000); do ln -sf "turn.$((i % 4 + 1)).exr" "f.$(printf %04d "$i").exr"; done
start=$EPOCHREALTIME
(ulimit -v 4000000 && exec "$stylut" stylize bundle --guide 'f.%04d.exr' -o 'o.%04d.png' --style oil --force --format json -j "$threads") >frames.json &
watch $! frames.log
wait $! || fail 'stylize'
wall=$(awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN { print 1000 * (b - a) }')
ratio=$(node -e 'const r = JSON.parse(require("fs").readFileSync("frames.json")), t = r.time_ms;
  console.log(((t.load + (t.read + t.transfer + t.blend + t.write) / process.argv[2]) / process.argv[1]).toFixed(3))' "$wall" "$threads")
drawn=$(node -p 'JSON.parse(require("fs").readFileSync("frames.json")).drawn')
printf 'frames %s, wall %.1f s, parts over whole %s, memory %s times, files %s times, peak %s MiB\n' "$drawn" "$(awk "BEGIN { print $wall / 1000 }")" \
  "$ratio" "$(growth 1 frames.log)" "$(growth 2 frames.log)" "$(node -p '(JSON.parse(require("fs").readFileSync("frames.json")).peak_bytes / 1048576).toFixed(0)')"
[ "$drawn" = 2000 ] || fail "$drawn frames"
awk "BEGIN { exit !($ratio >= 0.9) }" || fail 'the whole takes longer than its parts'
awk "BEGIN { exit !($(growth 1 frames.log) <= 1.05) }" || fail 'memory grows'
awk "BEGIN { exit !($(growth 2 frames.log) <= 1) }" || fail 'files stay open'
rm -f f.*.exr o.*.png

echo '1,000 styles of 128x128 in four bundles'
rm -rf painted out
mkdir painted
words=()
for i in $(seq 1000); do
  words+=("$here/../exemplars/spheres/oil.png" --resize 128x128 --mulc "0.$((100 + i % 800)),1,0.$((100 + i / 2)),1" -d uint8 -o "painted/$i.png")
  if [ $((i % 50)) = 0 ]; then
    oiiotool --no-autopremult "${words[@]}"
    words=()
  fi
done
for k in 0 1 2 3; do
  {
    printf '{"schema": "stylut-bundle/1", "defaults": {"lut": {"size": 64}}, "styles": ['
    for i in $(seq $((250 * k + 1)) $((250 * k + 250))); do
      [ "$i" = $((250 * k + 1)) ] || printf ','
      printf '{"name": "%s", "exemplar": "painted/%s.png"}' "$i" "$i"
    done
    printf ']}'
  } >"styles$k.json"
done
(ulimit -v 4000000 && exec "$stylut" batch styles?.json -o out --format json -j "$threads") >batch.json || fail batch
awk -v threads="$threads" -v wall="$(node -p 'JSON.parse(require("fs").readFileSync("batch.json")).time_ms')" \
  'NR > 1 && !seen[$1 " " $2]++ { sum += $2 - $1 } END { printf "wall %.1f s, steps over whole %.3f\n", wall / 1000, sum / threads / wall }' out/.stylut/.ninja_log
printf 'styles %s\n' "$(node -p 'JSON.parse(require("fs").readFileSync("batch.json")).styles')"
for k in 0 1 2 3; do "$stylut" validate "out/styles$k" -q || fail "bundle $k"; done
"$stylut" batch styles?.json -o out
exit $failed
