#!/usr/bin/env bash
# Builds LAMMPS from Debian's source package for this very processor: FOLDER/native_lammps (some minutes; once).
#   tests/peers/native_lammps.sh FOLDER
set -euo pipefail
folder=$(realpath "$1")
[[ -x $folder/native_lammps ]] && exit 0

.ci/install dpkg-dev libopenmpi-dev
sources=$(mktemp)
work=$(mktemp -d)
trap 'rm -rf "$sources" "$work"' EXIT
echo "deb-src http://deb.debian.org/debian bookworm main" >"$sources"
cd "$work"
apt=(-q -o Dir::Etc::sourcelist="$sources" -o Dir::Etc::sourceparts=- -o Dir::State::lists="$work/lists")
mkdir lists
apt-get "${apt[@]}" update
apt-get "${apt[@]}" -o APT::Sandbox::User=root source --download-only lammps
dpkg-source --no-check -x lammps_*.dsc source
cmake -S source/cmake -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O3 -march=native -DNDEBUG" \
  -DPKG_GRANULAR=on -DPKG_RIGID=on -DPKG_MOLECULE=on -DBUILD_MPI=on -DBUILD_OMP=off
cmake --build build
cp build/lmp "$folder/native_lammps"
