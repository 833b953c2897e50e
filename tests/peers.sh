#!/usr/bin/env bash
# Whole steps of cairn (on each instruction set of the machine), of Debian's LAMMPS, of LAMMPS compiled for this
# processor and of LIGGGHTS on the same dense packings, in turn, and of cairn on more packings: writes its part of
# tests/BENCHMARKS.md (an hour; on a quiet machine).
#   tests/peers.sh [FOLDER] [ROUNDS]      FOLDER keeps the packings and LAMMPS; default of ROUNDS: 3
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath "${1:-$(mktemp -d)}")
mkdir -p "$folder"

rounds=${2:-3}

bash .ci/install lammps liggghts openmpi-bin
tests/peers/native_lammps.sh "$folder"
cmake --preset release
cmake --build --preset release --target cairn bench_packing bench_step packing_data
programs=$PWD/build/release/tests
for packing in spheres tetrahedra cubes needles sizes few_spheres few_tetrahedra; do
  [[ -e $folder/$packing.h5 ]] || "$programs/bench_packing" $packing "$folder/$packing.h5"
done
for packing in spheres tetrahedra sizes; do "$programs/packing_data" "$folder/$packing.h5" "$folder/$packing.data"; done
awk '/^Molecules/ { exit } { sub(/ # sphere/, ""); print }' "$folder/spheres.data" >"$folder/spheres.liggghts"

mapfile -t sets < <(build/release/cairn --version | sed -n 's/^instruction set: .* of //p' | sed 's/, /\n/g')

# A line each: packing, physics, cores, code, million sphere-steps per second, contacts per sphere.
cairn() { # instruction set, cores, packings, sets of features
  CAIRN_INSTRUCTION_SET=$1 OMP_NUM_THREADS=$2 \
    "$programs/bench_step" "$folder" --benchmark_filter="^($3)/($4)/" --benchmark_min_time=2 2>/dev/null |
    sed -nE "s|^([a-z_0-9]+)/([a-z]+)/.* M/s_mean=([0-9.]+).* contacts=([0-9.]+).*|\1 \2 $2 $1 \3 \4|p"
}
peer() { # packing, physics, cores, code, command
  OMP_NUM_THREADS=1 mpirun --allow-run-as-root -np "$3" "${@:5}" -log none 2>/dev/null |
    awk -v head="$1 $2 $3 $4" '
      /^ +[0-9]+ +[0-9.]+ *$/ { contacts = $2 }
      /^Loop time/ { for (k = 1; k < NF; ++k) { if ($(k + 1) == "steps") steps = $k; if ($(k + 1) == "atoms" || $(k + 1) == "atoms,") atoms = $k }
                     speed = steps * atoms / $4 / 1e6 }
      END { print head, speed, contacts }'
}
peers() { # cores
  local law=0
  for physics in friction cohesion; do
    law=$((law + 1))
    peer spheres $physics "$1" LIGGGHTS liggghts -in tests/peers/in.liggghts \
      -var data "$folder/spheres.liggghts" -var law $law -var steps 200
    for packing in spheres tetrahedra sizes; do
      for code in LAMMPS native_LAMMPS; do
        [[ $code == LAMMPS ]] && program=lmp || program=$folder/native_lammps
        peer $packing $physics "$1" $code "$program" -in tests/peers/in.packing \
          -v data "$folder/$packing.data" -v kind $packing -v law $physics -v steps 200
      done
    done
  done
}
for ((round = 0; round < rounds; ++round)); do
  for cores in 1 2; do
    for set in "${sets[@]}"; do cairn "$set" $cores 'spheres|tetrahedra|sizes' 'friction|cohesion'; done
    peers $cores
    cairn "${sets[0]}" $cores 'few_spheres(_x3)?|few_tetrahedra|spheres_x27|cubes|needles' 'friction|cohesion'
  done
done >"$folder/speeds.txt"

table() { awk -v part="$1" -v rounds="$rounds" -v sets="${sets[*]}" -f tests/peers/table.awk "$folder/speeds.txt"; }
{
  echo "Debian's $(lmp -h | sed -n 's/.* - \([0-9].*\)/LAMMPS \1/p' | head -n 1), the same compiled with -O3 -march=native, and LIGGGHTS $(
    dpkg-query -W -f '${Version}' liggghts | sed 's/+.*//'); $(g++ --version | head -n 1), preset release; $(
    sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores; $(date +%F). Medians of $rounds rounds in turn, million sphere-steps per second."
  echo
  table 1
  echo
  echo "cairn on other packings (sizes: 50 653 spheres of a power law with ratio 8; x3, x27: that many copies side by side), ${sets[0]}:"
  echo
  table 2
} >"$folder/peers.md"

# Between the two marks.
awk -v text="$folder/peers.md" '
  /^<!-- peers.sh: end -->/ { skip = 0 }
  !skip
  /^<!-- peers.sh: begin -->/ { skip = 1; while ((getline line < text) > 0) print line }
' tests/BENCHMARKS.md >"$folder/BENCHMARKS.md"
cp "$folder/BENCHMARKS.md" tests/BENCHMARKS.md
