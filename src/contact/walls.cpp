#include "contact/walls.h"

#include "contact/law/partial.h"
#include "core/error.h"
#include "core/parallel.h"

namespace cairn {

namespace {

Triple<double> triple(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Triple<double> triple(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}
Vec3 vector(const Triple<double>& t) {
  return {t.x, t.y, t.z};
}

constexpr ContactMemory<double> kApart{.c_n = -1.0, .c_s = 0.0, .slide = {}, .roll = {}, .twist = 0.0};

/// One sphere against one plane; the contact point lies on the plane, at distance `arm` from the centre.
/// `due` is set at first touch.
template <Features F>
ContactAction<double> evaluate_plane(const SphereMotion& s, const Plane& plane, const PairLaw& law, double dt,
                                     bool fresh, double arm, ContactMemory<double>& memory,
                                     FirstTouch<double>& due) {
  const Triple<double> position = triple(s.position), velocity_mid = triple(s.velocity_mid);
  const Triple<double> normal = triple(plane.normal), point = triple(plane.point);
  const double arm_mid = dot(fma(-0.5 * dt, velocity_mid, position) - point, normal);

  ContactGeometry<double> geometry;
  geometry.n = geometry.n_mid = -1.0 * normal;
  geometry.overlap = s.radius - arm;
  geometry.radius = s.radius;
  geometry.slip_lever = 0.5 / arm;

  ContactMotion<double> motion;
  motion.u = -1.0 * fma(arm, cross(triple(s.spin), geometry.n), triple(s.velocity));
  motion.u_mid = -1.0 * fma(arm_mid, cross(triple(s.spin_mid), geometry.n), velocity_mid);
  motion.w = -1.0 * triple(s.spin);
  motion.w_mid = -1.0 * triple(s.spin_mid);
  motion.turn = 0.5 * triple(s.spin_mid);
  motion.dt = dt;
  if (fresh) {
    motion.dt = age(geometry.overlap, dot(motion.u_mid, geometry.n), dt);
    due = first_touch(law.k_n, geometry.overlap, motion.dt, dt);
  }
  return evaluate<F>(LawConstants<double>(law), geometry, motion, memory);
}

}  // namespace

void Walls::set_laws(const std::vector<Material>& materials, const std::vector<Material>& plane_materials,
                     double k_n) {
  laws_.clear();
  materials_ = materials.size();
  for (const Plane& plane : planes)
    for (const Material& m : materials)
      laws_.push_back(make_pair_law(plane_materials[plane.material], m, k_n));
}

void Walls::resize(std::size_t spheres) {
  spheres_ = spheres;
  memory_.assign(planes.size() * spheres, kApart);
}

const PairLaw& Walls::law(const Bodies& bodies, const SweepSettings& settings, std::size_t plane,
                          std::size_t sphere) const {
  return laws_[plane * materials_ + settings.material[bodies.spheres.body[sphere]]];
}

void Walls::set_damping(const Bodies& bodies, const SweepSettings& settings, std::size_t plane,
                        std::size_t sphere) {
  const Spheres& spheres = bodies.spheres;
  const std::uint32_t b = spheres.body[sphere];
  const PairLaw& pair = law(bodies, settings, plane, sphere);
  EffectiveMass mu{spheres.mass[sphere], kTangentialRatio * spheres.mass[sphere]};
  if (!settings.sphere_damping) {
    const Plane& p = planes[plane];
    const Vec3 x = spheres.position[sphere];
    const Vec3 c = x - (x - p.point).dot(p.normal) * p.normal;
    mu = effective_mass({1.0 / bodies.mass[b], inverse_inertia(bodies, b)}, c - bodies.position[b], {},
                        Vec3::Zero(), p.normal);
  }
  ContactMemory<double>& memory = memory_[plane * spheres_ + sphere];
  memory.c_n = pair.damping_n * std::sqrt(pair.k_n * mu.normal);
  memory.c_s = pair.damping_s * std::sqrt(pair.k_s * mu.tangential);
}

SweepReport Walls::sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings,
                         Bodies& bodies) {
  struct Report {
    double dissipated = 0.0, overlap_ratio = 0.0;
    Report& operator+=(const Report& r) {
      dissipated += r.dissipated;
      overlap_ratio = std::max(overlap_ratio, r.overlap_ratio);
      return *this;
    }
  };
  const auto touch_plane = [&]<Features F>(std::size_t p, std::size_t s, Report& report) {
    const Plane& plane = planes[p];
    const SphereMotion& m = motions[s];
    ContactMemory<double>& memory = memory_[p * spheres_ + s];
    const Vec3 x = bodies.spheres.position[s];
    const double arm = (x - plane.point).dot(plane.normal);
    const std::uint32_t b = bodies.spheres.body[s];
    const Vec3 lever = x - arm * plane.normal - bodies.position[b];
    const auto kick = [&](const Vec3& impulse, const Vec3& couple) {
      bodies.velocity[b] += impulse / bodies.mass[b];
      bodies.spin[b] += lever.cross(impulse) + couple;
    };
    const bool was = memory.c_n >= 0.0;
    if (arm >= m.radius) {
      if (was) {
        const LawConstants<double> pair(law(bodies, settings, p, s));
        const Parting end = parting<F>(pair, memory.c_n, m.radius, arm - m.radius,
                                       Eigen::Map<const Vec3>(m.velocity_mid).dot(plane.normal), settings.dt);
        kick(-end.normal * plane.normal, Vec3::Zero());
        report.dissipated += end.dissipated + cairn::stored_energy<F>(pair, 0.0, m.radius, memory);
        memory = kApart;
      }
      return;
    }
    if (!was) set_damping(bodies, settings, p, s);
    FirstTouch<double> due{0.0, 0.0};
    const ContactAction<double> action =
        evaluate_plane<F>(m, plane, law(bodies, settings, p, s), settings.dt, !was, arm, memory, due);
    const Vec3 force = vector(action.force), couple = vector(action.couple);
    bodies.force[b] += force;
    bodies.torque[b] += lever.cross(force) + couple;
    if (!was) kick(due.wrench * force - due.normal * plane.normal, due.wrench * couple);
    report += {action.dissipated, (m.radius - arm) / m.radius};
  };
  const Report total = with_features(settings.features, [&]<Features F>() {
    return parallel_sum(bodies.size(), Report{}, [&](std::size_t b) {
      Report report;
      for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
        for (std::size_t p = 0; p < planes.size(); ++p) touch_plane.template operator()<F>(p, s, report);
      return report;
    });
  });
  return {total.dissipated, total.overlap_ratio};
}

std::size_t Walls::touching() const {
  std::size_t count = 0;
  for (const ContactMemory<double>& m : memory_) count += m.c_n >= 0.0;
  return count;
}

double Walls::stored_energy(const Bodies& bodies, const SweepSettings& settings) const {
  double energy = 0.0;
  with_features(settings.features, [&]<Features F>() {
    for (std::size_t p = 0; p < planes.size(); ++p)
      for (std::size_t s = 0; s < spheres_; ++s) {
        const ContactMemory<double>& memory = memory_[p * spheres_ + s];
        if (memory.c_n < 0.0) continue;
        const double radius = bodies.spheres.radius[s];
        const double arm = (bodies.spheres.position[s] - planes[p].point).dot(planes[p].normal);
        energy += cairn::stored_energy<F>(LawConstants<double>(law(bodies, settings, p, s)), radius - arm,
                                          radius, memory);
      }
  });
  return energy;
}

std::vector<ContactRecord> Walls::records() const {
  std::vector<ContactRecord> out;
  for (std::size_t p = 0; p < planes.size(); ++p)
    for (std::size_t s = 0; s < spheres_; ++s)
      if (const auto& memory = memory_[p * spheres_ + s]; memory.c_n >= 0.0)
        out.push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(p), memory});
  return out;
}

void Walls::restore(const std::vector<ContactRecord>& records) {
  for (const ContactRecord& r : records) {
    if (r.i >= spheres_ || r.j >= planes.size())
      throw InputError("wall contact of sphere {} and plane {}: no such pair", r.i, r.j);
    memory_[r.j * spheres_ + r.i] = r.memory;
  }
}

}  // namespace cairn
