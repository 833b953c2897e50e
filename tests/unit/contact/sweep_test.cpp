// The sweep against the contact law applied pair by pair, with geometry and kinematics in plain vectors.
#include "contact/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/candidates.h"
#include "contact/law/law-inl.h"
#include "core/random.h"
#include "core/vector.h"
#include "shape/library.h"

namespace cairn {
namespace {

using namespace HWY_NAMESPACE;  // the law of one contact

constexpr double kStiffness = 1e6;

const std::vector<Material> kMaterials{
    {.name = "rough", .restitution_normal = 0.6, .restitution_tangential = 0.3, .cohesion = 4e3},
    {.name = "smooth",
     .friction = 0.3,
     .friction_rolling = 0.2,
     .friction_twisting = 0.4,
     .shape_factor = 0.3,
     .cohesion = 1e3}};

/// Spheres and aggregates of several sizes that overlap, move and turn; half of the touching pairs have
/// touched before.
struct Heap {
  Bodies bodies;
  ContactList contacts;
  SweepSettings settings;
  std::vector<SphereMotion> motions;

  Heap(const Features& features, std::size_t materials) {
    settings.dt = 1e-3;
    settings.features = features;
    settings.materials = materials;
    for (std::size_t a = 0; a < materials; ++a)
      for (std::size_t b = 0; b < materials; ++b)
        settings.laws.push_back(make_pair_law(kMaterials[a], kMaterials[b], kStiffness));
    Random random(1, 0);
    std::vector<Vec3> spin_mid;
    std::uint32_t index = 0;
    for (const char* name : {"sphere", "rod4", "cube"}) {
      const RigidShape shape = make_rigid(load_shape(name, "."), MassModel::union_volume);
      for (int b = 0; b < 20; ++b) {
        add_body(bodies, shape, index, random.uniform(0.6, 1.4), 2500.0, 0,
                 {.position = 6.5 * random.in_ball(),
                  .orientation = random.rotation(),
                  .velocity = random.in_ball(),
                  .angular_velocity = random.in_ball()});
        bodies.force.back() = 1e6 * random.in_ball();
        bodies.torque.back() = 1e6 * random.in_ball();
        spin_mid.push_back(random.in_ball());
        settings.material.push_back(static_cast<std::uint16_t>(bodies.size() % materials));
      }
      ++index;
    }
    compute_motions(bodies, spin_mid, settings.dt, motions);
    Candidates().rebuild(bodies, {}, features, contacts);
    for (std::size_t slot = 0; slot < contacts.slots(); ++slot) {
      const Vec3 n = separation(slot).normalized();
      const auto spring = [&] { return triple(1e-2 * n.cross(random.in_ball())); };
      if (overlap(slot) > 0.0 && random.uniform() < 0.5)
        contacts.set_memory(slot, {1e3, 2e3, spring(), spring(), random.uniform(-1e-2, 1e-2)});
    }
  }

