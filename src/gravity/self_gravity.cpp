#include "gravity/self_gravity.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gravity/self_gravity.cpp"
#include <hwy/foreach_target.h>

#include "gravity/conserve-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {
namespace {

CAIRN_INLINE PackWrench unbalanced(const HeldWrenches& w, std::size_t g, std::size_t count) {
  const PackVec x = spread(w.turned.row(0)), y = spread(w.turned.row(1)), z = spread(w.turned.row(2));
  const auto now = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& to) HWY_ATTR -> PackVec {
    PackVec f = load(&from[g], count);
    if (w.part != 0.0) f = fma(Pack(w.part), load(&to[g], count) - f, f);
    return {dot(x, f), dot(y, f), dot(z, f)};
  };
  return {now(w.held.from.force, w.held.to.force),
          w.held.from.torque.empty() ? zeros() : now(w.held.from.torque, w.held.to.torque)};
}

}  // namespace

NetWrench net_of(const HeldWrenches& wrenches) {
  return net_wrench(wrenches.positions, wrenches.masses, wrenches.positions[0],
                    [&](std::size_t g, std::size_t count)
                        HWY_ATTR { return unbalanced(wrenches, g, count); });
}

void get(const HeldWrenches& wrenches, const Balance& balance, std::size_t begin, std::size_t end,
         Vec3* force, Vec3* torque) {
  for (std::size_t g = begin; g < end; g += kPack) {
    const std::size_t count = end - g;
    const PackWrench w = balanced(balance, load(&wrenches.positions[g], count),
                                  load_masses(wrenches.masses, g, count), unbalanced(wrenches, g, count));
    store(force + g, w.force, count);
    store(torque + g, w.torque, count);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn::gravity {

namespace {
HWY_EXPORT(net_of);
HWY_EXPORT(get);
}  // namespace

SelfGravity::SelfGravity(const HeldGravity& held, double time, std::span<const Vec3> positions,
                         std::span<const double> masses)
    : wrenches_{held, positions, masses, attitude_at(held, time).toRotationMatrix(),
                held.to.force.empty() ? 0.0 : (time - held.time) / held.interval},
      balance_(balance(HWY_DYNAMIC_DISPATCH(net_of)(wrenches_), positions[0])) {}

void SelfGravity::get(std::size_t begin, std::size_t end, std::vector<Vec3>& force,
                      std::vector<Vec3>& torque) const {
  HWY_DYNAMIC_DISPATCH(get)(wrenches_, balance_, begin, end, force.data(), torque.data());
}

}  // namespace cairn::gravity
#endif
