#!/usr/bin/env bash
# Measures what an accuracy that is asked for gives and costs in ten rooms: the table of docs/benchmarks/accuracy.md. Takes some
# twenty minutes.
# usage: scripts/accuracy_table.sh OUT [ACCURACIES [REFERENCE_PATCHES]]
# ACCURACIES are percentages, 3,1,0.3 by default. Writes OUT/rooms and OUT/accuracy.md. PATCHLIGHT_BENCHMARKS may name the
# folder of benchmark programs that are built already.
set -euo pipefail
if [ $# -lt 1 ]; then
  echo "usage: scripts/accuracy_table.sh OUT [ACCURACIES [REFERENCE_PATCHES]]" >&2
  exit 1
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
accuracies=${2:-3,1,0.3}
patches=${3:-4000}
programs=${PATCHLIGHT_BENCHMARKS:+$(cd "$PATCHLIGHT_BENCHMARKS" && pwd)}
cd "$(dirname "${BASH_SOURCE[0]}")/.."

programs=${programs:-build/tests/benchmarks}
if [ -z "${PATCHLIGHT_BENCHMARKS:-}" ]; then
  cmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build build -j "$(nproc)" --target benchmark_accuracy >/dev/null
fi
scripts/make_varied_rooms.py "$out/rooms"
{
  echo "Machine: $(nproc) processors, $(grep -m1 'model name' /proc/cpuinfo | sed 's/.*: //')"
  echo
  "$programs/benchmark_accuracy" "$patches" "$accuracies" "$out"/rooms/*.obj
} | tee "$out/accuracy.md"
