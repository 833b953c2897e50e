// Writes a packing made by bench_packing as a LAMMPS data file: the same spheres at the same places in the
// same periodic box, those of one body with one molecule number.
#include <cstdio>
#include <fstream>

#include <fmt/ostream.h>

#include "core/error.h"
#include "pile/pile_file.h"

int main(int argc, char** argv) {
  using namespace cairn;
  if (argc != 3) {
    std::fputs("usage: packing_data PACKING.h5 OUT.data\n", stderr);
    return 2;
  }
  try {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[0].name = "nominal";
    scene.materials[1].name = "smooth";
    const Setup packing = read_pile(argv[1], scene, {});
    const Bodies& bodies = packing.bodies;
    Bodies placed = bodies;
    place_spheres(placed);
    const Spheres& spheres = placed.spheres;
    std::ofstream out(argv[2]);
    fmt::print(out, "spheres of {}\n\n{} atoms\n1 atom types\n", argv[1], spheres.size());
    for (int k = 0; k < 3; ++k)
      fmt::print(out, "0 {:.17g} {}lo {}hi\n", packing.box.edge[k], "xyz"[k], "xyz"[k]);
    fmt::print(out, "\nAtoms # sphere\n\n");
    for (std::size_t s = 0; s < spheres.size(); ++s) {
      Vec3 image = Vec3::Zero();
      for (int k = 0; k < 3; ++k) image[k] = std::floor(spheres.position[s][k] / packing.box.edge[k]);
      const Vec3 x = spheres.position[s] - image.cwiseProduct(packing.box.edge);
      const double density = spheres.mass[s] / (4.0 / 3.0 * kPi * std::pow(spheres.radius[s], 3));
      fmt::print(out, "{} 1 {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.0f} {:.0f} {:.0f}\n", s + 1,
                 2.0 * spheres.radius[s], density, x[0], x[1], x[2], image[0], image[1], image[2]);
    }
    fmt::print(out, "\nMolecules\n\n");
    for (std::size_t s = 0; s < spheres.size(); ++s) fmt::print(out, "{} {}\n", s + 1, spheres.body[s] + 1);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 2;
  }
}
