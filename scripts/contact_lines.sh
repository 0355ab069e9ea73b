#!/usr/bin/env bash
# Prints the table of docs/accuracy.md: what an accuracy takes without and with lines of contact.
# usage: scripts/contact_lines.sh TOOL
set -euo pipefail
tool=${1:?usage: scripts/contact_lines.sh TOOL}
meshes=$(dirname "${BASH_SOURCE[0]}")/../meshes
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# Stated error, patches, CPU seconds.
figures() {
  "$tool" solve "$@" --sides front --quiet -o "$folder/out.vtp" --report "$folder/out.json"
  python3 -c 'import json, sys
last = json.load(open(sys.argv[1]))["accuracy"][-1]
print(f"{100 * last['"'total'"']:.2f} %, {last['"'patches'"']:,}, {last['"'cpu_seconds'"']:.1f}", end="")' "$folder/out.json"
}

grep -m1 'model name' /proc/cpuinfo | sed 's/.*: /machine: /'
echo "| scene | asked | without: stated, patches, CPU s | with: stated, patches, CPU s |"
echo "|---|---|---|---|"
for run in "two_rooms 5%" "two_rooms 3%" "two_rooms 1%" "cornell_box 0.5%"; do
  read -r scene accuracy <<<"$run"
  echo "| $scene | $accuracy | $(figures "$meshes/$scene.obj" --accuracy "$accuracy" --no-contact-lines) | $(figures "$meshes/$scene.obj" --accuracy "$accuracy") |"
done
