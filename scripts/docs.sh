#!/usr/bin/env bash
# Builds the site from docs/ as HTML in FOLDER; warnings, e.g. of broken links, are errors. `scripts/install_packages.sh docs`
# installs Sphinx.
# usage: scripts/docs.sh [FOLDER]    default: build/docs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:-build/docs}

command -v sphinx-build >/dev/null || { echo "docs: there is no sphinx-build; run scripts/install_packages.sh docs" >&2; exit 1; }
sphinx-build -q -W --keep-going -b html -d "$folder/.doctrees" docs "$folder/html"
echo "docs: open $folder/html/index.html"
