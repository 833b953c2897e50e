// Insertion without overlap of many bodies: seconds for the cloud as it is, and for the same bodies with
// FCL's dynamic tree of boxes as the broad phase.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>

#include <cstdio>

#include "core/random.h"
#include "core/timer.h"
#include "pile/cloud.h"
#include "shape/library.h"

namespace cairn {
namespace {

double seconds_of_cloud(const CloudSpec& spec, Bodies& bodies) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  const double start = wall_seconds();
  add_cloud(spec, {ball}, {0}, 0, 1, 0, bodies);
  return wall_seconds() - start;
}

bool touches(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* hit) {
  const auto radius = [](fcl::CollisionObjectd* o) {
    return static_cast<const fcl::Sphered*>(o->collisionGeometry().get())->radius;
  };
  const double reach = radius(a) + radius(b);
  *static_cast<bool*>(hit) = (a->getTranslation() - b->getTranslation()).squaredNorm() < reach * reach;
  return *static_cast<bool*>(hit);
}

/// Random places in the ball for spheres of these radii, largest first.
double seconds_with_fcl(std::vector<double> radii, double filling) {
  const double start = wall_seconds();
  std::sort(radii.begin(), radii.end(), std::greater<>());
  double volume = 0.0;
  for (const double r : radii) volume += r * r * r;
  const double ball = std::cbrt(volume / filling);
  Random random(1, 0);
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  fcl::DynamicAABBTreeCollisionManagerd tree;
  for (const double r : radii) {
    auto object = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(r));
    for (bool hit = true; hit;) {
      object->setTranslation((ball - r) * random.in_ball());
      object->computeAABB();
      hit = false;
      tree.collide(object.get(), &hit, touches);
    }
    tree.registerObject(object.get());
    objects.push_back(std::move(object));
  }
  return wall_seconds() - start;
}

}  // namespace
}  // namespace cairn

int main() {
  using namespace cairn;
  for (const double ratio : {1.0, 8.0, 64.0}) {
    CloudSpec spec;
    spec.shapes = {{"sphere", 1.0}};
    spec.count = 100'000;
    spec.filling = 0.2;
    spec.distribution = ratio > 1.0 ? SizeDistribution::power_law : SizeDistribution::single;
    spec.size = 1.0;
    spec.size_max = ratio;
    spec.density = 1.0;
    Bodies bodies;
    const double own = seconds_of_cloud(spec, bodies);
    std::printf("100000 balls, sizes 1 to %g, filling 0.2: own grids %.2f s, FCL %.2f s\n", ratio, own,
                seconds_with_fcl(bodies.length, spec.filling));
  }
}
