#!/usr/bin/env bash
# The main job: builds cairn, makes two rubble piles, spins them up until they shed, draws and tabulates them.
#   examples/rubble_piles.sh [OUTPUT FOLDER]      default: out
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out}
mkdir -p "$out"

bash .ci/install
echo "building cairn, a few minutes; compiler output goes to $out/build.log"
cmake --preset release >"$out/build.log"
cmake --build --preset release --target cairn >>"$out/build.log" || { tail -n 40 "$out/build.log"; exit 1; }
cairn=build/release/cairn

# Small piles gain little from several threads, so the two run side by side on one core each.
export OMP_NUM_THREADS=1
pids=()
for pile in diamonds mixed; do
  "$cairn" run "examples/$pile.toml" --force -o "$out/$pile.h5" > >(sed "s/^/[$pile] /") 2> >(sed -u "s/^/[$pile] /" >&2) &
  pids+=($!)
done
trap 'kill "${pids[@]}" 2>/dev/null' INT TERM
for pid in "${pids[@]}"; do wait "$pid"; done
unset OMP_NUM_THREADS

"$cairn" shape list --sheet "$out/shapes.png"
"$cairn" render "$out/diamonds.h5" "$out/mixed.h5" --at settle,failure,last -o "$out/piles.png"
"$cairn" summary "$out/diamonds.h5" "$out/mixed.h5" | tee "$out/summary.txt"
echo "pictures and numbers are in $out/"
