#!/usr/bin/env bash
# The guide of a torus of 50 million triangles: what --dry-run says of it, time by stage and memory.
# Usage: giant.sh BUILD FOLDER
set -euo pipefail

build=$1
folder=$2
mesh=$folder/torus.ply
mkdir -p "$folder"
[ -e "$mesh" ] || "$build/tests/bench/big_mesh" 5e7 "$mesh"

guide() { "$build/stylut" guide scene "$mesh" --view 30,35 -s 1920x1080 -o "$folder/giant.exr" "$@"; }
guide --dry-run
guide --format json >"$folder/giant.json"
"$build/stylut" guide scene "$(dirname "$0")/../../exemplars/creature.ply" -s 64 -o "$folder/idle.exr" --format json >"$folder/idle.json"

node - "$folder" <<'END'
const { readFileSync } = require("fs")
const [giant, idle] = ["giant", "idle"].map(name => JSON.parse(readFileSync(`${process.argv[2]}/${name}.json`)))
const mb = bytes => (bytes / 1e6).toFixed(0).padStart(6) + " MB"
for (const [stage, ms] of Object.entries(giant.time_ms)) console.log(`${stage.padEnd(8)}${(ms / 1e3).toFixed(1).padStart(6)} s`)
console.log(`vertices and indices ${mb(giant.mesh_bytes)}`)
console.log(`reading, at its most ${mb(giant.read_bytes)}: ${((giant.read_bytes - idle.read_bytes) / giant.mesh_bytes).toFixed(2)} times those, over an idle process`)
console.log(`Embree, by its count ${mb(giant.tree_bytes)}`)
console.log(`all, at its most     ${mb(giant.peak_bytes)}`)
END
