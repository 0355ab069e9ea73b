#!/usr/bin/env bash
# Opens a result and a series in ParaView, applies scripts/paraview_view.py, takes screenshots and compares what ParaView
# finds with the report. Fetches ParaView into FOLDER when it is not there: about 75 MB to download, 600 MB on disk.
# usage: scripts/check_paraview.sh [FOLDER [TOOL]]    default: build/paraview build/src/patchlight
# The script refuses a FOLDER that holds other files than its own.
# Without ParaView and a network it prints a note and succeeds, unless CI is set.
set -euo pipefail
checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=$(realpath -m "${1:-$checkout/build/paraview}")
tool=$(realpath -m "${2:-$checkout/build/src/patchlight}")
cd "$checkout"
out=build/paraview_check
mark=.made_by_check_paraview

as_root=()
if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi

give_up() {
  if [ -n "${CI:-}" ]; then echo "error: paraview: $1" >&2; exit 1; fi
  echo "paraview: $1; left out"
  exit 0
}

update_lists() {
  "${as_root[@]}" apt-get -qq -o DPkg::Lock::Timeout=300 update
}

install() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 install -y \
    --no-install-recommends "$@" >/dev/null
}

# The package python3-paraview would remove libvtk9-dev, which patchlight is built with: it is unpacked, not installed.
fetch_paraview() {
  [ -x "$folder/usr/bin/pvbatch" ] && return
  if [ -e "$folder" ] && [ ! -e "$folder/$mark" ] && { [ ! -d "$folder" ] || [ -n "$(ls -A "$folder")" ]; }; then
    echo "error: $folder is not a folder that this script has made; give the name of a new one" >&2
    exit 1
  fi
  echo "paraview: fetching ParaView into $folder"
  local debs
  debs=$(mktemp -d)
  chmod a+rx "$debs"
  (cd "$debs" && { apt-get -qq download paraview python3-paraview || { update_lists && apt-get -qq download paraview python3-paraview; }; }) ||
    { rm -r "$debs"; give_up "ParaView cannot be downloaded"; }
  mkdir -p "$(dirname "$folder")"
  local new
  new=$(mktemp -d "$folder.XXXXXX")
  chmod a+rx "$new"
  for deb in "$debs"/*.deb; do dpkg -x "$deb" "$new"; done
  touch "$new/$mark"
  rm -r "$debs" && rm -rf "$folder" && mv "$new" "$folder"
}

# Libraries that pvbatch needs and the machine lacks come with Debian's paraview package. Qt's part of it is not used.
complete() {
  ! env LD_LIBRARY_PATH="$libraries" ldd "$folder/usr/bin/pvbatch" | grep -q 'not found'
}

fetch_paraview
libraries="$folder/usr/lib/$(gcc -print-multiarch)"
command -v xvfb-run >/dev/null || install xvfb xauth || { update_lists && install xvfb xauth; } || give_up "there is no xvfb-run"
complete || install paraview || { update_lists && install paraview; } || give_up "libraries of ParaView are missing"

rm -rf "$out"
mkdir -p "$out"
"$tool" solve meshes/cornell_box.obj --up y --quiet --patches 8000 --json "$out/cornell_box.json" \
  -o "$out/cornell_box.vtp" -o "$out/cornell_box.ply" -o "$out/cornell_box.glb" --series "$out/cornell_box.pvd"
# ParaView wants an X server, even for pictures that nobody sees. Another one that starts at the same moment can take its
# number, and ParaView then aborts: that is tried again. The script's own verdict of faults is exit code 1.
for attempt in 1 2 3; do
  code=0
  timeout 300 xvfb-run -a -s "-screen 0 1280x1024x24" env LD_LIBRARY_PATH="$libraries" \
    PYTHONPATH="$folder/usr/lib/python3/dist-packages" "$folder/usr/bin/pvbatch" scripts/check_paraview.py "$out" cornell_box ||
    code=$?
  [ "$code" -le 1 ] && exit "$code"
  echo "paraview: pvbatch ended with $code (attempt $attempt)" >&2
  sleep 3
done
exit "$code"
