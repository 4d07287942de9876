#!/usr/bin/env bash
# One block of the ensemble in this folder; ./submit.sh submits it as an array job, one task a block.
#SBATCH --job-name=@JOB@
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --ntasks=1
@REQUESTS@
#SBATCH --signal=B:USR1@@WARNING@
set -euo pipefail

gillesph=${GILLESPH:-@BINARY@}
block=${SLURM_ARRAY_TASK_ID:?run ./submit.sh, which submits this script as an array job}
echo "block $block: job $SLURM_JOB_ID on ${SLURMD_NODENAME:-?}, start $((${SLURM_RESTART_COUNT:-0} + 1)), $(date)"

# USR1 comes some time before the time limit and to this script alone: gillesph is told to write what it has, and the
# task goes back to the queue. TERM (scancel, preemption) reaches gillesph from Slurm; here it only must not end the
# script first, and a second TERM would stop gillesph at once.
limit=no
signal=no
child=
trap 'limit=yes; signal=yes; [[ -z $child ]] || kill -TERM "$child"' USR1
trap 'signal=yes; [[ -n $child ]] || exit 143' TERM

"$gillesph" cluster block . "$block" --threads @THREADS@ &
child=$!
while :; do
    signal=no
    status=0
    wait "$child" || status=$?
    # A signal ends `wait` before gillesph has ended.
    [[ $signal == yes ]] || break
done

if [[ $limit == yes && $status -eq 130 ]]; then
    if [[ ${SLURM_RESTART_COUNT:-0} -lt ${GILLESPH_RESTARTS:-100} ]]; then
        echo "block $block: the time limit is near; back to the queue"
        # This ends the job. One task of an array has the number of the array as its own: number and task it must be.
        scontrol requeue "${SLURM_ARRAY_JOB_ID}_$block" && sleep 60
    else
        echo "block $block: given up after ${SLURM_RESTART_COUNT:-0} starts; allow more with GILLESPH_RESTARTS" >&2
    fi
fi
echo "block $block: exit status $status, $(date)"
exit "$status"
