#include "sim/perturbers.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "contact/near_pairs.h"
#include "core/error.h"
#include "core/parallel.h"

namespace cairn {

namespace {

/// The zero of the run's frame in the scene's.
Vec3 shift_of(const State& state) {
  return state.shift.position + state.clock.time() * state.shift.velocity;
}

template <class... Args>
[[noreturn]] void fail(const State& state, fmt::format_string<Args...> text, Args&&... args) {
  const std::string what = fmt::format(text, std::forward<Args>(args)...);
  if (state.clock.total_steps == 0) throw InputError("{}", what);
  throw UnstableError("t = {:.6g} s: {}", state.clock.time(), what);
}

/// The perturbers as seen from the zero of the run's frame.
struct Pulls {
  std::vector<gravity::Pull> each;
  Vec3 common = Vec3::Zero();  // m/s^2, on the zero of the run's frame
  double reach2 = 0.0;         // m^2, squared distance that no sphere which touches one has
};

Pulls pulls_now(const Physics& physics, const State& state) {
  Pulls out;
  const Vec3 shift = shift_of(state);
  for (const gravity::Perturber& p : physics.perturbers) {
    const Vec3 place = motion(p.orbit, state.clock.time()).position;
    if (p.tidal && !(place.norm() > p.radius))
      fail(state, "perturber '{}' is at the zero of the frame, which falls freely in its pull", p.name);
    if (p.tidal && shift != Vec3::Zero())
      gravity::add_pull({p.gm, place, true}, std::span(&shift, 1), std::span(&out.common, 1));
    out.each.push_back({p.gm, place - shift, p.tidal});
    out.reach2 = std::max(out.reach2, squared(p.radius + physics.largest_radius));
  }
  return out;
}

/// Stops the run when a sphere touches a perturber.
void check_distances(const Physics& physics, const State& state, const Pulls& pulls) {
  const Spheres& spheres = state.bodies.spheres;
  for (std::size_t s = 0; s < spheres.size(); ++s)
    for (std::size_t k = 0; k < pulls.each.size(); ++k) {
      const double distance = (pulls.each[k].place - sphere_place(state.bodies, s)).norm();
      const double least = physics.perturbers[k].radius + spheres.radius[s];
      if (distance > least) continue;
      fail(state,
           "perturber '{}' is {:.4g} m from the centre of sphere {} of body {}; expected more than {:.4g} m",
           physics.perturbers[k].name, distance, s, spheres.body[s], least);
    }
}

/// Sums over bodies.
struct PerturberSums {
  PerturberRates rates;        // torque about the mass centre of body 0
  Vec3 moment = Vec3::Zero();  // kg m, of the masses about it

  PerturberSums& operator+=(const PerturberSums& other) {
    rates += other.rates;
    moment += other.moment;
    return *this;
  }
};

/// Adds the pulls on the spheres of bodies [first, last) to the wrenches of these and sums what they do.
PerturberSums pull_bodies(const std::vector<Vec3>& pulls, double dt, std::size_t first, std::size_t last,
                          Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  PerturberRates sum;
  Vec3 moment = Vec3::Zero();
  for (std::size_t b = first; b < last; ++b) {
    if (is_held(bodies, b)) continue;
    const std::uint32_t sphere = bodies.first_sphere[b];
    Vec3 force = spheres.mass[sphere] * pulls[sphere];
    if (bodies.sphere_count(b) > 1) {
      Vec3 torque = (spheres.position[sphere] - bodies.position[b]).cross(force);
      for (std::uint32_t s = sphere + 1; s < bodies.first_sphere[b + 1]; ++s) {
        const Vec3 f = spheres.mass[s] * pulls[s];
        force += f;
        torque += (spheres.position[s] - bodies.position[b]).cross(f);
      }
      bodies.torque[b] += torque;
      const Quat& q = bodies.orientation[b];
      const Vec3 spin = bodies.spin[b] + 0.5 * dt * bodies.torque[b];
      sum.power += (q.conjugate() * torque).dot((q.conjugate() * spin).cwiseQuotient(bodies.inertia[b]));
      sum.torque += torque;
    }
    bodies.force[b] += force;
    sum.power += force.dot(bodies.velocity[b] + (0.5 * dt / bodies.mass[b]) * bodies.force[b]);
    const Vec3 arm = separation(bodies, 0, b);  // about body 0 first: a far pile loses nothing
    sum.force += force;
    sum.torque += arm.cross(force);
    moment += bodies.mass[b] * arm;
  }
  return {sum, moment};
}

}  // namespace

void add_perturbers(const Physics& physics, double dt, State& state, PerturberScratch& scratch) {
  if (physics.perturbers.empty()) return;
  constexpr std::size_t block = 128;
  Bodies& bodies = state.bodies;
  const Spheres& spheres = bodies.spheres;
  const Pulls pulls = pulls_now(physics, state);
  const bool one_cell = bodies.cell.empty();
  scratch.pulls.resize(spheres.size());
  if (!one_cell) scratch.places.resize(spheres.size());
  std::atomic<bool> near = false;
  const PerturberSums all =
      parallel_block_sum(bodies.size(), block, PerturberSums{}, [&](std::size_t first, std::size_t last) {
        const std::uint32_t begin = bodies.first_sphere[first], end = bodies.first_sphere[last];
        if (!one_cell)
          for (std::uint32_t s = begin; s < end; ++s) scratch.places[s] = sphere_place(bodies, s);
        const std::vector<Vec3>& places = one_cell ? spheres.position : scratch.places;
        const std::span<Vec3> pull = std::span(scratch.pulls).subspan(begin, end - begin);
        std::fill(pull.begin(), pull.end(), pulls.common);
        for (const gravity::Pull& p : pulls.each)
          if (!(add_pull(p, std::span(places).subspan(begin, end - begin), pull) > pulls.reach2)) near = true;

        return pull_bodies(scratch.pulls, dt, first, last, bodies);
      });
  if (near) check_distances(physics, state, pulls);

  PerturberRates now = all.rates;
  now.torque -= (all.moment / physics.body_mass).cross(now.force);
  PerturberLedger& ledger = state.ledger.perturbers;
  ledger.work += 0.5 * dt * (ledger.rates.power + now.power);
  ledger.momentum += 0.5 * dt * (ledger.rates.force + now.force);
  ledger.angular_momentum += 0.5 * dt * (ledger.rates.torque + now.torque);
  ledger.rates = now;
}

double perturber_distance(const Physics& physics, const State& state, const Vec3& center) {
  double least = std::numeric_limits<double>::infinity();
  for (const gravity::Perturber& p : physics.perturbers)
    least = std::min(least, (motion(p.orbit, state.clock.time()).position - shift_of(state) - center).norm());
  return physics.perturbers.empty() ? std::numeric_limits<double>::quiet_NaN() : least;
}

}  // namespace cairn
