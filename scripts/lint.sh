#!/usr/bin/env bash
# Checks the format of every C++ file and the module layers; with --tidy also runs clang-tidy, when it is installed.
# usage: scripts/lint.sh [--tidy]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
clang-format --dry-run --Werror "${files[@]}"
echo "lint: ${#files[@]} files are formatted"
python3 scripts/check_layers.py

if [ "${1:-}" = --tidy ]; then
  command -v clang-tidy >/dev/null || { echo "lint: clang-tidy is not installed; left out"; exit 0; }
  cmake --preset tidy >/dev/null
  mapfile -t sources < <(git ls-files --cached --others --exclude-standard 'src/*.cpp')
  printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy -p build-tidy --quiet
  echo "lint: clang-tidy is content"
fi
