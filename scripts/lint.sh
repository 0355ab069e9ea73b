#!/usr/bin/env bash
# Checks the format of every C++ file, the names in Python files, the module layers, the prose, and the comments of public
# headers. With --tidy it also runs clang-tidy, where that is installed, on all sources or on those that changed since the
# commit BASE. All sources take about an hour of one processor.
# usage: scripts/lint.sh [--tidy [BASE]]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
clang-format --dry-run --Werror "${files[@]}"
echo "lint: ${#files[@]} files are formatted"
pyflakes3 scripts tests
python3 scripts/check_layers.py
python3 scripts/check_prose.py
scripts/doxygen.sh

if [ "${1:-}" = --tidy ]; then
  command -v clang-tidy >/dev/null || { echo "lint: clang-tidy is not installed; left out"; exit 0; }
  cmake --preset tidy >/dev/null
  if [ -n "${2:-}" ]; then
    mapfile -t sources < <(git diff --name-only --diff-filter=d "$2" -- 'src/*.cpp')
  else
    mapfile -t sources < <(git ls-files --cached --others --exclude-standard 'src/*.cpp')
  fi
  [ ${#sources[@]} -eq 0 ] || printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy -p build-tidy --quiet
  echo "lint: clang-tidy is content with ${#sources[@]} files"
fi
