#!/usr/bin/env bash
# One part of a bake, as a task of a Slurm array:
#
#   sbatch --array=1-16 examples/slurm/bake_part.sh SCENE FOLDER [options of luxel bake]
#
# FOLDER is on a file system that all nodes share. docs/guide/many-machines.md
# To submit some tasks again, say how many parts there are: PARTS=16 sbatch --array=3,7 ...
#SBATCH --job-name=luxel
set -euo pipefail
scene=$1 folder=$2
shift 2
exec luxel bake "$scene" -o "$folder" --part "$SLURM_ARRAY_TASK_ID/${PARTS:-$SLURM_ARRAY_TASK_COUNT}" --quiet "$@"
