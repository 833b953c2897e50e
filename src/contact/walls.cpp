#include "contact/walls.h"

#include <algorithm>
#include <cmath>

#include "contact/dashpots.h"
#include "contact/law/law-inl.h"
#include "core/error.h"

namespace cairn {

using namespace HWY_NAMESPACE;  // the law of one contact

namespace {

/// The effective masses of a contact whose wall moves under a load, which yields along its axis only.
EffectiveMass yielding(const EffectiveMass& body, const WallDrive& drive, const Vec3& n) {
  const double along = squared(drive.axis.dot(n)) / drive.mass;
  const double normal = 1.0 / body.normal + along, across = 2.0 / body.tangential + 1.0 / drive.mass - along;
  // A direction in which neither side yields, as that across the axis to a held body, has no mass.
  const double least = 1e-9 / drive.mass;
  return {1.0 / (normal > least ? normal : 1.0 / drive.mass),
          2.0 / (across > least ? across : 2.0 / drive.mass)};
}

}  // namespace

void Walls::set_laws(const std::vector<Material>& materials, const std::vector<Material>& wall_materials,
                     double k_n) {
  laws_.clear();
  materials_ = materials.size();
  for (const Material& wall : wall_materials)
    for (const Material& m : materials) laws_.push_back(make_pair_law(wall, m, k_n));
}

std::vector<WallPose> Walls::poses(double time) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.pose(time));
    drive(w, 0.0, out.back());
  }
  return out;
}

void Walls::drive(std::size_t wall, double ago, WallPose& pose) const {
  if (!walls[wall].drive) return;
  const Vec3& axis = walls[wall].drive->axis;
  const std::uint32_t n = scene_number(wall);
  pose.shift += (driven.place[n] - ago * driven.speed[n]) * axis;
  pose.velocity += driven.speed[n] * axis;
}

std::vector<WallPose> Walls::poses_before(double time, double dt) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.pose(time - dt));
    drive(w, dt, out.back());
  }
  return out;
}

std::vector<WallPose> Walls::mid_step(double time, double dt) const {
  std::vector<WallPose> out;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    out.push_back(walls[w].motion.mid_step(time, dt));
    drive(w, 0.5 * dt, out.back());
  }
  return out;
}

double Walls::kinetic_energy() const {
  double energy = 0.0;
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (const std::optional<WallDrive>& drive = walls[w].drive) {
      const double speed = driven.speed[scene_number(w)];
      energy += 0.5 * drive->mass * (speed * speed);
    }
  return energy;
}

WallFilter Walls::filter(const Bodies& bodies) const {
  std::vector<std::vector<std::uint8_t>> here(sets.size());
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (std::size_t w = 0; w < walls.size(); ++w) here[k].push_back(sets[k][scene_number(w)]);
  return {bodies, walls, std::move(here)};
}

EffectiveMass Walls::effective_mass(const Bodies& bodies, const WallPose& pose, const WallTouch& touch,
                                    std::uint32_t wall, std::uint32_t sphere) const {
  const std::uint32_t b = bodies.spheres.body[sphere];
  const Vec3 n = pose.to_space(touch.n), c = bodies.spheres.position[sphere] + touch.arm * n;
  const EffectiveMass mass =
      cairn::effective_mass(inertia_of(bodies, b), c - bodies.position[b], {}, Vec3::Zero(), n);
  return walls[wall].drive ? yielding(mass, *walls[wall].drive, n) : mass;
}

double Walls::set_damping(const Bodies& bodies, const SweepSettings& settings, const WallPose& pose,
                          const WallTouch& touch, WallContact& contact) const {
  const std::uint32_t s = contact.sphere;
  const PairLaw& pair = law(bodies, settings, contact.wall, s);
  const EffectiveMass mass = effective_mass(bodies, pose, touch, contact.wall, s);
  EffectiveMass mu = mass;
  if (settings.sphere_damping && !is_held(bodies, bodies.spheres.body[s])) {
    mu.normal = bodies.spheres.mass[s];
    mu.tangential = kTangentialRatio * mu.normal;
  }
  contact.memory.c_n = pair.damping_n * std::sqrt(pair.k_n * mu.normal);
  contact.memory.c_s = pair.damping_s * std::sqrt(pair.k_s * mu.tangential);
  return mass.normal;
}

void Walls::renew_damping(const Bodies& bodies, const Walls* before, const SweepSettings* settings_before,
                          const SweepSettings& settings, double time) {
  const std::vector<WallPose> now = poses(time);
  const bool known = before && settings_before && same_masses(*settings_before, settings);
  const auto law_before = [&](const WallContact& c) -> const PairLaw* {
    for (std::uint32_t w = 0; known && w < before->walls.size(); ++w)
      if (before->scene_number(w) == scene_number(c.wall))
        return &before->law(bodies, *settings_before, w, c.sphere);
    return nullptr;
  };
  for (WallContact& c : contacts) {
    const PairLaw* former = law_before(c);
    if (former && carry_damping(*former, law(bodies, settings, c.wall, c.sphere), c.memory.c_n, c.memory.c_s))
      continue;
    const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
    set_damping(bodies, settings, now[c.wall], walls[c.wall].extend(c.feature, y), c);
  }
}

double Walls::stored_energy(const Bodies& bodies, const SweepSettings& settings, double time) const {
  const std::vector<WallPose> now = poses(time);
  double energy = 0.0;
  with_features(settings.features, [&]<Features F>() {
    for (const WallContact& c : contacts) {
      const double radius = bodies.spheres.radius[c.sphere];
      const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
      const double arm = walls[c.wall].extend(c.feature, y).arm;
      energy += HWY_NAMESPACE::stored_energy<F>(LawConstants<double>(law(bodies, settings, c.wall, c.sphere)),
                                                radius - arm, radius, c.memory);
    }
  });
  return energy;
}

DeepestTouch Walls::deepest(const Bodies& bodies, double time) const {
  const std::vector<WallPose> now = poses(time);
  DeepestTouch out;
  for (const WallContact& c : contacts) {
    const Vec3 y = now[c.wall].to_wall(bodies.spheres.position[c.sphere]);
    const double ratio = 1.0 - walls[c.wall].extend(c.feature, y).arm / bodies.spheres.radius[c.sphere];
    if (ratio > out.ratio) out = {ratio, c.sphere, scene_number(c.wall)};
  }
  return out;
}

std::vector<WallContact> Walls::numbered_contacts() const {
  std::vector<WallContact> out = contacts;
  if (!number.empty())
    for (WallContact& c : out) c.wall = number[c.wall];
  return out;
}

void Walls::check_contacts(std::size_t spheres) const {
  for (const WallContact& c : contacts)
    if (c.sphere >= spheres || c.wall >= walls.size() || c.feature >= walls[c.wall].features())
      throw InputError("contact of sphere {} with part {} of wall {}: no such pair", c.sphere, c.feature,
                       c.wall);
  if (!std::is_sorted(contacts.begin(), contacts.end(), in_order))
    throw InputError("contacts with walls are not in order");
}

}  // namespace cairn
