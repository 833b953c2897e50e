#include "pile/operate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/budget.h"
#include "body/cells.h"
#include "body/select.h"
#include "core/elementary.h"
#include "core/error.h"
#include "core/parallel.h"
#include "pile/region.h"

namespace cairn {

namespace {

Region load_region(const RegionSpec& spec, const Scene& scene, const std::string& key) {
  return scene.sources.at(key + ".file", [&] { return Region(spec, scene.files); });
}

/// 1 for each body that belongs to the region.
std::vector<std::uint8_t> members(const Bodies& bodies, const Region& region, bool whole) {
  const Vec3 centre = budget(bodies).center;
  std::vector<std::uint8_t> in(bodies.size());
  parallel_for(bodies.size(), [&](std::size_t b) {
    const Vec3 x = place(bodies, b, centre);
    if (!whole) {
      in[b] = region.distance(x) < 0.0;
      return;
    }
    in[b] = 1;
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1] && in[b]; ++s)
      in[b] =
          region.distance(x + bodies.orientation[b] * bodies.spheres.offset[s]) <= -bodies.spheres.radius[s];
  });
  return in;
}

void invert(std::vector<std::uint8_t>& flags) {
  for (std::uint8_t& f : flags) f = !f;
}

std::size_t count(const std::vector<std::uint8_t>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

std::string carve(const CarveSpec& spec, const Region& region, State& state,
                  std::vector<ContactRecord>& contacts) {
  std::vector<std::uint8_t> keep = members(state.bodies, region, spec.whole);
  if (spec.outside) invert(keep);
  const std::size_t before = state.bodies.size(), left = count(keep);
  std::size_t moving = 0;
  for (std::size_t b = 0; b < before; ++b) moving += keep[b] && !is_held(state.bodies, b);
  if (moving == 0) throw InputError("{}", left == 0 ? "no body is left" : "no body is left that is not held");
  const std::vector<std::uint32_t> number = select_bodies(state.bodies, keep);
  std::erase_if(contacts,
                [&](const ContactRecord& c) { return number[c.i] == kGone || number[c.j] == kGone; });
  for (ContactRecord& c : contacts) {
    c.i = number[c.i];
    c.j = number[c.j];
  }
  std::vector<WallContact>& touching = state.walls.contacts;
  std::erase_if(touching, [&](const WallContact& c) { return number[c.sphere] == kGone; });
  for (WallContact& c : touching) c.sphere = number[c.sphere];
  state.region_volume = spec.outside ? 0.0 : region.volume();  // of what is left outside it is not known
  return fmt::format("{} of {} bodies stay, {} {:.5g} m^3", left, before, spec.outside ? "outside" : "in",
                     region.volume());
}

/// Multiplies the mass of body b, at unchanged motion.
void multiply_mass(Bodies& bodies, std::size_t b, double factor) {
  bodies.mass[b] *= factor;
  bodies.inertia[b] *= factor;
  bodies.spin[b] *= factor;
  for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
    bodies.spheres.mass[s] *= factor;
}

/// Multiplies all lengths about the mass centre; masses, velocities and rates of rotation stay.
void multiply_lengths(Bodies& bodies, double factor, std::vector<ContactRecord>& contacts) {
  const Vec3 centre = budget(bodies).center;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies.position[b] += (factor - 1.0) * place(bodies, b, centre);
    bodies.volume[b] *= factor * factor * factor;
    bodies.length[b] *= factor;
    bodies.inertia[b] *= factor * factor;
    bodies.spin[b] *= factor * factor;
  }
  for (double& radius : bodies.spheres.radius) radius *= factor;
  for (Vec3& offset : bodies.spheres.offset) offset *= factor;
  for (ContactRecord& c : contacts) c.memory.slide = factor * c.memory.slide;
  settle_cells(bodies);
  place_spheres(bodies);
}

std::string scale(const ScaleSpec& spec, State& state, std::vector<ContactRecord>& contacts) {
  const double volume = spec.volume.value_or(state.region_volume);
  if (!(volume > 0.0)) throw InputError("no region has been carved whose volume is known; expected 'volume'");
  Bodies& bodies = state.bodies;
  const double free = budget(bodies).mass, held = held_mass(bodies), bulk = (free + held) / volume;
  const double ratio = (spec.density * volume - held) / free;
  if (!(ratio > 0.0))
    throw InputError(
        "held bodies alone have {:.5g} kg/m^3 and stay as they are; expected a density above that",
        held / volume);
  state.region_volume = volume;
  if (spec.by == ScaleBy::mass) {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (!is_held(bodies, b)) multiply_mass(bodies, b, ratio);
    return fmt::format("masses x {:.5g}: bulk density {:.5g} -> {:.5g} kg/m^3", ratio, bulk, spec.density);
  }
  if (!state.held.empty())
    throw InputError("lengths cannot be scaled beside held bodies, which stay in their places");
  const double factor = 1.0 / cube_root(ratio);
  multiply_lengths(bodies, factor, contacts);
  state.walls.contacts.clear();  // walls stay where they are
  state.region_volume *= factor * factor * factor;
  return fmt::format("lengths x {:.5g}: bulk density {:.5g} -> {:.5g} kg/m^3", factor, bulk, spec.density);
}

