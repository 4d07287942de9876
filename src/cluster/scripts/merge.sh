#!/usr/bin/env bash
# Joins the blocks of the ensemble in this folder; ./submit.sh submits it to run once all of them are finished.
#SBATCH --job-name=@JOB@-merge
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --ntasks=1
@REQUESTS@
set -euo pipefail

gillesph=${GILLESPH:-@BINARY@}
exec "$gillesph" cluster merge .
