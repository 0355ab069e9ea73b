#!/usr/bin/env bash
# Checks the one-definition rule over the whole tool: link-time optimization compares the classes and functions of all
# files that have one name, and different ones are an error. Takes some minutes of one processor.
# usage: scripts/check_odr.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cmake --preset odr >/dev/null
cmake --build build-odr -j "$(nproc)" --target patchlight_tool
echo "odr: every name has one definition"