  Vec3 separation(std::size_t slot) const {
    const Pair& p = contacts.pair(slot);
    return bodies.spheres.position[p.j] - bodies.spheres.position[p.i];
  }
  double overlap(std::size_t slot) const {
    const Pair& p = contacts.pair(slot);
    return bodies.spheres.radius[p.i] + bodies.spheres.radius[p.j] - separation(slot).norm();
  }
  PairLaw law(std::size_t slot) const {
    const auto& body = bodies.spheres.body;
    const Pair& p = contacts.pair(slot);
    return make_pair_law(kMaterials[settings.material[body[p.i]]], kMaterials[settings.material[body[p.j]]],
                         kStiffness);
  }
};

/// What a touching pair shall do and remember.
struct Expected {
  Vec3 force = Vec3::Zero(), torque_i = Vec3::Zero(), torque_j = Vec3::Zero();
  ContactMemory<double> memory{};
  double dissipated = 0.0;
};

/// Lever arm from the centre of a sphere of radius `own` to the plane in which it cuts one of radius `other`.
double arm(double own, double other, double distance) {
  return (distance * distance + own * own - other * other) / (2.0 * distance);
}

template <Features F>
Expected expect(const Heap& heap, std::size_t slot) {
  const Spheres& spheres = heap.bodies.spheres;
  const Pair& pair = heap.contacts.pair(slot);
  const PairLaw law = heap.law(slot);
  const SphereMotion &a = heap.motions[pair.i], &b = heap.motions[pair.j];
  const double dt = heap.settings.dt;
  const auto approach = [](const Vec3& va, const Vec3& wa, const Vec3& arm_a, const Vec3& vb, const Vec3& wb,
                           const Vec3& arm_b) -> Vec3 { return vb + wb.cross(arm_b) - va - wa.cross(arm_a); };

  const Vec3 d = heap.separation(slot), n = d.normalized();
  const double to_i = arm(a.radius, b.radius, d.norm()), to_j = arm(b.radius, a.radius, d.norm());
  const Vec3 vm_a = vector(a.velocity_mid), vm_b = vector(b.velocity_mid);
  const Vec3 d_mid = d - 0.5 * dt * (vm_b - vm_a), n_mid = d_mid.normalized();
  ContactGeometry<double> geometry{triple(n), triple(n_mid), heap.overlap(slot),
                                   1.0 / (1.0 / a.radius + 1.0 / b.radius), 0.5 * (1.0 / to_i - 1.0 / to_j)};

  const Vec3 wm_a = vector(a.spin_mid), wm_b = vector(b.spin_mid), w_a = vector(a.spin), w_b = vector(b.spin);
  const Vec3 u = approach(vector(a.velocity), w_a, to_i * n, vector(b.velocity), w_b, -to_j * n);
  const Vec3 u_mid = approach(vm_a, wm_a, arm(a.radius, b.radius, d_mid.norm()) * n_mid, vm_b, wm_b,
                              -arm(b.radius, a.radius, d_mid.norm()) * n_mid);
  ContactMotion<double> motion{
      triple(u), triple(w_b - w_a), triple(u_mid), triple(wm_b - wm_a), triple(0.5 * (wm_a + wm_b)),
      /*dt=*/dt};
  Expected out{.memory = heap.contacts.memory(slot)};
  if (!heap.contacts.touching(slot)) {
    if (const double nearing = -u_mid.dot(n_mid); nearing > 0.0)
      motion.dt = std::min(dt, geometry.overlap / nearing);
    EffectiveMass mu;
    if (heap.settings.sphere_damping) {
      mu.normal = 1.0 / (1.0 / spheres.mass[pair.i] + 1.0 / spheres.mass[pair.j]);
      mu.tangential = 2.0 / 7.0 * mu.normal;
    } else {
      const auto side = [&](std::uint32_t s) {
        return Inertia{1.0 / heap.bodies.mass[spheres.body[s]],
                       inverse_inertia(heap.bodies, spheres.body[s])};
      };
      const Vec3 point = spheres.position[pair.i] + to_i * n;
      mu = effective_mass(side(pair.i), point - heap.bodies.position[spheres.body[pair.i]], side(pair.j),
                          point - heap.bodies.position[spheres.body[pair.j]], n);
    }
    out.memory = {law.damping_n * std::sqrt(kStiffness * mu.normal),
                  law.damping_s * std::sqrt(2.0 / 7.0 * kStiffness * mu.tangential),
                  {},
                  {},
                  0.0};
  }
  const ContactAction<double> action = evaluate<F>(LawConstants<double>(law), geometry, motion, out.memory);
  const Vec3 couple = vector(action.couple);
  out.force = vector(action.force);
  out.torque_i = (to_i * n).cross(out.force) + couple;
  out.torque_j = (-to_j * n).cross(-out.force) - couple;
  out.dissipated = action.dissipated;
  return out;
}

void expect_near(const Vec3& a, const Vec3& b, double scale) {
  EXPECT_LT((a - b).norm(), 1e-11 * scale);
}

template <Features F>
void expect_pair_by_pair(std::size_t materials, bool sphere_damping) {
  Heap heap(F, materials);
  heap.settings.sphere_damping = sphere_damping;
  Bodies& bodies = heap.bodies;
  const Spheres& spheres = bodies.spheres;
  std::vector<Expected> pairs(heap.contacts.slots());
  std::vector<bool> touching(heap.contacts.slots());
  std::vector<Vec3> force(bodies.size(), Vec3::Zero()), torque = force;
  double dissipated = 0.0, deepest = 0.0, strongest = 0.0;
  int fresh = 0, old = 0;
  for (std::size_t slot = 0; slot < pairs.size(); ++slot) {
    touching[slot] = heap.overlap(slot) > 0.0;
    if (!touching[slot]) continue;
    ++(heap.contacts.touching(slot) ? old : fresh);
    const Expected& e = pairs[slot] = expect<F>(heap, slot);
    const Pair& p = heap.contacts.pair(slot);
    const std::uint32_t i = spheres.body[p.i], j = spheres.body[p.j];
    force[i] += e.force;
    force[j] -= e.force;
    torque[i] += e.torque_i + (spheres.position[p.i] - bodies.position[i]).cross(e.force);
    torque[j] += e.torque_j - (spheres.position[p.j] - bodies.position[j]).cross(e.force);
    dissipated += e.dissipated;
    strongest = std::max(strongest, e.force.norm());
    deepest = std::max(deepest, heap.overlap(slot) / std::min(spheres.radius[p.i], spheres.radius[p.j]));
  }
  ASSERT_GT(fresh, 20);
  ASSERT_GT(old, 20);
  ASSERT_NE((fresh + old) % 8, 0);  // the last batch is not full

  heap.contacts.keep_wrenches = true;
  const SweepReport report = sweep(heap.motions, heap.settings, heap.contacts, bodies);
  EXPECT_NEAR(report.dissipated, dissipated, 1e-11 * std::abs(dissipated));
  EXPECT_NEAR(report.overlap_ratio, deepest, 1e-13);
  for (std::size_t slot = 0; slot < pairs.size(); ++slot) {
    ASSERT_EQ(heap.contacts.touching(slot), touching[slot]);
    if (!touching[slot]) continue;
    const ContactWrench& wrench = heap.contacts.wrench[slot];
    const ContactMemory<double> memory = heap.contacts.memory(slot), &expected = pairs[slot].memory;
    // Eight lanes and one agree to 1e-13 k_N r.
    EXPECT_LT((vector(wrench.force) - pairs[slot].force).norm(),
              1e-13 * kStiffness * spheres.radius[heap.contacts.pair(slot).i]);
    expect_near(vector(wrench.torque_i), pairs[slot].torque_i, strongest);
    expect_near(vector(wrench.torque_j), pairs[slot].torque_j, strongest);
    EXPECT_NEAR(memory.c_n, expected.c_n, 1e-11 * expected.c_n);
    EXPECT_NEAR(memory.c_s, expected.c_s, 1e-11 * expected.c_s);
    expect_near(vector(memory.slide), vector(expected.slide), 1e-2);
    expect_near(vector(memory.roll), vector(expected.roll), 1e-2);
    EXPECT_NEAR(memory.twist, expected.twist, 1e-13);
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    expect_near(bodies.force[b], force[b], 10.0 * strongest);
    expect_near(bodies.torque[b], torque[b], 10.0 * strongest);
  }
}

TEST(Sweep, ActsPairByPairAsTheLawSays) {
  expect_pair_by_pair<kWholeSlip>(2, false);
  expect_pair_by_pair<kWholeCohesion>(1, false);
  expect_pair_by_pair<kFriction>(2, true);
}

TEST(Sweep, SpringsOfAPairThatPartsAreLostAndCounted) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const double x : {0.0, 2.99, 10.0, 13.05})  // the second pair is near, but apart
    add_body(bodies, ball, 0, bodies.size() % 2 == 0 ? 1.0 : 2.0, 2500.0, 0, {.position = {x, 0.0, 0.0}});
  SweepSettings settings;
  settings.dt = 1e-3;
  settings.features = kWholeCohesion;
  settings.material.assign(bodies.size(), 0);
  settings.laws = {make_pair_law(kMaterials[0], kMaterials[0], kStiffness)};
  ContactList contacts;
  Candidates().rebuild(bodies, {}, settings.features, contacts);
  ASSERT_EQ(contacts.slots(), 2u);
  contacts.set_memory(0, {1.0, 1.0, {0.0, 3e-3, 4e-3}, {0.0, 6e-3, 8e-3}, 7e-3});

