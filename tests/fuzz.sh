#!/usr/bin/env bash
# Fuzzes the readers of users' files with clang's libFuzzer, starting from the files that the repository ships
# and, for meshes, from one small mesh in each format; and what meshes become, from one tetrahedron.
#   tests/fuzz.sh [SECONDS]      for each reader; default: 60. An input that breaks one is left in the present folder.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
seconds=${1:-60}

bash "$root/.ci/install" clang libclang-rt-14-dev
(cd "$root" && cmake --preset fuzz && cmake --build --preset fuzz)
corpus=$(mktemp -d)
trap 'rm -rf "$corpus"' EXIT
mkdir "$corpus"/{scene,shape,mesh,triangles}
cp "$root"/examples/*.toml "$corpus/scene"
cp "$root"/shapes_lib/*.toml "$corpus/shape"

# A tetrahedron, or one of its faces where the file is binary. The first digit says which format follows.
points='0 0 0\n1 0 0\n0 1 0\n0 0 1\n'
faces='3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n'
header='element vertex %d\nproperty float x\nproperty float y\nproperty float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n'
one='\0\0\x80\x3f'
triangle="\0\0\0\0\0\0\0\0\0\0\0\0$one\0\0\0\0\0\0\0\0\0\0\0\0$one\0\0\0\0"
cd "$corpus/mesh"
printf '0# tetrahedron\nv 0 0 0\nv +1 0 0\nvn 0 0 1\nv 0 1e0 0\nv 0 0 1\nf 1//1 3/2 2\nf 1 2 4\nf -4 \\\n-1 -2\nf 2 3 4 1\n' > obj
printf "1OFF\n4 4 6\n$points$faces" > off
printf "2ply\nformat ascii 1.0\ncomment a\n$header$points$faces" 4 4 > ply_text
printf "2ply\nformat binary_little_endian 1.0\n$header$triangle\x03\0\0\0\0\x01\0\0\0\x02\0\0\0" 3 1 > ply_binary
printf '3solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n' > stl_text
{ printf '3'; head -c 80 /dev/zero; printf "\x01\0\0\0\0\0\0\0\0\0\0\0$one$triangle\0\0"; } > stl_binary
printf "44 4\n${points}1 3 2\n1 2 4\n1 4 3\n2 3 4\n" > plates
printf '44\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1\n1 1 3 2\n' > numbered
printf '46 8\n-90 0 1\n0 0 1\n0 90 1\n0 180 1\n0 280 1\n90 0 1\n1 3 2\n1 4 3\n1 5 4\n1 2 5\n6 2 3\n6 3 4\n6 4 5\n6 5 2\n' > angles
{ printf 4; printf '%s 2.0\n' {-90,0,90}\ {0,120,240}; } > radii
{ printf '41\n'; for x in -1 1; do printf '%s\n' "$x "{-1,1}\ {-1,1} {-1,1}" $x "{-1,1} {-1,1}\ {-1,1}" $x"; done; } > cube
printf "\4\0\0\0\0\0\0\0\0\0\0\0\0$one\0\0\0\0\0\0\0\0\0\0\0\0$one\0\0\0\0\0\0\0\0\0\0\0\0$one\0\2\1\0\1\3\0\3\2\1\2\3" \
  > "$corpus/triangles/tetrahedron"
cd "$OLDPWD"

for reader in scene shape mesh triangles; do
  "$root/build/fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -timeout=60 -max_len=20000 -print_final_stats=1 \
    "$corpus/$reader"
done
