#!/usr/bin/env bash
# Measures what building and testing takes on a bare machine: a copy of the last commit in a scratch folder, nothing
# compiled before, nothing taken from the compiler cache. Prints the table of docs/contributing.md. Takes about half an
# hour of two processors, with .ci/run an hour. usage: scripts/build_times.sh [SCRIPT...]
# SCRIPT: what is timed, in this order; default: scripts/demo.sh scripts/test.sh. Each finds what those before it left.
# What .ci/run says of its steps goes to standard error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
timed=("$@")
[ ${#timed[@]} -gt 0 ] || timed=(scripts/demo.sh scripts/test.sh)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
git clone -q . "$scratch/patchlight"
cd "$scratch/patchlight"
scripts/install_packages.sh >&2
export CCACHE_RECACHE=1  # what is compiled is kept for later, but nothing is taken
echo "Machine: $(nproc) processors, $(grep -m1 'model name' /proc/cpuinfo | sed 's/.*: //'), load before: $(cut -d' ' -f1 /proc/loadavg)"
echo
echo "| script | CPU min | wall min |"
echo "|---|---|---|"
TIMEFORMAT='%U %S %R'
for script in "${timed[@]}"; do
  if ! { time bash "$script" >"$scratch/log" 2>&1; } 2>"$scratch/times"; then
    tail -n 30 "$scratch/log" >&2
    exit 1
  fi
  grep '^ci:' "$scratch/log" >&2 || true
  awk -v script="$script" '{ printf "| `%s` | %.1f | %.1f |\n", script, ($1 + $2) / 60, $3 / 60 }' "$scratch/times"
done
