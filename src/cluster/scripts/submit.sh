#!/usr/bin/env bash
# Submits all blocks of this folder that are neither finished nor waiting or running, and a job that joins the blocks
# once all of them are finished. Run it again at any time: finished blocks stay as they are, interrupted ones go on.
#   ./submit.sh --account=mine --qos=long                  options are handed to sbatch
#   GILLESPH=/path/to/gillesph ./submit.sh                 another binary
set -euo pipefail

command -v sbatch >/dev/null || { echo "sbatch is not on the path: run this where Slurm is installed" >&2; exit 1; }
gillesph=${GILLESPH:-@BINARY@}
if [[ $gillesph == */* ]]; then gillesph=$(realpath -- "$gillesph"); fi
export GILLESPH=$gillesph
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
cd -- "$here"
mkdir -p logs
touch submitted
logs=${here//%/%%}/logs # in names of logs % has a meaning

# What waits or runs of earlier submissions.
blocks_under_way=
dependency=
merges=
queue=$(squeue --noheader --array --user="$(id -u)" --name=@JOB@,@JOB@-merge --format='%F %K')
while read -r job task; do
    if grep -qx "blocks $job" submitted; then
        blocks_under_way+=,$task
        dependency+=:${job}_$task
    elif grep -qx "merge $job" submitted; then
        merges+=" $job"
    fi
done <<<"$queue"

blocks=$("$gillesph" cluster status . --unfinished --except="$blocks_under_way")
if [[ $blocks == joined ]]; then
    echo "all blocks are finished and joined in $(dirname -- "$here")"
    exit
fi
if [[ -z $blocks && -n $merges ]]; then
    echo "nothing to submit: job$merges joins the blocks${blocks_under_way:+ once ${blocks_under_way#,} are finished}"
    exit
fi

# A merge that waits for blocks of an earlier submission would not wait for those of this one.
for job in $merges; do scancel "$job"; done
if [[ -n $blocks ]]; then
    job=$(sbatch --parsable --chdir="$here" --output="$logs/block-%4a.log" --array="$blocks" "$@" block.sh)
    job=${job%%;*}
    echo "blocks $job" >>submitted
    dependency+=:$job
    echo "blocks $blocks: job $job"
fi
job=$(sbatch --parsable --chdir="$here" --output="$logs/merge.log" --kill-on-invalid-dep=yes \
    ${dependency:+"--dependency=afterok$dependency"} "$@" merge.sh)
job=${job%%;*}
echo "merge $job" >>submitted
echo "merge: job $job"
