#!/usr/bin/env bats
# Commands that a signal ends leave nothing behind, and their next run finishes the work.
load helpers

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  printf '{ "schema": "stylut-bundle/1", "styles": [ { "name": "oil", "exemplar": "oil.png" } ] }\n' >m.json
  cp "$exemplars/spheres/oil.png" .
  "$STYLUT" guide scene "$exemplars/creature.ply" -s 300 -c all -q -o frame.exr
  "$STYLUT" guide sphere -s 300 -q -o sphere.exr
  "$STYLUT" pack m.json -q -o packed
}

# end SIGNAL SECONDS COMMAND...: ends it after so long; its status.
end() {
  local number=$1 after=$2 status=0
  shift 2
  timeout --signal="$number" --foreground "$after" env --default-signal=INT,TERM,HUP "$STYLUT" "$@" -q 2>/dev/null || status=$?
  return $status
}

# hit COMMAND...: ended at many moments it leaves what was there; then it does its work.
hit() {
  local number moment ended=0 before after
  before=$(find . | sort)
  for number in INT TERM HUP; do
    for moment in 1 2 3 5 8 13 21 34 55 89 144 233; do
      end $number "$(awk "BEGIN { print $moment / 1000 }")" "$@" || ended=$((ended + 1))
      after=$(find . | sort)
      rm -rf made*
      [ "$(grep -v '^./made[^/.]*\(\.[a-z0-9]\{2,4\}\)\?\(/[^/]*\)\?$' <<<"$after")" = "$before" ] ||
        complain "'stylut $*' ended by $number after $moment ms: left $(diff <(echo "$before") <(echo "$after") | grep '^>' | tr '\n' ' ')"
    done
  done
  expect_less "times that 'stylut $*' was ended" 0 $ended
  "$STYLUT" "$@" -q || complain "'stylut $*' fails after it was ended"
  rm -rf made*
}

@test "signals leave no temporary files and folders" {
  bring m.json oil.png frame.exr sphere.exr packed
  hit guide scene "$exemplars/creature.ply" -s 700 -c all -o made.exr
  hit lut sphere.exr -s 512 -o made.exr
  hit pack m.json -o made
  hit unpack packed -o made
  hit stylize packed --guide frame.exr -o made.png --chunks made2.png --nnf made3.png
  hit outline --guide frame.exr -o made.png
}

@test "a bundle in whose place another is packed is whole at any moment" {
  bring m.json oil.png packed
  local moment
  for moment in 20 60 100 150 200 250 300 350; do
    end TERM "0.$(printf %03d $moment)" pack m.json -o packed || true
    "$STYLUT" validate packed -q || complain "ended after $moment ms: no whole bundle"
    expect 'folders' "$(find . -maxdepth 1 -name 'packed*' | wc -l)" 1
  done
}

@test "a reader that goes away ends a command in silence, with its files whole" {
  bring sphere.exr
  local status=0
  "$STYLUT" lut sphere.exr -s 64 -q -o wanted.exr --no-history
  { "$STYLUT" lut sphere.exr -s 64 --no-history -o made.exr --format json 2>said || echo $? >status; } | sleep 0
  expect 'what is said' "$(cat said)" ''
  expect_same made.exr wanted.exr
}

@test "a file that may not grow: one line, nothing left" {
  bring frame.exr packed
  local before
  before=$(find . | sort)
  for command in "guide sphere -s 900 -o made.exr" "stylize packed --guide frame.exr -o made.png" "unpack packed -o made"; do
    # shellcheck disable=SC2086
    (ulimit -f 64 && complain_unless_refused 2 made $command) || complain "'stylut $command' passes"
    expect 'files' "$(find . | sort)" "$before"
  done
}
