// What the contacts of a scene need. The sweep is compiled for each set in the list below, chosen once per
// stage; a feature outside the chosen set leaves no branch, no memory and no history.
#pragma once

#include <utility>

namespace cairn {

struct Features {
  bool tangential = false;
  bool rolling = false;   ///< needs tangential
  bool twisting = false;  ///< needs tangential
  bool cohesion = false;
  bool rolling_slip = false;  ///< Zhang et al. 2017 eq. 8; needs rolling

  friend constexpr bool operator==(const Features&, const Features&) = default;
};

inline constexpr Features kNormal{};
inline constexpr Features kNormalCohesion{.cohesion = true};
inline constexpr Features kFriction{.tangential = true};
inline constexpr Features kFrictionCohesion{.tangential = true, .cohesion = true};
inline constexpr Features kWhole{.tangential = true, .rolling = true, .twisting = true};
inline constexpr Features kWholeCohesion{
    .tangential = true, .rolling = true, .twisting = true, .cohesion = true};
inline constexpr Features kWholeSlip{
    .tangential = true, .rolling = true, .twisting = true, .cohesion = true, .rolling_slip = true};

/// The smallest compiled set that has everything in `wanted`.
constexpr Features compiled_set(const Features& wanted) {
  if (wanted.rolling_slip) return kWholeSlip;
  if (wanted.rolling || wanted.twisting) return wanted.cohesion ? kWholeCohesion : kWhole;
  if (wanted.tangential) return wanted.cohesion ? kFrictionCohesion : kFriction;
  return wanted.cohesion ? kNormalCohesion : kNormal;
}

/// Calls f.template operator()<set>() for the compiled set equal to `set`.
template <class F>
decltype(auto) with_features(const Features& set, F&& f) {
  if (set == kWholeSlip) return f.template operator()<kWholeSlip>();
  if (set == kWholeCohesion) return f.template operator()<kWholeCohesion>();
  if (set == kWhole) return f.template operator()<kWhole>();
  if (set == kFrictionCohesion) return f.template operator()<kFrictionCohesion>();
  if (set == kFriction) return f.template operator()<kFriction>();
  if (set == kNormalCohesion) return f.template operator()<kNormalCohesion>();
  return f.template operator()<kNormal>();
}

}  // namespace cairn
