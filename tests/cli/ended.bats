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
  "$STYLUT" lut sphere.exr -s 64 -q -o table.exr
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

# At so many random moments of each command.
moments=${STYLUT_MOMENTS:-8}

# Of what a command has made so far.
made_sums() {
  find . -name 'made*' -type f -exec sha256sum {} + | sort
}

# strike COMMAND... -o made: ended at any moment, by any signal, what it makes is whole or not there, and its next run
# does the work. Only SIGKILL may leave what has a temporary name.
strike() {
  local number start took k
  start=${EPOCHREALTIME/./}
  "$STYLUT" "$@" -q || complain "'stylut $*' fails"
  took=$((${EPOCHREALTIME/./} - start))
  made_sums >whole.txt
  rm -rf made*
  for k in $(seq "$moments"); do
    number=$(shuf -n 1 -e INT TERM HUP KILL)
    end "$number" "$(awk -v t=$took -v r=$RANDOM 'BEGIN { print 1.1 * t * r / 32768 / 1e6 }')" "$@" || true
    [ "$number" = KILL ] || [ -z "$(find . -regex '.*made[^/]*\.[0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f]\(/.*\)?')" ] ||
      complain "'stylut $*' ended by $number left $(find . -name 'made*' | tr '\n' ' ')"
    find . -regextype posix-extended -depth -regex '.*\.[0-9a-f]{6}' -exec rm -rf {} +
    made_sums | comm -23 - whole.txt >odd.txt
    [ ! -s odd.txt ] || complain "'stylut $*' ended by $number left something else than what it makes: $(cat odd.txt)"
    # A signal may come when all is made: there is nothing left to do then.
    if [ $((k % 4)) = 0 ] && ! made_sums | cmp -s - whole.txt; then
      "$STYLUT" "$@" -q || complain "'stylut $*' fails after it was ended by $number"
      expect "what 'stylut $*' makes after it was ended" "$(made_sums)" "$(cat whole.txt)"
    fi
    rm -rf made*
  done
  rm -rf made* whole.txt odd.txt
}

@test "at random moments, by any signal" {
  bring m.json oil.png frame.exr sphere.exr packed
  strike guide sphere -s 400 -o made.exr
  strike guide scene "$exemplars/creature.ply" -s 300 -o made.exr
  strike guide strokes oil.png -o made.exr
  strike lut sphere.exr -s 512 -o made.exr
  strike report "$BATS_FILE_TMPDIR/table.exr" --guide sphere.exr -o made.html
  strike pack m.json -o made
  strike unpack packed -o made
  strike stylize packed --guide frame.exr -o made.png --nnf made3.png
  strike toon --guide frame.exr -o made.png
  strike outline --guide frame.exr -o made.png
}

@test "a batch that is ended ends its steps" {
  bring m.json oil.png
  local i
  sed -i 's/"oil.png"/"oil.png", "base": 9, "lut": {"size": 1024, "resolve": "coherent"}/' m.json # which takes seconds
  for i in 0.3 0.6 0.9; do
    timeout --signal=TERM --foreground $i "$STYLUT" batch m.json -o out -q 2>/dev/null || true
    sleep 0.3
    # ninja and its steps work in that folder.
    expect 'programs that go on' "$(readlink /proc/[0-9]*/cwd 2>/dev/null | grep -c "^$PWD/out" || true)" 0
    expect 'temporary files' "$(find out -regextype posix-extended -regex '.*\.[0-9a-f]{6}' 2>/dev/null)" ''
  done
  accept batch m.json -o out
}
