#!/usr/bin/env bash
# Measures what progressive refinement shows, with rows of form factors on demand, and prints the tables of
# docs/benchmarks/solvers.md. Takes less than a minute. usage: scripts/progressive_curve.sh OUT
# OUT takes progressive.png, the figure there, and a CSV per model.
# PATCHLIGHT_BENCHMARKS may name the folder of benchmark programs that are built already.
set -euo pipefail
if [ $# -ne 1 ]; then
  echo "usage: scripts/progressive_curve.sh OUT" >&2
  exit 1
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."

programs=${PATCHLIGHT_BENCHMARKS:-build/tests/benchmarks}
if [ -z "${PATCHLIGHT_BENCHMARKS:-}" ]; then
  cmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build build -j "$(nproc)" --target benchmark_progressive >/dev/null
fi
grep -m1 'model name' /proc/cpuinfo | sed 's/.*: /machine: /'
"$programs/benchmark_progressive" "$out" 4000 meshes/cornell_box.obj meshes/two_rooms.obj
