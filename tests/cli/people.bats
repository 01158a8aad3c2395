#!/usr/bin/env bats
# Manual pages and completion, which are made of --help.
load helpers

commands() { "$STYLUT" --help | sed -n 's/^  \([a-z]\+\)  .*/\1/p'; }
kinds=(sphere scene import strokes warp flow)

@test "a manual page for every command, which man reads without a complaint" {
  command -v help2man >/dev/null || skip 'no help2man'
  SOURCE_DATE_EPOCH=0 "$STYLUT_ROOT/tools/shell/manual.sh" "$STYLUT" man 1.2.3
  SOURCE_DATE_EPOCH=0 "$STYLUT_ROOT/tools/shell/manual.sh" "$STYLUT" again 1.2.3
  diff -r man again >/dev/null || complain 'pages made twice differ'
  local command page
  for command in $(commands) "${kinds[@]/#/guide-}"; do
    page=man/stylut-$command.1
    [ -s "$page" ] || { complain "no page $page"; continue; }
    MANWIDTH=200 man --nj --nh --warnings -l "$page" >page.txt 2>said.txt
    expect "man says of $command" "$(cat said.txt)" ''
    expect_match "$command: first line" "$(head -n 1 page.txt)" "^STYLUT-${command^^}\(1\)"
    expect_match "$command: name" "$(grep -m 1 -A 1 '^NAME' page.txt | tail -n 1)" "stylut-$command - .+"
    "$STYLUT" ${command/-/ } --help | grep -oE '^ +(-.,? +)?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+' | sort -u >options.txt
    expect "$command: options missing in its page" "$(grep -oE -- '--[a-z0-9-]+' page.txt | sort -u | comm -13 - options.txt)" ''
  done
  expect pages "$(find man -type f | wc -l)" $(($(commands | wc -l) + ${#kinds[@]} + 1))
}

# complete WORD...: what bash would offer for the last of them.
complete_in_bash() {
  # shellcheck disable=SC2016
  bash -c 'PATH=$1:$PATH; . "$2"; shift 2; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _stylut; printf "%s\n" "${COMPREPLY[@]}"' \
    bash "${STYLUT%/*}" "$STYLUT_ROOT/tools/shell/completion.bash" "$@" | sort
}

# The same of zsh, whose own functions are stood in for.
complete_in_zsh() {
  # shellcheck disable=SC2016
  zsh -f -c 'path=($1 $path); file=$2; shift 2
    compadd() { print -rl -- ${(P)2} }
    _describe() { print -rl -- ${${(P)2}%%:*} }
    _files() { print files }
    words=("$@"); CURRENT=$#; source $file' zsh "${STYLUT%/*}" "$STYLUT_ROOT/tools/shell/_stylut" "$@" | sort
}

@test "completion in bash" {
  expect commands "$(complete_in_bash stylut '' | grep -v -- --)" "$(commands | sort)"
  expect 'li' "$(complete_in_bash stylut un)" unpack
  expect kinds "$(complete_in_bash stylut guide '')" "$(printf '%s\n' "${kinds[@]}" | sort)"
  expect options "$(complete_in_bash stylut guide scene --cam)" --camera
  expect options "$(complete_in_bash stylut lut guide.exr --max-p)" --max-p99
  expect 'options of batch' "$(complete_in_bash stylut batch --jun)" --junit
  expect files "$(complete_in_bash stylut lut gui)" ''
}

@test "completion in zsh" {
  command -v zsh >/dev/null || skip 'no zsh'
  expect commands "$(complete_in_zsh stylut '')" "$(commands | sort)"
  expect kinds "$(complete_in_zsh stylut guide '')" "$(printf '%s\n' "${kinds[@]}" | sort)"
  expect_holds options "$(complete_in_zsh stylut guide scene --)" --camera
  expect_holds options "$(complete_in_zsh stylut batch m.json --)" --junit
  expect files "$(complete_in_zsh stylut lut '')" files
}

@test "doctor says what there is, and what fails" {
  accept doctor
  expect_match first "$(head -n 1 <<<"$output")" '^stylut [0-9.]+$'
  expect_holds libraries "$output" "$("$STYLUT" --version | sed -n 2p)"
  expect works "$(grep -c '^works ' <<<"$output")" 4
  accept doctor --format json
  expect checks "$(json - 'r.checks.filter(c => c.works).length + " of " + r.checks.length' <<<"$output")" '4 of 4'
  # A tool without its module reads no picture, and says so.
  cp "$STYLUT" stylut
  cp "$STYLUT_BUILD"/libstylut_{embree,assimp,flann}.so .
  mkdir scratch
  local status=0
  TMPDIR=$PWD/scratch ./stylut doctor >out.txt 2>said.txt || status=$?
  expect 'exit code' "$status" 6
  # What the checks ran has its lines, too; the last is doctor's.
  expect_holds said "$(tail -n 1 said.txt)" 'stylut: error: pictures: '
  expect_match out "$(cat out.txt)" 'FAILED +pictures '
  expect_match out "$(cat out.txt)" 'works +tables '
  expect 'left behind' "$(ls scratch)" ''
  refuse 1 "'x'" doctor x
  TMPDIR=/nowhere refuse 2 /nowhere doctor
}
