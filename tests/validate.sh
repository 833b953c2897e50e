#!/usr/bin/env bash
# Runs the physics tests and writes what they show to tests/VALIDATION.md.
#   tests/validate.sh [--long]      --long: only those that have a long variant, 1e5 to 1e8 steps (two hours on
#                                   one core), to tests/VALIDATION-LONG.md
set -euo pipefail
cd "$(dirname "$0")/.."
name=VALIDATION figures=validation filter='*'
which="Each row is an assertion of the physics tests (\`ctest -L physics\`), which fail when an error passes its tolerance."
if [[ ${1:-} == --long ]]; then
  export CAIRN_LONG=1
  name=VALIDATION-LONG figures=validation/long
  filter='IsolatedPile.*:LongRuns.*:PrecessingTop.*:QuietPile.*:RestingStacks.*'
  which="Runs of 1e5 to 1e8 steps; \`tests/VALIDATION.md\` has shorter ones of the same kind, and everything else."
fi

bash .ci/install
cmake --preset release
cmake --build --preset release --target test_physics
folder=$(mktemp -d)
trap '[[ $? == 0 ]] && rm -rf "$folder" || echo "what has been shown so far: $folder/tables.md"' EXIT
OMP_WAIT_POLICY=passive CAIRN_REPORT=$folder build/release/tests/test_physics --gtest_filter="$filter"

mkdir -p "tests/$figures"
cp "$folder"/*.svg "tests/$figures/"
{
  cat <<INTRO
# Validation

What cairn claims, against what it was checked, and how far off it is. Written by \`tests/validate.sh\` from the runs
themselves. $which Errors are absolute unless marked "rel.".
INTRO
  sed "s|(validation/|($figures/|" "$folder/tables.md"
} >"tests/$name.md"
