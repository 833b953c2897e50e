// The meshes in this folder, and how each is made.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shape/mesh.h"

namespace cairn::models {

/// A ball of unit radius: an icosahedron with edges cut into `parts`, 20 parts^2 triangles. Mirror images of
/// itself in the three planes of coordinates.
TriangleMesh ball(std::uint32_t parts);

/// Vertices on the ellipsoid with these semi-axes.
TriangleMesh ellipsoid(const Vec3& semi_axes, std::uint32_t parts);

/// Edge 1, centred on the origin, 12 triangles.
TriangleMesh cube();

/// Regular, edge 1, centred on the origin.
TriangleMesh tetrahedron();

/// A grain of about unit size: a block with random flat faces, some of its corners broken, roughened and a
/// little hollowed. The same for the same seed.
TriangleMesh boulder(std::uint64_t seed);

/// A spinning top like 65803 Didymos: steep flanks, a ridge at the equator, flattened poles. The
/// equivalent ellipsoid (DEEVE) has full extents of 797 x 783 x 761 m along x, y and z.
TriangleMesh top();

struct Model {
  std::string file;
  TriangleMesh mesh;
};

/// Every file of this folder.
std::vector<Model> all();

}  // namespace cairn::models
