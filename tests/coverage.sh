#!/usr/bin/env bash
# Which lines of src/body, src/contact and src/motion do their unit tests and those of the step (src/sim) run? Ends
# with the lines that they do not and a table; fails if a folder is below the bound.
#   tests/coverage.sh [PERCENT]      default: 95
set -euo pipefail
cd "$(dirname "$0")/.."
bound=${1:-95}
build=build/coverage

bash .ci/install gcovr
cmake --preset coverage
cmake --build --preset coverage
find "$build" -name '*.gcda' -delete  # counts of earlier runs
for room in body contact motion sim; do OMP_WAIT_POLICY=passive "$build/tests/test_$room" --gtest_brief; done
gcovr --root . --object-directory "$build" --filter 'src/(body|contact|motion)/' --json "$build/lines.json" "$build"

table=$(printf '%-16s %6s %8s %8s' folder lines covered percent)
for room in body contact motion; do
  report=$(gcovr --root . --add-tracefile "$build/lines.json" --filter "src/$room/")
  echo "$report"
  table+=$'\n'$(awk -v folder="src/$room" \
    '$1 == "TOTAL" { printf "%-16s %6d %8d %7.2f%%", folder, $2, $3, 100 * $3 / $2 }' <<< "$report")
done
echo
echo "$table"
awk -v bound="$bound" 'NR > 1 && $4 + 0 < bound { printf "%s is below %g %%\n", $1, bound; low = 1 } END { exit low }' <<< "$table"
