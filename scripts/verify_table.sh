#!/usr/bin/env bash
# Prints the table of docs/benchmarks/accuracy.md on patchlight verify. Takes some three minutes. usage: scripts/verify_table.sh OUT
# OUT takes the JSON of each run. PATCHLIGHT_TOOL may name a tool that is built already.
set -euo pipefail
if [ $# -ne 1 ]; then
  echo "usage: scripts/verify_table.sh OUT" >&2
  exit 1
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tool=${PATCHLIGHT_TOOL:-build/src/patchlight}

echo "| model, options | patches | paths | CPU s | error bars | z, rms | mean | chi-square | verdict |"
echo "|---|---|---|---|---|---|---|---|---|"
# row MODEL PATHS OPTIONS ...: one line; a verdict other than that both agree is exit code 5.
row() {
  local json="$out/$1_$2_${*: -1}.json"
  TIMEFORMAT=%U
  local cpu
  cpu=$({ time "$tool" verify "meshes/$1.obj" --paths "$2" --json "$json" "${@:3}" >"$json.txt" 2>/dev/null || [ $? -eq 5 ]; } 2>&1)
  python3 - "$1" "$2" "$cpu" "$json.txt" "${*:3}" <<'PY'
import re, sys
model, paths, cpu, text, options = sys.argv[1:]
said = open(text).read()
z = re.search(r"root mean square (\S+) ", said)[1]
mean = re.search(r"mean difference (\S+) %", said)[1]
bars = re.search(r"the patches, (\S+) % as a whole", said)[1]
chi = re.search(r"chi-square (\S+) of", said)[1]
p = re.search(r" p = ([0-9.e+-]+)", said)[1]
patches = re.search(r"of (\d+) patches, \d+ paths", said)[1]
verdict = re.match(r"(agrees|disagrees|inconclusive):", said, re.IGNORECASE)[1].lower() + f", p = {p}"
print(f"| {model} {options} | {patches} | {paths} | {cpu} | {bars} % | {z} | {mean} % | {chi} | {verdict} |")
PY
}
row cornell_box 4096 --sides front
row cornell_box 65536 --sides front --patches 16000
row cornell_box 4096 --sides auto
row two_rooms 4096 --sides front --patches 2000
row two_rooms 4096 --sides front
row two_rooms 65536 --sides front --patches 16000
