// Walls against the contact law with an infinite partner at rest, in plain vectors.
#include "contact/walls.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contact/law/law-inl.h"
#include "core/random.h"
#include "core/vector.h"
#include "shape/library.h"

namespace cairn {
namespace {

using namespace HWY_NAMESPACE;  // the law of one contact

constexpr double kStiffness = 1e6;

const std::vector<Material> kBodyMaterials{{.name = "rough", .cohesion = 2e3},
                                           {.name = "smooth", .friction = 0.3, .friction_rolling = 0.2}};
const std::vector<Material> kPlaneMaterials{
    {.name = "floor", .restitution_normal = 0.3, .friction = 0.6, .cohesion = 1e3},
    {.name = "slope", .restitution_tangential = 0.8, .friction_twisting = 0.5, .shape_factor = 0.2}};

/// Spheres and cubes that sink into a floor and a slope; some have touched before.
struct Valley {
  Bodies bodies;
  std::vector<PlaneSurface> planes{{{0.0, 0.0, 0.2}, Vec3::UnitZ()}, {{1.0, 0.0, 0.0}, Vec3(0.6, 0.0, 0.8)}};
  Walls walls;
  WallCandidates candidates;
  SweepSettings settings;
  std::vector<SphereMotion> motions;

  explicit Valley(const Features& features) {
    settings.dt = 1e-3;
    settings.features = features;
    settings.materials = 2;
    for (const PlaneSurface& plane : planes) walls.walls.push_back({plane, {}});
    walls.set_laws(kBodyMaterials, kPlaneMaterials, kStiffness);
    Random random(1, 0);
    std::vector<Vec3> spin_mid;
    for (const char* name : {"sphere", "cube"}) {
      const RigidShape shape = make_rigid(load_shape(name, "."), MassModel::union_volume);
      for (int b = 0; b < 6; ++b) {
        add_body(bodies, shape, 0, random.uniform(0.8, 1.0), 2500.0, 0,
                 {.position = Vec3(random.uniform(0.5, 2.0), b, random.uniform(0.9, 1.3)),
                  .orientation = random.rotation(),
                  .velocity = random.in_ball(),
                  .angular_velocity = random.in_ball()});
        bodies.force.back() = 1e6 * random.in_ball();
        bodies.torque.back() = 1e6 * random.in_ball();
        spin_mid.push_back(random.in_ball());
        settings.material.push_back(static_cast<std::uint16_t>(b % 2));
      }
    }
    compute_motions(bodies, spin_mid, settings.dt, motions);
    candidates.resize(bodies);
    for (std::uint32_t s = 0; s < bodies.spheres.size(); ++s)
      for (std::uint32_t p = 0; p < 2; ++p) {
        const auto spring = [&] { return triple(1e-3 * planes[p].normal.cross(random.in_ball())); };
        if (height(s, p) < bodies.spheres.radius[s] && random.uniform() < 0.5)
          walls.contacts.push_back({s, p, 0, {1e3, 2e3, spring(), spring(), random.uniform(-1e-3, 1e-3)}});
      }
  }

