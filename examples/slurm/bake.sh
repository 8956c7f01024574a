#!/usr/bin/env bash
# One bake on all nodes of a job, a process on each:
#
#   sbatch --nodes=8 examples/slurm/bake.sh SCENE FOLDER [options of luxel bake]
#
# FOLDER is on a file system that all nodes share. A job that was ended goes on when it is submitted
# again. docs/guide/clusters.md
#SBATCH --job-name=luxel
#SBATCH --ntasks-per-node=1
#SBATCH --exclusive
set -euo pipefail
scene=$1 folder=$2
shift 2
resume=()
compgen -G "$folder/checkpoint*.luxel" >/dev/null && resume=(--resume)
exec mpirun --map-by ppr:1:node --bind-to none luxel bake "$scene" -o "$folder" "${resume[@]}" "$@"
