#!/usr/bin/env bash
# Installs missing packages, builds patchlight and runs every test. Safe to run again.
# usage: scripts/test.sh [PRESET]    a preset of CMakePresets.json; default: checked, which is optimized and has asserts.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

echo "test: packages, build, then every test; the first run takes some minutes"
scripts/install_packages.sh
preset=${1:-checked}
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" -j "$(nproc)"
ctest --preset "$preset" --output-on-failure -j "$(nproc)"
echo "test: all passed"