  // Spring constants per area of the patch: k_N for rolling, 2 k_S for twisting.
  const double k_s = 2.0 / 7.0 * kStiffness, radius = 2.0 / 3.0, patch2 = std::pow(0.5 * radius, 2);
  const double springs = 0.5 * k_s * 25e-6 + 0.5 * kStiffness * patch2 * 100e-6 + k_s * patch2 * 49e-6;
  const double pressed = 0.5 * kStiffness * 1e-4 - 4e3 * std::pow(2.0 * 0.5 * radius, 2) * 0.01;
  EXPECT_NEAR(stored_energy(bodies, settings, contacts), springs + pressed, 1e-9 * springs);

  bodies.position[1].x() = 3.01;
  place_spheres(bodies);
  std::vector<SphereMotion> motions;
  compute_motions(bodies, std::vector<Vec3>(bodies.size(), Vec3::Zero()), settings.dt, motions);
  bodies.force[0] = Vec3(5.0, 5.0, 5.0);
  EXPECT_NEAR(sweep(motions, settings, contacts, bodies).dissipated, springs, 1e-12 * springs);
  EXPECT_EQ(stored_energy(bodies, settings, contacts), 0.0);
  EXPECT_EQ(bodies.force[0], Vec3(Vec3::Zero()));
  // When they meet again, the springs start anew.
  ContactMemory<double> memory = contacts.memory(0);
  EXPECT_EQ(vector(memory.slide), Vec3(Vec3::Zero()));
  EXPECT_EQ(vector(memory.roll), Vec3(Vec3::Zero()));
  EXPECT_EQ(memory.twist, 0.0);
}

