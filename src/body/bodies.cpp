#include "body/bodies.h"

#include "body/cells.h"
#include "core/parallel.h"

namespace cairn {

void add_body(Bodies& bodies, const RigidShape& shape, std::uint32_t shape_index, double size, double density,
              std::uint16_t material, const Placement& placement) {
  const auto index = static_cast<std::uint32_t>(bodies.size());
  const double mass = density * shape.volume * size * size * size;
  const Quat orientation = (placement.orientation * shape.axes).normalized();
  const Vec3 inertia = mass * size * size * shape.inertia;
  const Vec3 spin =
      orientation * (orientation.conjugate() * placement.angular_velocity).cwiseProduct(inertia);

  if (bodies.first_sphere.empty()) bodies.first_sphere.push_back(0);
  bodies.mass.push_back(mass);
  bodies.volume.push_back(mass / density);
  bodies.inertia.push_back(inertia);
  bodies.shape.push_back(shape_index);
  bodies.length.push_back(size);
  bodies.material.push_back(material);
  const Vec3 cell = nearest_multiples(placement.origin, bodies.cell_edge);
  const Vec3 position = (placement.origin - bodies.cell_edge * cell) + placement.position;
  bodies.position.push_back(position);
  bodies.remainder.push_back(Vec3::Zero());
  if (bodies.cell.empty() && cell != Vec3::Zero()) bodies.cell.assign(index, Vec3::Zero());
  if (!bodies.cell.empty() || cell != Vec3::Zero()) bodies.cell.push_back(cell);
  bodies.velocity.push_back(placement.velocity);
  bodies.orientation.push_back(orientation);
  bodies.spin.push_back(spin);
  bodies.force.push_back(Vec3::Zero());
  bodies.torque.push_back(Vec3::Zero());

  Spheres& spheres = bodies.spheres;
  for (std::size_t s = 0; s < shape.offsets.size(); ++s) {
    const Vec3 offset = size * shape.offsets[s];
    spheres.radius.push_back(size * shape.radii[s]);
    spheres.mass.push_back(mass * shape.mass_fractions[s]);
    spheres.offset.push_back(offset);
    spheres.body.push_back(index);
    spheres.position.push_back(position + orientation * offset);
  }
  bodies.first_sphere.push_back(static_cast<std::uint32_t>(spheres.size()));
}

Mat3 inverse_inertia(const Bodies& bodies, std::size_t b) {
  const Mat3 axes = bodies.orientation[b].toRotationMatrix();
  return axes * bodies.inertia[b].cwiseInverse().asDiagonal() * axes.transpose();
}

void place_spheres(Bodies& bodies, std::size_t begin, std::size_t end) {
  Spheres& spheres = bodies.spheres;
  for (std::size_t b = begin; b < end; ++b) {
    const std::uint32_t first = bodies.first_sphere[b], last = bodies.first_sphere[b + 1];
    if (last - first == 1) {  // a loose sphere sits on its centre of mass
      spheres.position[first] = bodies.position[b];
      continue;
    }
    const Mat3 axes = bodies.orientation[b].toRotationMatrix();
    for (std::uint32_t s = first; s < last; ++s)
      spheres.position[s] = bodies.position[b] + axes * spheres.offset[s];
  }
}

void place_spheres(Bodies& bodies) {
  parallel_blocks(bodies.size(), kBodyBlock,
                  [&](std::size_t begin, std::size_t end) { place_spheres(bodies, begin, end); });
}

}  // namespace cairn
