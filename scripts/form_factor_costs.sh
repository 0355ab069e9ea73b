#!/usr/bin/env bash
# Measures what form factors cost and what they are worth, and prints the tables of docs/form_factors.md. Takes about half
# an hour. usage: scripts/form_factor_costs.sh OUT [--resume]
# OUT takes the rooms, Google Benchmark's JSON, and the references: matrices with many more samples. References that are
# there already are used again, with --resume JSON too; remove them when the sampling has changed.
# PATCHLIGHT_BENCHMARKS may name the folder of benchmark programs that are built already.
set -euo pipefail
if [ $# -lt 1 ] || [ $# -gt 2 ] || [ "${2:---resume}" != --resume ]; then
  echo "usage: scripts/form_factor_costs.sh OUT [--resume]" >&2
  exit 1
fi
resume=${2:-}
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."

programs=${PATCHLIGHT_BENCHMARKS:-build/tests/benchmarks}
if [ -z "${PATCHLIGHT_BENCHMARKS:-}" ]; then
  cmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build build -j "$(nproc)" --target benchmark_form_factors benchmark_form_factor_errors >/dev/null
fi
python3 scripts/make_rooms.py "$out" >/dev/null
cp meshes/two_rooms.obj meshes/two_rooms.mtl "$out"

# measure PROGRAM KIND ROOM PATCHES [ARGUMENTS ...]: writes KIND_ROOM_PATCHES.json
measure() {
  local json="$out/$2_$3_$4.json"
  if [ -n "$resume" ] && [ -f "$json" ]; then return; fi
  echo "measuring: $2, $3, ${4/#0/its own} patches" >&2
  "$programs/benchmark_$1" "$out/$3.obj" "$4" "${@:5}" --benchmark_out="$json.part" --benchmark_out_format=json \
    >/dev/null 2>"$out/log" || { cat "$out/log" >&2; exit 1; }
  mv "$json.part" "$json"
}

# curve ROOM PATCHES RUNS: error against cost on one thread; so many runs of all settings in random order.
curve() {
  measure form_factors curve "$1" "$2" --benchmark_filter='assemble/.*threads:1' --benchmark_repetitions="$3" \
    --benchmark_enable_random_interleaving=true
}

# errors ROOM PATCHES SAMPLES: against a reference with so many samples for a small form factor, docs/theory/occluded-form-factors.md.
errors() {
  measure form_factor_errors errors "$1" "$2" "$out/$1_$2_$3.reference" "$3"
}

curve closed_room_10 0 3
curve closed_room_20 0 3
curve two_rooms 2000 3
curve two_rooms 8000 1
curve boxes_500 5000 1
measure form_factors large closed_room_40 0 \
  --benchmark_filter='assemble/samples:(4|8|16)/'
measure form_factors rays closed_room_20 0 --benchmark_filter=shadow_rays
measure form_factors rays two_rooms 2000 --benchmark_filter=shadow_rays
measure form_factors threads closed_room_20 0 --benchmark_filter=second_thread
errors closed_room_10 0 1600
errors closed_room_20 0 400
errors two_rooms 2000 400

grep -m1 'model name' /proc/cpuinfo | sed 's/.*: /machine: /'
python3 scripts/form_factor_tables.py "$out"
