#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# One patient per task of a Slurm job array, for a site where nothing may wait beside the queue:
#   palpate batch patients.tsv -o cohort --requests
#   sbatch --array=1-$(ls cohort/.batch/requests | wc -l) --mem=8G --chdir="$PWD" pipelines/slurm_array.sh cohort
#   palpate batch patients.tsv -o cohort        (when all have ended: builds what is missing, writes the page)
set -eu
: "${SLURM_ARRAY_TASK_ID:?is not set: this is run by sbatch --array}"
batch=$(realpath "$1")/.batch
request=$(find "$batch/requests" -name '*.json' | sort | sed -n "${SLURM_ARRAY_TASK_ID}p")
cd "$(dirname "$(cat "$batch/table")")"
exec palpate build --request "$request" --threads "${SLURM_CPUS_PER_TASK:-1}" --force
