#!/usr/bin/env bash
# Installs what is needed, builds everything and runs the tests.
#   tests/run.sh [PRESET] [CTEST OPTIONS ...]     default: release
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
shift || true

bash .ci/install
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" "$@"
