#include "lammps/codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace cairn::lammps {
namespace {

constexpr double kStiffness = 4e9;  // N/m
constexpr double kFriction = 0.5;
constexpr double kGap = 2e-4;      // m, at the start; in a stiffer contact smaller by as much as the overlap
constexpr double kContacts = 2.5;  // duration over cairn's shortest contact

std::string scene(const Setting& s, const Put& second, const std::string& time_step, double duration) {
  const Surface surface{.restitution = s.surfaces.damped ? kRestitution : 1.0,
                        .friction = s.surfaces.frictional ? kFriction : 0.0};
  return "mass_model = 'spheres'\n" +
         scene_text(surface,
                    fmt::format("stiffness = {:.17g}\ndamping_mass = '{}'\n{}", s.stiffening * kStiffness,
                                s.damping_mass, time_step),
                    "", body(s.what.first) + body(second), duration);
}

/// Least gap between the two bodies when the second is moved by `shift`.
double least_gap(const Spheres& spheres, const Vec3& shift) {
  double least = 1e300;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j)
      if (spheres.body[i] != spheres.body[j])
        least = std::min(least, (spheres.position[j] + shift - spheres.position[i]).norm() -
                                    spheres.radius[i] - spheres.radius[j]);
  return least;
}

/// The second body where it nearly touches the first.
Put placed(const Setting& s) {
  Put second = s.what.second;
  const Experiment apart(scene(s, second, "overlap_limit = 0.999", 1.0));
  const Spheres& spheres = apart.state.bodies.spheres;
  const double gap = kGap / std::sqrt(s.stiffening);
  double at = 30.0, to = 0.0;
  while (least_gap(spheres, at * s.what.from) > gap) at -= 0.01;
  to = at + 0.01;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (at + to);
    (least_gap(spheres, middle * s.what.from) > gap ? to : at) = middle;
  }
  second.position += to * s.what.from;
  return second;
}

/// cairn's default, refined.
double time_step(const Setting& s, const Put& second) {
  Experiment automatic(scene(s, second, "", 1.0));
  automatic.begin();
  return automatic.physics.contact_time / (50.0 * s.refine);
}

/// The data file of a collision, as read_data takes it.
std::string data_file(const Start& start) {
  const Bodies& bodies = start.run.state.bodies;
  const Spheres& spheres = bodies.spheres;
  std::string atoms, velocities, molecules;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const std::uint32_t b = spheres.body[s];
    const Vec3 &x = spheres.position[s], w = angular_velocity(bodies, b);
    const Vec3 v = bodies.velocity[b] + w.cross(x - bodies.position[b]);
    atoms += fmt::format("{} 1 {:.17g} {} {:.17g} {:.17g} {:.17g}\n", s + 1, 2.0 * spheres.radius[s],
                         kDensity, x.x(), x.y(), x.z());
    velocities += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", s + 1, v.x(), v.y(),
                              v.z(), w.x(), w.y(), w.z());
    molecules += fmt::format("{} {}\n", s + 1, b + 1);
  }
  return fmt::format(
      "one collision\n\n{} atoms\n1 atom types\n-50 50 xlo xhi\n-50 50 ylo yhi\n-50 50 zlo zhi\n\n"
      "Atoms # sphere\n\n{}\nVelocities\n\n{}\nMolecules\n\n{}",
      spheres.size(), atoms, velocities, molecules);
}

Track read_dump(const std::string& path, std::uint64_t steps) {
  Track out;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (!line.starts_with("ITEM: ENTRIES")) continue;
    Moment now;
    for (int k = 0; k < 2; ++k) {
      std::getline(file, line);
      std::istringstream row(line);
      int body = 0;
      row >> body;
      if (body < 1 || body > 2) throw std::runtime_error("LAMMPS: unexpected body in " + path);
      Body& b = now[body - 1];
      for (Vec3* v : {&b.x, &b.v, &b.w, &b.momentum, &b.force}) row >> v->x() >> v->y() >> v->z();
      if (!row) throw std::runtime_error("LAMMPS: unexpected row in " + path);
    }
    out.push_back(now);
  }
  if (out.size() != steps + 1) throw std::runtime_error("LAMMPS: too few steps in " + path);
  out.erase(out.begin());
  return out;
}

}  // namespace

