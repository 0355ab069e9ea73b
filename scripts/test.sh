#!/usr/bin/env bash
# Installs what is missing, builds patchlight and runs every test. Safe to run again.
# usage: scripts/test.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

echo "test: packages, build, then every test; the first run takes some minutes"
scripts/install_packages.sh
cmake --preset release >/dev/null
cmake --build build -j "$(nproc)"
ctest --test-dir build --output-on-failure -j "$(nproc)"
echo "test: all passed"
