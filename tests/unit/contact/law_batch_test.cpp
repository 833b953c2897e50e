// Several contacts at once agree with one, on every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "unit/contact/law_batch_test.cpp"
#include <hwy/foreach_target.h>

#include <gtest/gtest.h>

#include "contact/law/pair.h"
#include "core/instruction_set.h"
#include "unit/contact/random_contact-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {
namespace {

/// The lanes of a batch for one number of each state.
template <class Of>
Batch gather(const State (&states)[kLanes], const Of& of) {
  Lanes out;
  for (std::size_t l = 0; l < kLanes; ++l) out[l] = of(states[l]);
  return out.batch();
}
template <class Of>
Triple<Batch> gather_vectors(const State (&states)[kLanes], const Of& of) {
  return {gather(states, [&](const State& s) { return of(s).x; }),
          gather(states, [&](const State& s) { return of(s).y; }),
          gather(states, [&](const State& s) { return of(s).z; })};
}

template <Features F>
void expect_agreement(const PairLaw& law) {
  Random random(2, 0);
  for (int round = 0; round < 50; ++round) {
    State one[kLanes];
    for (State& s : one) s = random_state(random);
    ContactGeometry<Batch> geometry;
    ContactMotion<Batch> motion;
    ContactMemory<Batch> memory;
    geometry.n = gather_vectors(one, [](const State& s) { return s.geometry.n; });
    geometry.n_mid = gather_vectors(one, [](const State& s) { return s.geometry.n_mid; });
    geometry.overlap = gather(one, [](const State& s) { return s.geometry.overlap; });
    geometry.radius = gather(one, [](const State& s) { return s.geometry.radius; });
    geometry.slip_lever = gather(one, [](const State& s) { return s.geometry.slip_lever; });
    motion.u = gather_vectors(one, [](const State& s) { return s.motion.u; });
    motion.w = gather_vectors(one, [](const State& s) { return s.motion.w; });
    motion.u_mid = gather_vectors(one, [](const State& s) { return s.motion.u_mid; });
    motion.w_mid = gather_vectors(one, [](const State& s) { return s.motion.w_mid; });
    motion.turn = gather_vectors(one, [](const State& s) { return s.motion.turn; });
    motion.dt = gather(one, [](const State& s) { return s.motion.dt; });
    memory.c_n = gather(one, [](const State& s) { return s.memory.c_n; });
    memory.c_s = gather(one, [](const State& s) { return s.memory.c_s; });
    memory.slide = gather_vectors(one, [](const State& s) { return s.memory.slide; });
    memory.roll = gather_vectors(one, [](const State& s) { return s.memory.roll; });
    memory.twist = gather(one, [](const State& s) { return s.memory.twist; });
    const ContactAction<Batch> all = evaluate<F>(LawConstants<Batch>(law), geometry, motion, memory);
    for (std::size_t l = 0; l < kLanes; ++l) {
      State& s = one[l];
      const ContactAction<double> action =
          evaluate<F>(LawConstants<double>(law), s.geometry, s.motion, s.memory);
      const auto same = [&](const Triple<Batch>& a, const Triple<double>& b) {
        const Vec3 from(Lanes(a.x)[l], Lanes(a.y)[l], Lanes(a.z)[l]);
        EXPECT_LE((from - vector(b)).norm(), 1e-13 * vector(b).norm());
      };
      same(all.force, action.force);
      same(all.couple, action.couple);
      EXPECT_NEAR(Lanes(all.dissipated)[l], action.dissipated, 1e-12 * std::abs(action.dissipated));
      same(memory.slide, s.memory.slide);
      same(memory.roll, s.memory.roll);
      EXPECT_NEAR(Lanes(memory.twist)[l], s.memory.twist, 1e-13 * std::abs(s.memory.twist));
    }
  }
}

}  // namespace

void expect_agreement_of_all(const PairLaw& law) {
  expect_agreement<kNormal>(law);
  expect_agreement<kNormalCohesion>(law);
  expect_agreement<kFriction>(law);
  expect_agreement<kFrictionCohesion>(law);
  expect_agreement<kWhole>(law);
  expect_agreement<kWholeCohesion>(law);
  expect_agreement<kWholeSlip>(law);
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn {

HWY_EXPORT(expect_agreement_of_all);

TEST(Law, SeveralContactsAtOnceAgreeWithOne) {
  const Material m{.name = "m",
                   .restitution_normal = 0.6,
                   .restitution_tangential = 0.4,
                   .friction = 0.8,
                   .cohesion = 50.0};
  for (const std::string& name : instruction_sets()) {
    SCOPED_TRACE(name);
    use_instruction_set(name);
    HWY_DYNAMIC_DISPATCH(expect_agreement_of_all)(make_pair_law(m, m, 1e6));
  }
  use_instruction_set(instruction_sets().front());
}

}  // namespace cairn
#endif
