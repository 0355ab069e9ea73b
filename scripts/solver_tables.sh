#!/usr/bin/env bash
# Measures what every solver needs and writes the tables of docs/benchmarks/solvers.md. Takes some ten minutes.
# usage: scripts/solver_tables.sh OUT
# Writes OUT/solvers.md. PATCHLIGHT_BENCHMARKS may name the folder of benchmark programs that are built already.
set -euo pipefail
if [ $# -ne 1 ]; then
  echo "usage: scripts/solver_tables.sh OUT" >&2
  exit 1
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."

programs=${PATCHLIGHT_BENCHMARKS:-build/tests/benchmarks}
if [ -z "${PATCHLIGHT_BENCHMARKS:-}" ]; then
  cmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build build -j "$(nproc)" --target benchmark_solvers >/dev/null
fi
{
  echo "Machine: $(nproc) processors, $(grep -m1 'model name' /proc/cpuinfo | sed 's/.*: //')"
  echo
  "$programs/benchmark_solvers" meshes/two_rooms.obj
} >"$out/solvers.md.part"
mv "$out/solvers.md.part" "$out/solvers.md"
