#!/usr/bin/env bash
# Prints what an accuracy takes without and with lines of contact, and the table of docs/benchmarks/accuracy.md on hard rooms.
# usage: scripts/contact_lines.sh TOOL
set -euo pipefail
tool=${1:?usage: scripts/contact_lines.sh TOOL}
meshes=$(dirname "${BASH_SOURCE[0]}")/../meshes
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# Stated error, patches, CPU seconds.
figures() {
  "$tool" solve "$@" --sides front --quiet -o "$folder/out.vtp" --json "$folder/out.json"
  python3 -c 'import json, sys
last = json.load(open(sys.argv[1]))["accuracy"][-1]
print(f"{100 * last['"'total'"']:.2f} %, {last['"'patches'"']:,}, {last['"'cpu_seconds'"']:.1f}", end="")' "$folder/out.json"
}

grep -m1 'model name' /proc/cpuinfo | sed 's/.*: /machine: /'
echo "| scene | asked | without: stated, patches, CPU s | with: stated, patches, CPU s |"
echo "|---|---|---|---|"
row() {  # NAME ACCURACY MODEL
  echo "| $1 | $2 | $(figures "$3" --accuracy "$2" --no-contact-lines) | $(figures "$3" --accuracy "$2") |"
}
for run in "two_rooms 5%" "two_rooms 3%" "two_rooms 1%" "cornell_box 0.5%"; do
  read -r scene accuracy <<<"$run"
  row "$scene" "$accuracy" "$meshes/$scene.obj"
done
# Varied rooms; louvres takes minutes.
python3 "$(dirname "${BASH_SOURCE[0]}")/make_varied_rooms.py" "$folder/rooms" >/dev/null
for room in blocks bright colours contact corridor door_ajar empty open_side slits thin_walls tiny_lamp; do
  row "$room" 1% "$folder/rooms/$room.obj"
done
echo

# The irradiance of 200 patches of 2,000 against paths, in rooms in which faces touch, cross, or end close before others.
echo "| room | patches | chi-square of 200 | mean difference | stated error |"
echo "|---|---|---|---|---|"
python3 "$(dirname "${BASH_SOURCE[0]}")/make_contact_rooms.py" "$folder" >/dev/null
for room in shelf leg dividing_wall crossing_boxes stairs column rug lamp_down lamp_up; do
  # Light that gets out of a slit of a centimetre is met by few paths.
  paths=$([ "$room" = lamp_up ] && echo 65536 || echo 8192)
  "$tool" crosscheck "$folder/$room.obj" --patches 2000 --sample-patches 200 --paths "$paths" >"$folder/out.txt" 2>"$folder/notes.txt" || code=$?
  [ "${code:=0}" = 0 ] || [ "$code" = 5 ] || { cat "$folder/notes.txt" >&2; exit 1; }  # 5: it disagrees
  code=0
  python3 -c 'import re, sys
text = open(sys.argv[1]).read()
found = lambda pattern: re.search(pattern, text).group(1)
print("|", sys.argv[2], "|", found(r"of (\d+) patches, "), "|", found(r"chi-square (\S+)"), "|",
      found(r"mean difference (\S+)"), "% |", found(r"patches, (\S+) % as a whole"), "% |")' "$folder/out.txt" "$room"
done
