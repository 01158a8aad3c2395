#!/usr/bin/env bats
# stylut batch --executor slurm, on a cluster of one node that this file starts.
load helpers

# say_free_port: one that nobody listens at.
say_free_port() { node -e 'const s = require("net").createServer().listen(0, () => { console.log(s.address().port); s.close(); });'; }

start_slurm() {
  local folder=$1 node user
  node=$(hostname -s)
  user=$(id -un)
  mkdir -p "$folder/state" "$folder/spool"
  (umask 077 && head -c 128 /dev/urandom >"$folder/munge.key")
  munged --force --key-file="$folder/munge.key" --socket="$folder/munge.sock" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" 3>&- >/dev/null 2>&1 || return 1
  cat >"$folder/slurm.conf" <<CONF
ClusterName=stylut
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$(say_free_port)
SlurmdPort=$(say_free_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.sock
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
KillWait=1
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=10000,bf_interval=1
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$folder/slurm.conf
  slurmctld 3>&- >/dev/null 2>&1 || return 1
  slurmd 3>&- >/dev/null 2>&1 || return 1
  local i
  for i in $(seq 100); do
    sinfo -h 2>/dev/null | grep -q idle && return 0
    sleep 0.2
  done
  cat "$folder"/slurm*.log
  return 1
}

setup_file() {
  cd "$BATS_FILE_TMPDIR" || return 1
  start_slurm "$BATS_FILE_TMPDIR/cluster"
}

teardown_file() {
  local daemon pid
  for daemon in slurmd slurmctld munged; do
    pid=$(cat "$BATS_FILE_TMPDIR/cluster/$daemon.pid" 2>/dev/null) || continue
    kill "$pid" 2>/dev/null || continue
    while kill -0 "$pid" 2>/dev/null; do sleep 0.1; done
  done
}

# paint: two manifests of three styles in all, one with a scene for a guide and a budget for its table.
paint() {
  mkdir -p painted
  local style
  for style in oil ink wash; do
    oiiotool --no-autopremult "$exemplars/spheres/oil.png" --resize 64x64 -d uint8 -o painted/$style.png
  done
  oiiotool painted/wash.png --mulc 1,0.5,0.2,1 -d uint8 -o painted/wash.png
  printf 'v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >spike.obj
  printf '{"schema": "stylut-scene/1", "objects": [{"mesh": "spike.obj"}]}\n' >spike.json
  printf '{"schema": "stylut-bundle/1", "defaults": {"lut": {"size": 32}, "check": {"max-p99": 20}},
    "styles": [{"glob": "painted/*.png"}]}\n' >"all of them.json"
  printf '{"schema": "stylut-bundle/1", "styles": [{"name": "spike", "exemplar": "painted/oil.png", "guide": "spike.json",
    "base": 2, "lut": {"budget": {"mean": 90}}}]}\n' >scene.json
}

# same_bundles A B
same_bundles() {
  local bundle file
  for bundle in 'all of them' scene; do
    for file in exemplars guides luts params jitter; do expect_same "$1/$bundle/$file.ktx2" "$2/$bundle/$file.ktx2"; done
  done
}

