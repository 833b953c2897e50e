#include "sim/warnings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/stiffness.h"
#include "core/elementary.h"
#include "sim/make_walls.h"

namespace cairn {

std::vector<std::string> lasting_warnings(const Physics& physics) {
  std::vector<std::string> out;
  for (const gravity::Perturber& p : physics.perturbers)
    if (const double nearest = closest(p.orbit); nearest < p.radius)
      out.push_back(fmt::format(
          "perturber '{}' comes within {:.6g} m of the zero of the frame, its radius is {:.6g} m: "
          "bodies there fall on it, which ends the run",
          p.name, nearest, p.radius));
  if (!physics.light_wall.empty()) out.push_back(physics.light_wall);
  const auto look = [&](const Material& a, const Material& b) {
    constexpr double kNearlyElastic = 0.99;
    const Material pair = mix(a, b);
    if (pair.cohesion > 0.0 && pair.restitution_normal >= kNearlyElastic)
      out.push_back(fmt::format(
          "contacts of '{}' are cohesive and nearly elastic (restitution_normal {:g}): what the "
          "time step does to their energy is not small beside what they lose; give less than {:g}, "
          "or more steps_per_contact",
          pair.name, pair.restitution_normal, kNearlyElastic));
  };
  for (std::size_t i = 0; i < physics.materials.size(); ++i) {
    for (std::size_t j = i; j < physics.materials.size(); ++j)
      look(physics.materials[i], physics.materials[j]);
    for (const Material& wall : physics.wall_materials) look(physics.materials[i], wall);
  }
  std::vector<std::string> once;  // several walls may be of one material
  for (std::string& w : out)
    if (std::find(once.begin(), once.end(), w) == once.end()) once.push_back(std::move(w));
  return once;
}

std::vector<std::string> warnings(const Physics& physics, const Bodies& bodies, const Walls& acting) {
  std::vector<std::string> out = lasting_warnings(physics);
  const std::vector<Wall>& walls = acting.walls;
  const auto& radii = bodies.spheres.radius;
  const double of_walls = greatest_wall_speed(bodies, walls), speed = closing_speed(bodies) + of_walls,
               smallest = *std::min_element(radii.begin(), radii.end());
  const char* what = of_walls > 0.0 ? "bodies and walls" : "bodies";
  const double dt = physics.contacts.dt;
  double spin = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) spin = std::max(spin, angular_velocity(bodies, b).norm());
  // Of the softest contacts, as if the shortest one were of the stiffest.
  const double longest =
      physics.contact_time *
      (physics.stiffest > physics.softest ? std::sqrt(physics.stiffest / physics.softest) : 1.0);
  const double overlap = speed * longest / kPi / smallest;
  if (overlap > physics.overlap_limit)
    out.push_back(
        fmt::format("{} that meet at {:.3g} m/s would overlap by about {:.2g} of the smallest "
                    "radius; overlap_limit is {:g}: raise impact_speed or stiffness",
                    what, speed, overlap, physics.overlap_limit));
  if (physics.can_touch && speed * dt > 0.5 * smallest)
    out.push_back(
        fmt::format("{} move by {:.3g} of the smallest radius in a step and may pass through each "
                    "other unseen",
                    what, speed * dt / smallest));
  constexpr double far = 0.3;  // rad
  if (spin * dt > far)
    out.push_back(
        fmt::format("a body turns by {:.2g} rad in a step; its motion will not be accurate", spin * dt));
  for (const gravity::Perturber& p : physics.perturbers) {
    const double passage = std::sqrt(cubed(closest(p.orbit)) / p.gm);
    if (p.tidal && dt > 0.01 * passage)
      out.push_back(
          fmt::format("the time step of {:.3g} s is long for perturber '{}', which passes in about {:.3g} s",
                      dt, p.name, passage));
  }
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (const std::optional<WallDrive>& drive = walls[w].drive; drive && physics.can_touch) {
      // So many contacts at once swing by half a radian in a step.
      const double most = 0.25 * drive->mass / (physics.stiffest * dt * dt),
                   pressing = power(static_cast<double>(bodies.spheres.size()), 2.0 / 3.0);
      if (pressing > most)
        out.push_back(fmt::format(
            "{} is light for a load that some {:.0f} spheres may bear: its motion will not be followed; take "
            "a load_mass of at least {:.3g} kg or a time_step of at most {:.2g} s",
            physics.wall_names[w], pressing, drive->mass * pressing / most, dt * std::sqrt(most / pressing)));
      const double force = load_of_a_contact(bodies, std::abs(drive->load)),
                   fall = fall_of_wall(bodies, acting, w), limit = physics.overlap_limit * smallest,
                   needed = force / limit + 2.0 * force * fall / (limit * limit);
      if (needed > physics.softest)
        out.push_back(fmt::format(
            "the load on {} may press a sphere in by more than overlap_limit, {:g} of its radius{}: a "
            "contact.stiffness of {:.3g} N/m would bear it",
            physics.wall_names[w], physics.overlap_limit,
            fall > 0.0 ? fmt::format(", as the wall falls {:.3g} m on the bodies", fall) : "", needed));
    }
    const WallMotion& motion = walls[w].motion;
    const double turn = motion.spin.norm() * dt;
    const double swing = motion.amplitude == Vec3::Zero() ? 0.0 : 2.0 * kPi * motion.frequency * dt;
    const auto say = [&](const char* does, double angle) {
      if (angle > far)
        out.push_back(fmt::format(
            "{} {} by {:.2g} rad in a step; its motion will not be followed: take a time_step of at most "
            "{:.2g} s",
            physics.wall_names[w], does, angle, far / angle * dt));
    };
    say("turns", turn);
    say("oscillates", swing);
  }
  if (bodies.cell_edge == 0.0) {  // with walls or a box places are counted from the zero of the scene
    double reach = 0.0;
    for (const Vec3& x : bodies.position) reach = std::max(reach, x.cwiseAbs().maxCoeff());
    const double rounding = std::numeric_limits<double>::epsilon() * reach / smallest;
    if (rounding > 1e-9)
      out.push_back(
          fmt::format("places {:.2g} m from the zero are rounded to {:.1g} of the smallest radius: count the "
                      "positions of bodies and walls from a point near them, which [frame] can name",
                      reach, rounding));
  }
  return out;
}

}  // namespace cairn
