#!/usr/bin/env bash
# Whole steps of cairn and of LAMMPS on the same dense packings, in turn: writes its part of tests/BENCHMARKS.md
# (a quarter of an hour; on a quiet machine).
#   tests/peers.sh [FOLDER]      FOLDER keeps the packings
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath "${1:-$(mktemp -d)}")
mkdir -p "$folder"

bash .ci/install lammps openmpi-bin
cmake --preset release
cmake --build --preset release --target bench_packing bench_step packing_data
programs=$PWD/build/release/tests
for packing in spheres tetrahedra; do
  [[ -e $folder/$packing.h5 ]] || "$programs/bench_packing" $packing "$folder/$packing.h5"
  "$programs/packing_data" "$folder/$packing.h5" "$folder/$packing.data"
done

# A line each: packing, physics, cores, code, million sphere-steps per second, contacts per sphere.
cairn() {
  for physics in friction whole; do
    for packing in spheres tetrahedra; do
      OMP_NUM_THREADS=$1 "$programs/bench_step" "$folder" --benchmark_filter="^$packing/$physics" \
        --benchmark_min_time=2 2>/dev/null |
        sed -nE "s|.* M/s=([0-9.]+).* contacts=([0-9.]+).*|$packing $physics $1 cairn \1 \2|p"
    done
  done
}
lammps() {
  for physics in friction whole; do
    for packing in spheres tetrahedra; do
      [[ $packing == spheres ]] && rigid=no || rigid=yes
      OMP_NUM_THREADS=1 mpirun --allow-run-as-root -np "$1" lmp -in tests/peers/in.packing -log none \
        -v data "$folder/$packing.data" -v rigid $rigid -v law $physics -v steps 300 |
        awk -v head="$packing $physics $1 LAMMPS" '
          /^ +[0-9]+ +[0-9.]+ *$/ { contacts = $2 }
          /^Loop time/ { speed = $9 * $12 / $4 / 1e6 }
          END { print head, speed, contacts }'
    done
  done
}
for round in 1 2 3; do
  for cores in 1 2; do
    cairn $cores
    lammps $cores
  done
done >"$folder/speeds.txt"

{
  echo "$(lmp -h | sed -n 's/.* - \([0-9].*\)/LAMMPS \1/p' | head -n 1), Debian's build; medians of three rounds in turn."
  echo
  echo "| packing | physics | cores | contacts per sphere: LAMMPS, cairn | LAMMPS | cairn | ratio |"
  echo "|---|---|---|---|---|---|---|"
  sort -k1,4 -k5,5g "$folder/speeds.txt" | awk '
    BEGIN { name["friction"] = "normal + tangential"; name["whole"] = "+ rolling + twisting + cohesion (LAMMPS: without cohesion)" }
    { key = $1 " " $2 " " $3; n = ++count[key, $4]; if (n == 2) { speed[key, $4] = $5; touch[key, $4] = $6 }
      if (!(key in seen)) { seen[key]; order[++keys] = key } }
    END { for (k = 1; k <= keys; ++k) { key = order[k]; split(key, part, " ")
      printf "| %s | %s | %d | %.2f, %.2f | %.1f | %.1f | %.1f |\n", part[1], name[part[2]], part[3],
        touch[key, "LAMMPS"], touch[key, "cairn"], speed[key, "LAMMPS"], speed[key, "cairn"],
        speed[key, "cairn"] / speed[key, "LAMMPS"] } }'
} >"$folder/peers.md"

# Between the two marks.
awk -v text="$folder/peers.md" '
  /^<!-- peers.sh: end -->/ { skip = 0 }
  !skip
  /^<!-- peers.sh: begin -->/ { skip = 1; while ((getline line < text) > 0) print line }
' tests/BENCHMARKS.md >"$folder/BENCHMARKS.md"
cp "$folder/BENCHMARKS.md" tests/BENCHMARKS.md
