#!/usr/bin/env bash
# Installs the npm packages that tests use, once, and prints their folder. Usage: npm.sh BUILD
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
modules=$1/tests/pack/npm
mkdir -p "$modules"
if ! cmp -s "$here/package-lock.json" "$modules/package-lock.json"; then
  cp "$here/package.json" "$here/package-lock.json" "$modules/"
  npm ci --prefix "$modules" --no-audit --no-fund >&2 || { rm -f "$modules/package-lock.json"; exit 1; }
fi
echo "$modules/node_modules"
