#!/usr/bin/env bash
# House style: formatting, dependency rules, plain text, shell scripts.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
failed=0
complain() {
  printf '%s\n' "$*"
  failed=1
}

mapfile -t sources < <(git ls-files --cached --others --exclude-standard -- '*.c' '*.h' '*.cpp')
clang-format --dry-run --Werror "${sources[@]}" || complain "formatting: run clang-format -i"

# Who may include whom (src/<folder>/: headers of these stages, and what is beside it).
declare -A may=(
  [base]="status image parse parallel file json ceilings"
  [bridge]="status image image_io parse parallel file json ceilings version"
  [scene]="status image parse parallel file json ceilings image_io version mesh scene scene_file repair"
  [guide]="status image parse parallel file json image_io version mesh scene scene_file guide foreign strokes warp flow simplify pivots"
  [lut]="status image parse parallel file json version lut match"
  [audit]="status image parse parallel file json lut audit chart compare probe report measure runtime"
  [pack]="status image parse parallel file json ktx2 pack runtime runtime_format"
  [runtime]="runtime runtime_format"
)
for folder in "${!may[@]}"; do
  while IFS=: read -r file header; do
    name=${header#stylut/}
    name=${name%.h}
    [[ " ${may[$folder]} " == *" $name "* ]] || complain "$file: includes $header, which $folder may not"
  done < <(grep -rhoE --include='*.[ch]' --include='*.cpp' --with-filename '"stylut/[a-z0-9_]+\.h"' "src/$folder" | tr -d '"')
  while IFS=: read -r file header; do
    case $folder in
      scene | guide) near='base|bridge|scene' ;;
      bridge) near='base|bridge' ;;
      lut) near='base|bridge' ;; # CGAL's tree
      audit) near='base|lut' ;;
      pack) near='base' ;;
      *) near=$folder ;;
    esac
    [[ $header == "$folder"/* || $header =~ ^($near)/ ]] ||
      complain "$file: includes $header of another folder"
  done < <(grep -rhoE --include='*.[ch]' --include='*.cpp' --with-filename '"(base|bridge|scene|guide|lut|audit|pack|runtime)/[a-z0-9_]+\.h"' "src/$folder" | tr -d '"')
done
grep -rnE '#include "(base|bridge|scene|guide|lut|audit|pack|runtime)/' tools && complain "tools include public headers only"

mapfile -t text < <(git ls-files --cached --others --exclude-standard | grep -vE '\.(png|ply)$|^tests/fuzz/corpus/')
grep -nP '\t' "${sources[@]}" && complain "tabs in sources"
grep -nE '[[:blank:]]+$' "${text[@]}" && complain "trailing blanks"
grep -nP '[^\x00-\x7F]' "${sources[@]}" && complain "characters beyond ASCII in sources"

mapfile -t scripts < <(git ls-files --cached --others --exclude-standard -- '*.sh' '*.bash' tools/files/pre-commit)
shellcheck "${scripts[@]}" || complain "shellcheck"
exit $failed
