#include "gravity/fmm.h"

#include "core/error.h"
#include "gravity/fmm_kernel.h"
#include "gravity/walk.h"

namespace cairn::gravity {

Fmm::Fmm(const FmmSettings& settings) : settings_(settings) {
  if (!(settings.theta >= 0.0 && settings.theta <= 1.0)) {
    throw InputError("gravity: theta is {}, expected 0 to 1", settings.theta);
  }
  if (settings.order < 4 || settings.order > 7) {
    throw InputError("gravity: order is {}, expected 4 to 7", settings.order);
  }
  if (settings.leaf_size < 1) throw InputError("gravity: leaf_size is 0, expected 1 or more");
}

void Fmm::evaluate(const Points& points, std::span<Vec3> acceleration, std::span<double> potential) {
  check(points);
  if (points.size() == 0) return;
  tree_.build(points, settings_.leaf_size);
  switch (settings_.order) {
    case 4:
      return run<4>(acceleration, potential);
    case 5:
      return run<5>(acceleration, potential);
    case 6:
      return run<6>(acceleration, potential);
    default:
      return run<7>(acceleration, potential);
  }
}

template <int order>
void Fmm::run(std::span<Vec3> acceleration, std::span<double> potential) {
  gather_multipoles<order>(tree_, reduced_);
  const FmmKernel<order> kernel(tree_, reduced_, acceleration, potential);
  Walk(tree_, {settings_.theta, tolerance_, order}, kernel).run();
}

}  // namespace cairn::gravity
