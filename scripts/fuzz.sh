#!/usr/bin/env bash
# Builds the fuzzers. Each tries to break a reader, or the mesher and the form factors, for some seconds or runs.
# usage: scripts/fuzz.sh SECONDS|NUMBERruns [TARGET...]    e.g. 600 or 10000runs, for each target
# targets: obj mtl ply stl off dae ifc hbjson rad xml gltf glb toml ies epw spd npy pts vtp json mesh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

given=${1:?usage: scripts/fuzz.sh SECONDS|NUMBERruns [TARGET...]}
shift
case $given in
  *runs) limit=-runs=${given%runs} ;;
  *) limit=-max_total_time=$given ;;
esac
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(obj mtl ply stl off dae ifc hbjson rad xml gltf glb toml ies epw spd npy pts vtp json mesh)

clang=$(command -v clang++-14 || command -v clang++ || true)
if [ -z "$clang" ]; then
  echo "fuzz: clang is not installed; left out"
  exit 0
fi
if ! echo 'extern "C" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }' |
    "$clang" -fsanitize=fuzzer,address -x c++ - -o /dev/null 2>/dev/null; then
  echo "fuzz: clang's runtime (libclang-rt-14-dev) is not installed; left out"
  exit 0
fi

cmake --preset fuzz -DCMAKE_CXX_COMPILER="$clang" >/dev/null
cmake --build build-fuzz -j "$(nproc)" --target fuzzers
for target in "${targets[@]}"; do
  # New finds go to a folder of their own: the corpus in tests/ stays small and chosen.
  mkdir -p "build-fuzz/found/$target" build-fuzz/broken
  echo "fuzz: $target with $limit"
  log=build-fuzz/$target.log
  # Some libraries never free their memory, so leaks are not looked for.
  if ! ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 "build-fuzz/tests/fuzz/fuzz_$target" \
      "$limit" -max_len=65536 -timeout=120 -rss_limit_mb=4096 -print_final_stats=1 \
      -artifact_prefix="build-fuzz/broken/$target-" "build-fuzz/found/$target" "tests/fuzz/corpus/$target" >"$log" 2>&1; then
    tail -n 40 "$log"
    echo "error: $target breaks; the input is in build-fuzz/broken" >&2
    exit 1
  fi
  grep -E '^Done|^stat::(slowest|peak)' "$log"
done
echo "fuzz: nothing broke"
