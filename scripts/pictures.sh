#!/usr/bin/env bash
# Makes the pictures of docs/benchmarks/pictures.md, and prints what the final one takes in processor seconds.
# usage: scripts/pictures.sh [TOOL]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tool=${1:-build/src/patchlight}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$tool" solve meshes/two_rooms.obj --patches 2000 -o "$folder/rooms.vtp" -q
for quality in draft final; do
  "$tool" render meshes/two_rooms.obj --solution "$folder/rooms.vtp" --picture-quality "$quality" --size 480x480 \
    -o "docs/figures/picture_$quality.png" -q
done
TIMEFORMAT='800 x 800 at 1 %%: %U CPU s, %R s'
time "$tool" render meshes/two_rooms.obj --solution "$folder/rooms.vtp" -o "$folder/final.png" -q
