#!/usr/bin/env bash
# Fuzzes the readers of users' files with clang's libFuzzer, starting from the files that the repository ships.
#   tests/fuzz.sh [SECONDS]      for each reader; default: 60. An input that breaks one is left in the present folder.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
seconds=${1:-60}

bash "$root/.ci/install" clang libclang-rt-14-dev
cmake -S "$root" --preset fuzz
cmake --build "$root/build/fuzz"
corpus=$(mktemp -d)
trap 'rm -rf "$corpus"' EXIT
mkdir "$corpus"/{scene,shape}
cp "$root"/examples/*.toml "$corpus/scene"
cp "$root"/shapes_lib/*.toml "$corpus/shape"
for reader in scene shape; do
  "$root/build/fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=10 -max_len=20000 -print_final_stats=1 \
    "$corpus/$reader"
done
