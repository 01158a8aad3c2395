#!/bin/sh
# Written by stylut batch: a task of a Slurm array, which does each TASKS-th step
# of a list. Lines of it: the step's number, those of the steps that must have
# been done before (with commas between; - for none), and its recipe.
# Arguments: the list, TASKS, threads of a step, and "on" to go on past failures.
list=$1 tasks=$2 threads=$3 going=$4 worst=0

# The code appears whole, once all that the step said is there.
finish() {
  echo "$2" >"slurm/$1.code.part"
  mv "slurm/$1.code.part" "slurm/$1.code"
}

are_made() {
  for maker in $(echo "$1" | tr ',' ' '); do
    [ "$maker" = - ] || [ "$(cat "slurm/$maker.code" 2>/dev/null)" = 0 ] || return 1
  done
}

while read -r step makers recipe; do
  [ -n "$step" ] || continue
  code=left
  if are_made "$makers"; then
    # shellcheck disable=SC2086 # limits are words
    "$STYLUT" step --due "$recipe" -j "$threads" $STYLUT_LIMITS 2>"slurm/$step.said" </dev/null
    code=$?
    [ $code = 0 ] || worst=$code
  fi
  finish "$step" $code
  [ $worst = 0 ] || [ "$going" = on ] || break
done <<LINES
$(awk -v task="$SLURM_ARRAY_TASK_ID" -v tasks="$tasks" 'NR % tasks == task' "$list")
LINES
exit $worst