  double height(std::size_t s, std::size_t p) const {
    return (bodies.spheres.position[s] - planes[p].point).dot(planes[p].normal);
  }
  PairLaw law(std::size_t s, std::size_t p) const {
    return make_pair_law(kBodyMaterials[settings.material[bodies.spheres.body[s]]], kPlaneMaterials[p],
                         kStiffness);
  }
};

/// The memory of a touching pair; null when apart.
const ContactMemory<double>* find(const std::vector<WallContact>& contacts, std::size_t s, std::size_t p) {
  for (const WallContact& c : contacts)
    if (c.sphere == s && c.wall == p) return &c.memory;
  return nullptr;
}

template <Features F>
void expect_contact_by_contact(bool sphere_damping) {
  Valley valley(F);
  valley.settings.sphere_damping = sphere_damping;
  Bodies& bodies = valley.bodies;
  const Spheres& spheres = bodies.spheres;
  const double dt = valley.settings.dt;
  const std::vector<WallContact> before = valley.walls.contacts;
  std::vector<Vec3> force = bodies.force, torque = bodies.torque;
  std::vector<WallContact> after;
  double dissipated = 0.0, deepest = 0.0, stored = 0.0, strongest = 0.0;
  for (std::uint32_t s = 0; s < spheres.size(); ++s)
    for (std::uint32_t p = 0; p < 2; ++p) {
      const double arm = valley.height(s, p), radius = spheres.radius[s];
      if (arm >= radius) continue;
      const SphereMotion& m = valley.motions[s];
      const PairLaw law = valley.law(s, p);
      const std::uint32_t b = spheres.body[s];
      const Vec3 n = -valley.planes[p].normal, wm = vector(m.spin_mid), w = vector(m.spin);
      const double arm_mid = arm + 0.5 * dt * vector(m.velocity_mid).dot(n);
      // The wall is at rest: the relative motion is that of the sphere, backwards.
      const Vec3 u = -vector(m.velocity) - w.cross(arm * n),
                 u_mid = -vector(m.velocity_mid) - wm.cross(arm_mid * n);
      const ContactGeometry<double> geometry{triple(n), triple(n), radius - arm, radius, 0.5 / arm};
      ContactMotion<double> motion{triple(u), triple(-w), triple(u_mid), triple(-wm), triple(0.5 * wm), dt};
      const Vec3 lever = spheres.position[s] + arm * n - bodies.position[b];
      ContactMemory<double> memory{};
      if (const ContactMemory<double>* old = find(before, s, p)) {
        memory = *old;
      } else {
        motion.dt = std::min(dt, geometry.overlap / std::abs(u_mid.dot(n)));
        EffectiveMass mu{spheres.mass[s], 2.0 / 7.0 * spheres.mass[s]};
        if (!sphere_damping)
          mu = effective_mass({1.0 / bodies.mass[b], inverse_inertia(bodies, b)}, lever, {}, Vec3::Zero(), n);
        memory.c_n = law.damping_n * std::sqrt(kStiffness * mu.normal);
        memory.c_s = law.damping_s * std::sqrt(2.0 / 7.0 * kStiffness * mu.tangential);
      }
      const ContactAction<double> action = evaluate<F>(LawConstants<double>(law), geometry, motion, memory);
      const Vec3 f = vector(action.force);
      force[b] += f;
      torque[b] += lever.cross(f) + vector(action.couple);
      after.push_back({s, p, 0, memory});
      dissipated += action.dissipated;
      deepest = std::max(deepest, geometry.overlap / radius);
      stored += stored_energy<F>(LawConstants<double>(law), geometry.overlap, radius, memory);
      strongest = std::max(strongest, f.norm());
    }
  ASSERT_GT(before.size(), 4u);
  ASSERT_GT(after.size(), before.size() + 4);

  const WallReport report =
      valley.walls.sweep(valley.motions, valley.settings, 0.0, valley.candidates, bodies);
  EXPECT_NEAR(report.dissipated, dissipated, 1e-11 * std::abs(dissipated));
  EXPECT_NEAR(report.overlap_ratio, deepest, 1e-13);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_LT((bodies.force[b] - force[b]).norm(), 1e-11 * strongest);
    EXPECT_LT((bodies.torque[b] - torque[b]).norm(), 1e-11 * strongest);
  }
  EXPECT_NEAR(valley.walls.stored_energy(bodies, valley.settings, 0.0), stored, 1e-11 * stored);
  const std::vector<WallContact>& records = valley.walls.contacts;
  ASSERT_EQ(records.size(), after.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    ASSERT_EQ(records[k].sphere, after[k].sphere);
    ASSERT_EQ(records[k].wall, after[k].wall);
    const ContactMemory<double>&is = records[k].memory, &expected = after[k].memory;
    EXPECT_NEAR(is.c_n, expected.c_n, 1e-11 * expected.c_n);
    EXPECT_NEAR(is.c_s, expected.c_s, 1e-11 * expected.c_s);
    EXPECT_LT((vector(is.slide) - vector(expected.slide)).norm(), 1e-14);
    EXPECT_LT((vector(is.roll) - vector(expected.roll)).norm(), 1e-14);
    EXPECT_NEAR(is.twist, expected.twist, 1e-14);
  }
}

TEST(Walls, ActContactByContactAsTheLawSays) {
  expect_contact_by_contact<kWholeSlip>(false);
  expect_contact_by_contact<kWholeCohesion>(false);
  expect_contact_by_contact<kFriction>(true);
}

TEST(Walls, SpringsOfASphereThatLeavesAreLostAndCounted) {
  Valley valley(kWholeCohesion);
  double springs = 0.0;
  for (const WallContact& r : valley.walls.contacts) {
    const PairLaw law = valley.law(r.sphere, r.wall);
    const double patch2 = std::pow(law.beta * valley.bodies.spheres.radius[r.sphere], 2);
    springs += 0.5 * law.k_s * vector(r.memory.slide).squaredNorm() +
               0.5 * law.k_n * patch2 * vector(r.memory.roll).squaredNorm() +
               law.k_s * patch2 * r.memory.twist * r.memory.twist;
  }
  ASSERT_GT(springs, 0.0);
  for (Vec3& x : valley.bodies.position) x.z() += 10.0;
  place_spheres(valley.bodies);
  const std::vector<Vec3> before = valley.bodies.force;
  const WallReport report =
      valley.walls.sweep(valley.motions, valley.settings, 0.0, valley.candidates, valley.bodies);
  EXPECT_NEAR(report.dissipated, springs, 1e-12 * springs);
  EXPECT_TRUE(valley.walls.contacts.empty());
  EXPECT_EQ(valley.bodies.force, before);
}

}  // namespace
}  // namespace cairn
