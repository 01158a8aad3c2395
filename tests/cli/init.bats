#!/usr/bin/env bats
# stylut init: a project that works at once, its hook, its workflow.
load helpers

# commit: as somebody, with the hook finding the tool.
commit() {
  PATH="$(dirname "$STYLUT"):$PATH" git -c user.name=a -c user.email=a@b.c -c core.hooksPath=hooks commit -qm "$1"
}

@test "a project packs and passes its checks at once" {
  accept init project
  cd project || return 1
  expect files "$(find . -type f | sort | tr '\n' ' ')" './.gitattributes ./.github/workflows/styles.yml ./.gitignore ./README.md ./hooks/pre-commit ./painted/engraving.png ./painted/gouache.png ./painted/ink.png ./styles.json '
  expect 'the hook' "$(stat -c %a hooks/pre-commit)" 755
  accept batch styles.json -o bundles --check
  accept validate bundles/styles
  expect styles "$(json bundles/styles/bundle.json 'r.styles.map(s => s.name).join()')" engraving,gouache,ink
  # What the page and the workflow say to do, as they say it.
  local line
  grep -h '^stylut \|run: stylut ' README.md .github/workflows/styles.yml | sed 's/.*stylut /stylut /; s/ *#.*//' >said
  expect 'commands that are named' "$(wc -l <said)" 2
  while read -r line; do PATH="$(dirname "$STYLUT"):$PATH" bash -c "$line" >/dev/null || complain "failed: $line"; done <said
  python3 -c 'import yaml, sys; yaml.safe_load(open(sys.argv[1]))' .github/workflows/styles.yml 2>/dev/null ||
    ! python3 -c 'import yaml' 2>/dev/null || complain 'the workflow is no YAML'
}

@test "what is there already is never written over" {
  accept init project
  local before
  before=$(cd project && find . -type f -exec sha256sum {} + | sort)
  # Ended midway: what is missing is made, to the same bytes.
  rm project/styles.json project/painted/ink.png
  accept init project
  expect 'made again' "$(cd project && find . -type f -exec sha256sum {} + | sort)" "$before"
  mkdir other
  echo mine >other/styles.json
  refuse 2 'other/styles.json: found a file with other contents' init other
  expect 'what was there' "$(cat other/styles.json) $(ls -A other)" 'mine styles.json'
  touch file
  refuse 2 file init file
  refuse 1 'expected a folder' init
}

@test "the hook refuses a commit that breaks a budget, by what is committed" {
  accept init project
  cd project || return 1
  git init -q .
  git add -A
  commit 'Styles' || complain 'the first commit was refused'
  # A style without paint: refused; it is told which.
  oiiotool painted/ink.png --mulc 1,1,1,0 -d uint8 -o painted/blank.png
  git add -A
  commit 'Blank' 2>said && complain 'a blank style was committed'
  expect_holds 'what the hook says' "$(cat said)" "'blank'"
  git rm -q --cached painted/blank.png
  commit 'Nothing' 2>/dev/null && complain 'nothing was committed'
  # It lies about, uncommitted: that is no matter.
  echo >>README.md
  git add README.md
  commit 'A line' || complain 'what lies about was looked at'
  # A budget that no table can meet.
  sed -i 's/"max-p99": 1.0/"max-p99": 0.001/' styles.json
  git add styles.json
  commit 'Too strict' 2>said && complain 'a broken budget was committed'
  expect_holds 'what the hook says' "$(cat said)" max-p99
}
