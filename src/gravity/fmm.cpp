#include "gravity/fmm.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gravity/fmm.cpp"
#include <hwy/foreach_target.h>

#include "core/error.h"
#include "gravity/fmm_kernel-inl.h"
#include "gravity/walk.h"

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

template <int order>
void run(const Tree& tree, const Opening& opening, std::vector<double>& reduced, std::span<Vec3> acceleration,
         std::span<double> potential) {
  gather_multipoles<order>(tree, reduced);
  const FmmKernel<order> kernel(tree, reduced, acceleration, potential);
  Walk(tree, opening, kernel).run();
}

void run_fmm(const Tree& tree, const Opening& opening, std::vector<double>& reduced,
             std::span<Vec3> acceleration, std::span<double> potential) {
  switch (opening.order) {
    case 4:
      return run<4>(tree, opening, reduced, acceleration, potential);
    case 5:
      return run<5>(tree, opening, reduced, acceleration, potential);
    case 6:
      return run<6>(tree, opening, reduced, acceleration, potential);
    default:
      return run<7>(tree, opening, reduced, acceleration, potential);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn::gravity {

HWY_EXPORT(run_fmm);

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
  HWY_DYNAMIC_DISPATCH(run_fmm)
  (tree_, {settings_.theta, tolerance_, settings_.order}, reduced_, acceleration, potential);
}

}  // namespace cairn::gravity
#endif
