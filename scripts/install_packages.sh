#!/usr/bin/env bash
# Installs the Debian packages that patchlight is built and tested with, and web-ifc, which reads IFC files in Node.js,
# into src/input/ifc/node_modules; does nothing when all are there. `docs` adds the packages that build the site.
# usage: scripts/install_packages.sh [docs]
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache git
  libeigen3-dev libembree-dev libopenmesh-dev libgeos-dev libvtk9-dev libtbb-dev libboost-dev
  libtinyobjloader-dev libassimp-dev libtinygltf-dev libstb-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libpugixml-dev libdraco-dev libmeshoptimizer-dev libssl-dev zlib1g-dev libcairo2-dev libopenexr-dev libjs-three pkg-config
  libgtest-dev python3 pybind11-dev python3-dev python3-numpy python3-scipy python3-meshio pyflakes3 clang-format clang-tidy clang-14 libclang-rt-14-dev dpkg-dev file locales
)

docs=(python3-sphinx python3-myst-parser furo python3-sphinxcontrib.bibtex libjs-mathjax)
[ "${1:-}" != docs ] || packages+=("${docs[@]}")

# Node.js of any origin will do.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)

# install_debian PACKAGE...
install_debian() {
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "error: these packages are missing and there is no sudo: $*" >&2; exit 1; }
    as_root=(sudo)
  fi
  echo "packages: installing $* (up to 190 MB to download)"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
  echo "packages: done"
}

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "packages: all present"
else
  install_debian "${missing[@]}"
fi

# The lock file has the version of web-ifc and its hash, which npm checks. A copy of the lock file marks the end.
ifc=$(cd "$(dirname "$0")/../src/input/ifc" && pwd)
if cmp -s "$ifc/package-lock.json" "$ifc/node_modules/patchlight-lock.json"; then
  echo "web-ifc: present"
else
  npm ci --prefix "$ifc" --ignore-scripts --no-audit --no-fund --prefer-offline --loglevel error
  cp "$ifc/package-lock.json" "$ifc/node_modules/patchlight-lock.json"
  echo "web-ifc: done"
fi