@test "the same bytes as on one machine, and the same rules for what is due" {
  paint
  accept batch 'all of them.json' scene.json --check --executor slurm -j 2 -o far --format json
  expect 'steps' "$(printf '%s' "$output" >far.json && json far.json '[r.styles, r.failed, r.done === r.steps].join()')" 4,0,true
  accept batch 'all of them.json' scene.json --check -o near
  same_bundles far near
  accept validate far/scene
  accept batch 'all of them.json' scene.json --check --executor slurm -o far
  expect_holds 'nothing changed' "$output" ' 0 steps done'
  # Whoever did them: ninja finds the same steps done, and Slurm those of ninja.
  accept batch 'all of them.json' scene.json --check --executor slurm -o near
  expect_holds 'after ninja' "$output" ' 0 steps done'
  # One painting is repainted: its layer, nobody's table.
  oiiotool painted/ink.png --mulc 0.5,0.5,1,1 -d uint8 -o painted/ink.png
  accept batch 'all of them.json' scene.json --check --executor slurm -o far --dry-run
  expect_holds 'foretold' "$output" 'all of them: exemplars'
  local before
  before=$(stat -c %Y%i far/.stylut/'all of them'/luts/001.ktx2 far/scene/bundle.json)
  accept batch 'all of them.json' scene.json --check --executor slurm -o far
  accept batch 'all of them.json' scene.json --check -o near
  same_bundles far near
  expect 'tables and the other bundle' "$(stat -c %Y%i far/.stylut/'all of them'/luts/001.ktx2 far/scene/bundle.json)" "$before"
  # A mesh that a scene names.
  printf 'v 0.3 0.2 1.5\nf 1 2 5\n' >>spike.obj
  accept batch scene.json --executor slurm -o far
  accept batch scene.json -o near
  expect_same far/scene/guides.ktx2 near/scene/guides.ktx2
}

@test "a style that fails: told, its dependants left, the rest done where that is asked for" {
  paint
  sed -i 's/"max-p99": 20/"max-p99": 0.0001/' 'all of them.json'
  local code=0
  "$STYLUT" batch 'all of them.json' scene.json --check -k --executor slurm --junit far.xml --format json -o far >far.json 2>said || code=$?
  expect 'exit code' $code 6
  expect_holds 'what it says' "$(cat said)" "max-p99"
  expect failed "$(json far.json 'r.failed')" 3
  expect bundles "$(ls far)" scene
  xmllint --noout far.xml || complain 'JUnit XML is none'
  code=0
  "$STYLUT" batch 'all of them.json' scene.json --check -k --format json -o near >near.json 2>/dev/null || code=$?
  expect 'exit code of ninja' $code 6
  expect 'counts of both' "$(json far.json '[r.steps, r.done, r.failed].join()')" "$(json near.json '[r.steps, r.done, r.failed].join()')"
  code=0
  "$STYLUT" batch 'all of them.json' --check --executor slurm -q -o strict 2>said || code=$?
  expect 'exit code of the first' $code 6
  refuse 1 'expected it with --executor slurm' batch scene.json --sbatch=--partition=main -o x
  code=0
  "$STYLUT" batch scene.json --executor slurm --sbatch=--partition=nowhere -o none 2>said || code=$?
  expect 'exit code without such a partition' $code 5
  expect_holds 'what sbatch says' "$(cat said)" 'partition'
  PATH=/nowhere "$STYLUT" batch scene.json --executor slurm -o none 2>said && complain 'a batch without Slurm passed'
  expect_holds 'without Slurm' "$(cat said)" "expected Slurm's programs in PATH"
}

@test "ended midway, or its jobs cancelled, the next run goes on and gives the same bytes" {
  paint
  accept batch 'all of them.json' scene.json -o near
  local pause
  for pause in 0.3 1 2.5; do
    timeout -s KILL $pause "$STYLUT" batch 'all of them.json' scene.json --executor slurm -o far -q 2>/dev/null || true
  done
  accept batch 'all of them.json' scene.json --executor slurm -o far
  same_bundles far near
  expect 'jobs that are left' "$(squeue -h)" ''
  rm -r far
  (code=0; "$STYLUT" batch 'all of them.json' scene.json --executor slurm -o far >/dev/null 2>said || code=$?; echo $code >code) &
  until [ -n "$(squeue -h 2>/dev/null)" ]; do sleep 0.1; done
  scancel -n stylut
  wait
  expect 'exit code' "$(cat code)" 4
  expect_holds 'what is said' "$(cat said)" 'Slurm ended it before it was done'
  accept batch 'all of them.json' scene.json --executor slurm -o far
  same_bundles far near
}