// Candidates are others after a restart; what a series holds is not.
TEST(StoredEnergy, DependsOnContactsOnlyToTheLastBit) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  Random random(4, 0);
  for (int b = 0; b < 1000; ++b)
    add_body(bodies, ball, 0, 1.0, 2500.0, 0,
             {.position =
                  Vec3(1.95 * (b % 10), 1.95 * (b / 10 % 10), 1.95 * (b / 100)) + 1e-2 * random.in_ball()});
  SweepSettings settings;
  settings.features = kNormal;
  settings.material.assign(bodies.size(), 0);
  settings.laws = {make_pair_law({}, {}, kStiffness)};
  ContactList few, many;
  Candidates().rebuild(bodies, {}, kNormal, few);
  std::vector<Pair> pairs, touching;
  std::vector<ContactRecord> records;
  for (std::size_t slot = 0; slot < few.slots(); ++slot) {
    const Pair& p = few.pair(slot);
    if ((bodies.spheres.position[p.i] - bodies.spheres.position[p.j]).norm() < 2.0) touching.push_back(p);
    pairs.push_back(p);
    if (p.j < 600) pairs.push_back({p.i, p.j + 399});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  many.rebuild(pairs, bodies, kNormal);
  for (const Pair& p : touching) records.push_back({p.i, p.j, {1.0, 0.0, {}, {}, 0.0}});
  few.restore(records);
  many.restore(records);
  ASSERT_GT(many.slots(), few.slots() + 500);
  ASSERT_GT(records.size(), 2000u);
  EXPECT_EQ(stored_energy(bodies, settings, few), stored_energy(bodies, settings, many));
}

TEST(DeepestPair, IsTheOneOfLargestOverlapOverItsSmallerRadius) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  const auto put = [&](double x, double radius) {
    add_body(bodies, ball, 0, radius, 1.0, 0, {.position = {x, 0.0, 0.0}});
  };
  put(0.0, 5.0), put(9.8, 5.0), put(30.0, 1.0), put(31.9, 1.0), put(50.0, 5.0), put(59.7, 5.0);
  ContactList contacts;
  Candidates().rebuild(bodies, {}, kNormal, contacts);
  const Pair deepest = deepest_pair(bodies, contacts);
  EXPECT_EQ(deepest.i, 2u);
  EXPECT_EQ(deepest.j, 3u);
}

}  // namespace
}  // namespace cairn
