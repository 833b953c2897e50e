#!/usr/bin/env bash
# The same collisions of two aggregates in LAMMPS and in cairn, and their differences term by term: writes
# tests/LAMMPS.md and its figures. Fails when a difference is left that the terms do not explain.
#   tests/lammps.sh      skipped where LAMMPS (the program lmp) is absent and cannot be installed
set -euo pipefail
cd "$(dirname "$0")/.."

command -v lmp >/dev/null || bash .ci/install lammps >/dev/null 2>&1 || true
if ! command -v lmp >/dev/null; then
  echo "skipped: LAMMPS (lmp) is not here and could not be installed"
  exit 0
fi
bash .ci/install
cmake --preset release
cmake --build --preset release --target compare_lammps
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$PWD
cp tests/lammps/in.collision "$folder"
(cd "$folder" && OMP_NUM_THREADS=1 "$root/build/release/tests/compare_lammps")

mkdir -p tests/validation
cp "$folder"/lammps-*.svg tests/validation/
version=$(lmp -h | sed -n 's/.* - \([0-9].*\)/\1/p')
insert=(-e "s/@VERSION@/${version%%$'\n'*}/")
for table in results terms momentum mass; do
  insert+=(-e "/^@${table^^}@\$/{" -e "r $folder/$table.md" -e d -e "}")
done
sed "${insert[@]}" tests/lammps/report.md >tests/LAMMPS.md
echo "written: tests/LAMMPS.md"
