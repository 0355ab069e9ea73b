#!/usr/bin/env bash
# Prints the figures of docs/benchmarks/accuracy.md: the Cornell box against two other renderers.
# usage: scripts/accuracy.sh FOLDER [PATCHES ...]
# FOLDER holds cornell.obj and cornell_reference.csv; without it there is nothing to compare with.
set -euo pipefail
folder=${1:-}
shift || true
if [ ! -f "$folder/cornell_reference.csv" ]; then
  echo "skipped: expected a folder with cornell_reference.csv"
  exit 0
fi
folder=$(cd "$folder" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON >/dev/null
cmake --build build -j "$(nproc)" --target benchmark_cornell_reference >/dev/null
grep -m1 'model name' /proc/cpuinfo | sed 's/.*: /machine: /'
build/tests/benchmarks/benchmark_cornell_reference "$folder" "${@:-5000}"
