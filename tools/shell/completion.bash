# shellcheck shell=bash
# Completion of stylut for bash: commands and options are those that --help lists.
_stylut() {
  local current=${COMP_WORDS[COMP_CWORD]} commands kinds=' ' words
  COMPREPLY=()
  commands=$("${COMP_WORDS[0]}" --help 2>/dev/null | sed -n 's/^  \([a-z]\+\)  .*/\1/p')
  if [ "$COMP_CWORD" = 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands --help --version" -- "$current")
    return
  fi
  words=("${COMP_WORDS[1]}")
  if [ "${words[0]}" = guide ]; then
    kinds=$("${COMP_WORDS[0]}" guide --help 2>/dev/null | sed -n 's/.*\[OPTION\.\.\.\] \([a-z]\+\).*/\1/p')
    if [ "$COMP_CWORD" = 2 ] && [[ $current != -* ]]; then
      mapfile -t COMPREPLY < <(compgen -W "$kinds" -- "$current")
      return
    fi
    [[ $'\n'$kinds$'\n' != *$'\n'${COMP_WORDS[2]}$'\n'* ]] || words+=("${COMP_WORDS[2]}")
  fi
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" "${words[@]}" --help 2>/dev/null |
      grep -oE '^ +(-.,? +)?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+')" -- "$current")
  else
    compopt -o default 2>/dev/null # file names
  fi
}
complete -F _stylut stylut
