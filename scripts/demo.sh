#!/usr/bin/env bash
# Installs missing packages, builds patchlight and solves the Cornell box. Safe to run again.
# usage: scripts/demo.sh [PRESET]    a preset of CMakePresets.json; default: release
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

echo "demo: packages, build, then the Cornell box; the first run takes some minutes"
scripts/install_packages.sh
preset=${1:-release}
build=build
[ "$preset" = release ] || build=build-$preset
cmake --preset "$preset" >/dev/null
cmake --build "$build" -j "$(nproc)" --target patchlight_tool
mkdir -p build
"$build/src/patchlight" solve meshes/cornell_box.obj -o build/cornell_box.vtp --html build/cornell_box.html --picture build/cornell_box.png --picture-quality final
echo "demo: open build/cornell_box.html in a browser, build/cornell_box.png, or build/cornell_box.vtp in ParaView"
