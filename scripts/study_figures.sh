#!/usr/bin/env bash
# Makes the plots and the tables of docs/benchmarks/accuracy.md on what accuracy costs. Takes some four minutes.
# usage: scripts/study_figures.sh OUT
# Writes OUT/cornell_box and OUT/two_rooms, with what `patchlight convergence` prints as OUT/*.txt, and the plots of the Cornell
# box into docs/figures. PATCHLIGHT_TOOL may name a tool that is built already.
set -euo pipefail
if [ $# -ne 1 ]; then
  echo "usage: scripts/study_figures.sh OUT" >&2
  exit 1
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tool=${PATCHLIGHT_TOOL:-build/src/patchlight}

for model in cornell_box two_rooms; do
  "$tool" convergence "meshes/$model.obj" --sides front -o "$out/$model" >"$out/$model.txt"
done
for plot in error_by_cpu_second error_by_memory estimators_by_cpu_second; do
  cp "$out/cornell_box/$plot.png" "docs/figures/study_$plot.png"
done
