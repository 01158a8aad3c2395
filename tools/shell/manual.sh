#!/usr/bin/env bash
# Manual pages of all commands, of what their --help says. Usage: manual.sh STYLUT FOLDER VERSION
set -euo pipefail
stylut=$1 folder=$2 version=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$folder"

# What follows the options is laid out already.
options_end='^for any corresponding short options\.$'

# help2man runs a program of the right name, which prints what was put beside it.
# shellcheck disable=SC2016
printf '%s\n' '#!/bin/sh' 'cat "${0%/*}/help"' >"$work/stylut"
chmod +x "$work/stylut"

# page NAME SUMMARY WORD...: NAME.1, of 'stylut WORD... --help'.
page() {
  local name=$1 summary=$2
  "$stylut" "${@:3}" --help >"$work/all"
  sed "/$options_end/q" "$work/all" >"$work/help"
  help2man --no-info --version-string="$version" --name="$summary" "$work/stylut" |
    sed -e "s/^\.TH STYLUT /.TH ${name^^} /" -e "s/^stylut \\\\- /${name//-/\\\\-} \\\\- /" >"$folder/$name.1"
  sed "1,/$options_end/d" "$work/all" >"$work/notes"
  [ -s "$work/notes" ] || return 0
  {
    printf '.SH NOTES\n.nf\n'
    sed -e '/./,$!d' -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^[.']/\\\\\\&&/" "$work/notes"
    printf '.fi\n'
  } >>"$folder/$name.1"
}

page stylut 'guides, look-up tables and bundles for example-based stylization'
"$stylut" --help | sed -n 's/^  \([a-z]\+\)  *\(.*\)/\1 \2/p' | while read -r command summary; do
  page "stylut-$command" "$summary" "$command"
done
# Kinds of guides are commands of their own; how their help begins says what they do.
"$stylut" guide --help | sed -n 's/.*\[OPTION\.\.\.\] \([a-z]\+\).*/\1/p' | while read -r kind; do
  summary=$("$stylut" guide "$kind" --help | awk '/^Usage:|^  or: /{ next } !NF { done = 1 } !done { printf "%s ", $0 }')
  summary=${summary%%[:.]*}
  page "stylut-guide-$kind" "${summary,}" guide "$kind"
done
