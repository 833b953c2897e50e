#!/usr/bin/env bash
# Measures gravity and writes its part of tests/BENCHMARKS.md: error against cost, and what error and interval do
# to a collapse and to the critical period of a pile (an hour on one core).
#   tests/gravity.sh [FOLDER]      FOLDER keeps the runs of the study, so that it can be stopped and go on
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-$(mktemp -d)}
mkdir -p "$folder"

bash .ci/install
cmake --preset release
cmake --build --preset release --target gravity_report gravity_study
export OMP_NUM_THREADS=1
{
  build/release/tests/gravity_report tests/validation
  printf '\n### What a run feels of it\n\n'
  build/release/tests/gravity_study "$folder/study" 3
} >"$folder/gravity.md"

# Between the two marks.
awk -v text="$folder/gravity.md" '
  /^<!-- gravity.sh: end -->/ { skip = 0 }
  !skip
  /^<!-- gravity.sh: begin -->/ { skip = 1; while ((getline line < text) > 0) print line }
' tests/BENCHMARKS.md >"$folder/BENCHMARKS.md"
cp "$folder/BENCHMARKS.md" tests/BENCHMARKS.md
