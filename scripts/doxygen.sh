#!/usr/bin/env bash
# Doxygen's pages of the public headers, in FOLDER/html. Fails on every warning; only members of types may go without a
# comment, where their names say all. Without doxygen it prints a note and succeeds, unless CI is set.
# usage: scripts/doxygen.sh [FOLDER]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:-build/doxygen}

if ! command -v doxygen >/dev/null; then
  echo "doxygen: there is no doxygen; apt-get install --no-install-recommends doxygen"
  [ -z "${CI:-}" ]
  exit
fi
mkdir -p "$folder"
doxygen - >"$folder/warnings.txt" 2>&1 <<EOF
PROJECT_NAME = patchlight
INPUT = include
RECURSIVE = YES
FILE_PATTERNS = *.h
STRIP_FROM_PATH = include
STRIP_FROM_INC_PATH = include
OUTPUT_DIRECTORY = $folder
GENERATE_LATEX = NO
HAVE_DOT = NO
QUIET = YES
WARN_NO_PARAMDOC = NO
EOF
if grep -vE 'Member .* of (struct|class) .* is not documented' "$folder/warnings.txt"; then
  echo "error: doxygen: warnings, see above" >&2
  exit 1
fi
echo "doxygen: $(find "$folder/html" -name '*.html' | wc -l) pages in $folder/html, no warnings"
