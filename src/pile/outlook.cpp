#include "pile/outlook.h"

#include <algorithm>
#include <cmath>

#include "analysis/budget.h"
#include "body/cells.h"
#include "core/elementary.h"
#include "pile/operate.h"

namespace cairn {

namespace {

/// Volume (m^3) of the ball with the bodies' mass and moment of inertia.
double ball_volume(const Bodies& bodies) {
  const Budget total = budget(bodies);
  double square = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    square += bodies.mass[b] * place(bodies, b, total.center).squaredNorm();
  return 4.0 / 3.0 * kPi * power(5.0 / 3.0 * square / total.mass, 1.5);
}

/// The bodies as they are thought to be when a stage's turn comes.
class Outlook {
 public:
  explicit Outlook(const State& state)
      : mass_(budget(state.bodies).mass),
        held_(held_mass(state.bodies)),
        count_(static_cast<double>(state.bodies.size())),
        smallest_(*std::min_element(state.bodies.volume.begin(), state.bodies.volume.end())),
        region_(state.region_volume) {
    for (const double v : state.bodies.volume) solid_ += v;
    pile_ = std::max(ball_volume(state.bodies), solid_);
  }

  void settle() { pile_ = solid_ / kPacking; }

  std::vector<std::string> carve(const CarveSpec& spec, const Region& region) {
    std::vector<std::string> out = judge(region, spec.outside ? 0.0 : kFew);
    double part = std::clamp(region.volume() / pile_, 1.0 / count_, 1.0);
    if (spec.outside) part = std::max(1.0 - part, 1.0 / count_);
    for (double* amount : {&mass_, &held_, &count_, &solid_, &pile_}) *amount *= part;
    region_ = spec.outside ? 0.0 : region.volume();
    return out;
  }

  std::vector<std::string> scale(const ScaleSpec& spec) {
    region_ = spec.volume.value_or(region_);
    if (!(region_ > 0.0)) return {};
    const double ratio = (spec.density * region_ - held_) / mass_, lengths = 1.0 / cube_root(ratio);
    std::vector<std::string> out;
    const bool by_mass = spec.by == ScaleBy::mass;
    const double factor = by_mass ? ratio : lengths;
    if (factor < 0.5 || factor > 2.0)
      out.push_back(fmt::format(
          "{} will be multiplied by about {:.2g}: {:.4g} kg in {:.4g} m^3 are to have {:.4g} kg/m^3; "
          "are the lengths of the region in metres?",
          by_mass ? "masses" : "lengths", factor, mass_ + held_, region_, spec.density));
    if (by_mass) {
      mass_ *= ratio;
    } else {
      for (double* volume : {&solid_, &pile_, &smallest_, &region_}) *volume /= ratio;
    }
    return out;
  }

  std::vector<std::string> assign(const Region& region) const { return judge(region, 1.0); }

 private:
  static constexpr double kPacking = 0.6, kFew = 10.0;

  std::vector<std::string> judge(const Region& region, double few) const {
    const double volume = region.volume(), inside = count_ * volume / pile_;
    const char* const unit = region.spec().kind == RegionKind::mesh
                                 ? "; is the file in metres? give its 'unit', 1000 for kilometres"
                                 : "";
    if (volume < smallest_)
      return {fmt::format("the region, {:.3g} m^3, is smaller than a body, {:.3g} m^3{}", volume, smallest_,
                          unit)};
    if (inside < few)
      return {fmt::format("the region, {:.3g} m^3, holds only about {:.2g} of these bodies{}", volume, inside,
                          unit)};
    if (volume > 1000.0 * pile_)
      return {fmt::format("the region is {:.2g} times larger than the pile, {:.3g} m^3{}", volume / pile_,
                          pile_, unit)};
    return {};
  }

  double mass_, held_;  // kg, of what moves and what is held
  double count_, smallest_, region_;
  double solid_ = 0.0, pile_ = 0.0;  // m^3, of the bodies and of what they fill
};

}  // namespace

std::vector<std::vector<std::string>> operation_warnings(const Scene& scene, const State& state) {
  std::vector<std::vector<std::string>> out(scene.stages.size());
  Outlook outlook(state);
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    const StageSpec& stage = scene.stages[k];
    if (!stage.operates())
      outlook.settle();
    else if (stage.scale)
      out[k] = outlook.scale(*stage.scale);
    else if (stage.carve)
      out[k] = outlook.carve(*stage.carve, region_of(scene, k));
    else
      out[k] = outlook.assign(region_of(scene, k));
  }
  return out;
}

}  // namespace cairn