/// Throws when an operation has made bodies such as no scene could have asked for.
void check_bodies(const Bodies& bodies) {
  constexpr double kSmallest = 1e-9, kLargest = 1e9, kThinnest = 1e-12, kDensest = 1e15;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double size = bodies.length[b], density = bodies.mass[b] / bodies.volume[b];
    if (!(size >= kSmallest && size <= kLargest))
      throw InputError("body {} would have a size of {:.3g} m; expected {:g} to {:g} m", b, size, kSmallest,
                       kLargest);
    if (!(density >= kThinnest && density <= kDensest))
      throw InputError("body {} would have a density of {:.3g} kg/m^3; expected {:g} to {:g} kg/m^3", b,
                       density, kThinnest, kDensest);
  }
}

std::string assign(const AssignSpec& spec, const Region& region, const Scene& scene, State& state) {
  Bodies& bodies = state.bodies;
  std::vector<std::uint8_t> chosen = members(bodies, region, false);
  if (spec.outside) invert(chosen);
  if (count(chosen) == 0) throw InputError("no body is {} the region", spec.outside ? "outside" : "in");
  const auto material = std::find_if(scene.materials.begin(), scene.materials.end(),
                                     [&](const Material& m) { return m.name == spec.material; });
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!chosen[b]) continue;
    if (spec.density) multiply_mass(bodies, b, *spec.density * bodies.volume[b] / bodies.mass[b]);
    if (spec.density_factor) multiply_mass(bodies, b, *spec.density_factor);
    if (material != scene.materials.end())
      bodies.material[b] = static_cast<std::uint16_t>(material - scene.materials.begin());
  }
  return fmt::format("{} of {} bodies changed", count(chosen), bodies.size());
}

const char* kind_name(RegionKind kind) {
  switch (kind) {
    case RegionKind::ball:
      return "a ball";
    case RegionKind::ellipsoid:
      return "an ellipsoid";
    case RegionKind::box:
      return "a box";
    case RegionKind::mesh:
      break;
  }
  return "a mesh";
}

std::string describe(const Region& region) {
  return fmt::format("{} of {:.5g} m^3", kind_name(region.spec().kind), region.volume());
}

}  // namespace

Region region_of(const Scene& scene, std::size_t index) {
  const StageSpec& stage = scene.stages[index];
  const std::string key = fmt::format("stage[{}].", index);
  return stage.carve ? load_region(stage.carve->region, scene, key + "carve.region")
                     : load_region(stage.assign->region, scene, key + "assign.region");
}

std::string describe_operation(const Scene& scene, std::size_t index) {
  const StageSpec& stage = scene.stages[index];
  if (stage.carve)
    return fmt::format("carve: bodies {} {} stay, by {}", stage.carve->outside ? "outside" : "in",
                       describe(region_of(scene, index)),
                       stage.carve->whole ? "all of their spheres" : "their centres");
  if (stage.scale)
    return fmt::format("scale to {:g} kg/m^3 by {}", stage.scale->density,
                       stage.scale->by == ScaleBy::mass ? "mass" : "size");
  return fmt::format("assign: bodies {} {}", stage.assign->outside ? "outside" : "in",
                     describe(region_of(scene, index)));
}

void check_operations(const Scene& scene) {
  for (std::size_t k = 0; k < scene.stages.size(); ++k)
    if (scene.stages[k].operates()) describe_operation(scene, k);
}

std::string operate(const Scene& scene, std::size_t index, State& state,
                    std::vector<ContactRecord>& contacts) {
  const StageSpec& stage = scene.stages[index];
  const auto key = [&](const char* name) { return fmt::format("stage[{}].{}", index, name); };
  place_spheres(state.bodies);
  if (stage.carve) {
    const Region region = region_of(scene, index);
    return scene.sources.at(key("carve"), [&] { return carve(*stage.carve, region, state, contacts); });
  }
  if (stage.scale)
    return scene.sources.at(key("scale"), [&] {
      std::string what = scale(*stage.scale, state, contacts);
      check_bodies(state.bodies);
      return what;
    });
  const Region region = region_of(scene, index);
  return scene.sources.at(key("assign"), [&] {
    std::string what = assign(*stage.assign, region, scene, state);
    check_bodies(state.bodies);
    return what;
  });
}

}  // namespace cairn
