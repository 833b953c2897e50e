#!/usr/bin/env bash
# Runs every physics test and writes what they show to tests/VALIDATION.md.
#   tests/validate.sh [--long]      --long: also the runs of 1e5 to 1e8 steps (hours)
set -euo pipefail
cd "$(dirname "$0")/.."
[[ ${1:-} != --long ]] || export CAIRN_LONG=1

bash .ci/install
cmake --preset release
cmake --build --preset release --target test_physics
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
OMP_WAIT_POLICY=passive CAIRN_REPORT=$folder build/release/tests/test_physics

mkdir -p tests/validation
cp "$folder"/*.svg tests/validation/
{
  cat <<'INTRO'
# Validation

What cairn claims, against what it was checked, and how far off it is. Written by `tests/validate.sh` from the runs
themselves; each row is an assertion of the physics tests (`ctest -L physics`), which fail when an error passes its
tolerance. Errors are absolute unless marked "rel.".
INTRO
  cat "$folder/tables.md"
} >tests/VALIDATION.md
