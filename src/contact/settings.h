// How the contacts of a stage are evaluated.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/law/pair.h"
#include "contact/search.h"

namespace cairn {

/// What the sweep needs beside motions and contacts.
struct SweepSettings {
  double dt = 0.0;  ///< s
  Features features;
  bool sphere_damping = false;  ///< damping from sphere masses instead of effective masses
  std::vector<PairLaw> laws;    ///< materials x materials
  std::size_t materials = 1;
  std::vector<std::uint16_t> material;  ///< of each body

  const PairLaw& law(const Bodies& bodies, const Pair& pair) const {
    const std::vector<std::uint32_t>& body = bodies.spheres.body;
    return laws[material[body[pair.i]] * materials + material[body[pair.j]]];
  }
};

}  // namespace cairn