Start::Start(const Setting& s) : Start(s, placed(s)) {}

Start::Start(const Setting& s, const Put& second)
    : run(scene(s, second, fmt::format("time_step = {:.17g}\n", time_step(s, second)),
                50.0 * kContacts * s.refine * time_step(s, second))) {
  run.begin();
  dt = run.physics.contacts.dt;
  steps = run.physics.steps;
  const Spheres& spheres = run.state.bodies.spheres;
  const auto mass = [](double r) { return kDensity * 4.0 / 3.0 * kPi * r * r * r; };
  const double a = mass(spheres.radius.front()), b = mass(spheres.radius.back()), reduced = a * b / (a + b);
  const double k_n = s.stiffening * kStiffness, k_s = 2.0 / 7.0 * k_n;
  const double log_e = s.surfaces.damped ? std::log(kRestitution) : 0.0;
  const double ratio = 2.0 * std::abs(log_e) / std::hypot(kPi, log_e);
  const bool whole = std::string(s.damping_mass) == "bodies";
  law = {.k_n = k_n,
         .k_s = k_s,
         .c_n = whole ? ratio : ratio * std::sqrt(k_n * reduced),
         .c_s = whole ? ratio : ratio * std::sqrt(k_s * 2.0 / 7.0 * reduced),
         .friction = s.surfaces.frictional ? kFriction : 0.0};
}

Track run_cairn(Start& start) {
  Track out;
  const Bodies& bodies = start.run.state.bodies;
  for (std::uint64_t k = 0; k < start.steps; ++k) {
    start.run.advance(1);
    Moment now;
    for (std::size_t b = 0; b < 2; ++b)
      now[b] = {bodies.position[b], bodies.velocity[b], angular_velocity(bodies, b), bodies.spin[b],
                bodies.force[b]};
    out.push_back(now);
  }
  return out;
}

Track run_dissected(const Start& start, const Conventions& use) {
  const Bodies& from = start.run.state.bodies;
  std::vector<Rigid> bodies;
  for (std::size_t b = 0; b < 2; ++b)
    bodies.push_back({from.mass[b], from.inertia[b], from.position[b], from.velocity[b], from.orientation[b],
                      from.spin[b]});
  std::vector<Ball> balls;
  for (std::size_t s = 0; s < from.spheres.size(); ++s)
    balls.push_back({static_cast<int>(from.spheres.body[s]), from.spheres.offset[s], from.spheres.radius[s]});
  Collision collision(bodies, balls, start.law, use);
  Track out;
  for (std::uint64_t k = 0; k < start.steps; ++k) {
    collision.step(start.dt);
    Moment now;
    for (std::size_t b = 0; b < 2; ++b) {
      const Rigid& r = collision.bodies()[b];
      const Vec3 w = r.q * (r.q.conjugate() * r.momentum).cwiseQuotient(r.inertia);
      now[b] = {r.x, r.v, w, r.momentum, r.force};
    }
    out.push_back(now);
  }
  return out;
}

Track run_lammps(const Start& start, double c_n, double c_s) {
  std::ofstream("collision.data") << data_file(start);
  const auto& mass = start.run.state.bodies.mass;
  const double reduced = mass[0] * mass[1] / (mass[0] + mass[1]);
  const bool rubs = start.law.friction > 0.0;
  // LAMMPS multiplies its gamma by the reduced mass of the bodies.
  const std::string command = fmt::format(
      "lmp -in in.collision -log none -screen none -var data collision.data -var out collision.dump -var kn "
      "{:.17g} "
      "-var kt {:.17g} -var gn {:.17g} -var gt {:.17g} -var mu {:.17g} -var dt {:.17g} -var steps {}",
      start.law.k_n, start.law.k_s, c_n / reduced, rubs ? c_s / reduced : 0.0, start.law.friction, start.dt,
      start.steps);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("LAMMPS failed: " + command);
  return read_dump("collision.dump", start.steps);
}
}  // namespace cairn::lammps
