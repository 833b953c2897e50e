#!/usr/bin/env bash
# Fits spheres to the five boulders of meshes/ and to the grains beside the repository, if there are any, and
# writes what a budget buys to tests/FITS.md. Half an hour of one core.
set -euo pipefail
cd "$(dirname "$0")/.."
bash .ci/install
cmake --preset release
cmake --build --preset release --target fit_table
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
meshes=(meshes/boulder?.obj)
for grain in ../shared/meshes/{*rock*.obj,*stone*.ply,*grain*.stl}; do
  [[ -f $grain ]] && meshes+=("$grain")
done
OMP_WAIT_POLICY=passive build/release/tests/fit_table "$folder" "${meshes[@]}"
cp "$folder"/*.svg tests/validation/
{
  cat <<'INTRO'
# Spheres for meshes

What a budget of N spheres buys (`cairn shape fit MESH --spheres N`), written by `tests/fits.sh`. RMS: of the distances
between the surface of the mesh and that of the spheres' union, both directions together (20 000 points each, exact
distances), in radii of the ball of the mesh's volume. `greedy`: inscribed balls of the medial axis, each the one that
adds most volume. Volume and inertia: relative errors of the union (a shape's bodies take them from the mesh, exactly).
INTRO
  cat "$folder/fits.md"
} >tests/FITS.md
