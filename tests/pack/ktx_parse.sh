#!/usr/bin/env bash
# Our KTX2 files through the npm package ktx-parse. Usage: ktx_parse.sh BUILD
set -euo pipefail
build=$1
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
modules=$("$here/npm.sh" "$build")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/tests/pack/write_ktx2" "$work"
"$build/stylut" pack "$root/exemplars/styles.json" -o "$work/bundle" -q
node "$here/ktx_parse.mjs" "$work" "$work/bundle" "$modules"
