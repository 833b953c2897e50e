#include "sim/fields.h"

#include <gtest/gtest.h>

#include "folder.h"
#include "shape/library.h"

namespace cairn {
namespace {

/// A state in which no two numbers are the same.
State state_of_many_numbers() {
  State s;
  const RigidShape shape = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume);
  double last = 0.0;
  const auto number = [&] { return last += 1.0; };
  const auto vector = [&] { return Vec3(number(), number(), number()); };
  for (int b = 0; b < 3; ++b)
    add_body(s.bodies, shape, 0, number(), number(), 0,
             {.position = vector(),
              .orientation = Quat(number(), number(), number(), number()).normalized(),
              .velocity = vector(),
              .angular_velocity = vector()});
  for (int b = 0; b < 3; ++b) {
    s.bodies.force[b] = vector();
    s.bodies.torque[b] = vector();
    for (gravity::Wrenches* w : {&s.gravity.from, &s.gravity.to, &s.gravity.evaluated}) {
      w->force.push_back(vector());
      w->torque.push_back(vector());
    }
  }
  for (int i = 0; i < 4; ++i) s.gravity.places.push_back(vector());
  s.gravity.evaluated_time = number();
  s.gravity.interval = number();
  s.gravity.steps = 7;
  s.gravity.due = 35;
  s.gravity.attitude = Quat(number(), number(), number(), number());
  s.gravity.miss = number();
  s.gravity.time = number();
  s.gravity.omega = vector();
  s.remnant = {1, 0, 1};
  s.clock = {2, 30, 40, 500, number(), number()};
  s.control = {true,     true,     true,     number(), number(), number(), number(), number(),
               number(), number(), number(), number(), number(), number(), number(), 77};
  s.relaxation = {{0, 1, 0}, number(), 12};
  s.frame = {vector(), vector()};
  s.shift = {vector(), vector()};
  s.ledger = {number(), number(), number(), number(),
              number(), number(), vector(), {number(), vector(), vector(), {vector(), vector(), number()}},
              vector(), true,     number(), number(),
              vector(), vector()};
  s.k_n = number();
  s.region_volume = number();
  s.stage_starts = {0.0, number(), number()};
  return s;
}

std::vector<ContactRecord> two_contacts(double base) {
  return {{0, 2, {base, 2.0, {3.0, 4.0, 5.0}, {6.0, 7.0, 8.0}, 9.0}},
          {1, 3, {base + 1.0, 12.0, {13.0, 14.0, 15.0}, {16.0, 17.0, 18.0}, 19.0}}};
}

void expect_same(const std::vector<ContactRecord>& a, const std::vector<ContactRecord>& b) {
  ASSERT_EQ(a.size(), b.size());
  const auto numbers = [](const ContactMemory<double>& m) {
    return std::vector{m.c_n, m.c_s, m.slide.x, m.slide.y, m.slide.z, m.roll.x, m.roll.y, m.roll.z, m.twist};
  };
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].i, b[k].i);
    EXPECT_EQ(a[k].j, b[k].j);
    EXPECT_EQ(numbers(a[k].memory), numbers(b[k].memory));
  }
}

TEST(Checkpoint, HoldsTheWholeState) {
  const Folder folder;
  State s = state_of_many_numbers();
  ContactColumns contacts;
  WallColumns walls;
  contacts.assign(two_contacts(1.0));
  std::vector<WallContact> touches;
  for (const ContactRecord& r : two_contacts(100.0)) touches.push_back({r.i, r.j, r.i + 7, r.memory});
  walls.assign(touches);
  ResultFile file = ResultFile::create(folder / "state.h5", {}, false);
  file.commit(checkpoint_fields(s, contacts.table(), walls));

  State r;
  ContactColumns contacts_read;
  WallColumns walls_read;
  file.read_checkpoint(checkpoint_fields(r, contacts_read.table(), walls_read));
  expect_same(contacts_read.records(), two_contacts(1.0));
  std::vector<ContactRecord> walls_back;
  for (const WallContact& w : walls_read.contacts()) {
    walls_back.push_back({w.sphere, w.wall, w.memory});
    EXPECT_EQ(w.feature, w.sphere + 7);
  }
  expect_same(walls_back, two_contacts(100.0));
  EXPECT_EQ(r.bodies.position, s.bodies.position);
  EXPECT_EQ(r.bodies.velocity, s.bodies.velocity);
  EXPECT_EQ(r.bodies.spin, s.bodies.spin);
  EXPECT_EQ(r.bodies.force, s.bodies.force);
  EXPECT_EQ(r.bodies.torque, s.bodies.torque);
  ASSERT_EQ(r.bodies.orientation.size(), 3u);
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_EQ(r.bodies.orientation[b].coeffs(), s.bodies.orientation[b].coeffs());
  EXPECT_EQ(r.remnant, s.remnant);
  EXPECT_EQ(r.region_volume, s.region_volume);
  EXPECT_EQ(r.stage_starts, s.stage_starts);
  EXPECT_EQ(r.ledger.field_momentum, s.ledger.field_momentum);
  EXPECT_EQ(r.ledger.rebase, s.ledger.rebase);
  EXPECT_EQ(r.gravity.from.force, s.gravity.from.force);
  EXPECT_EQ(r.gravity.from.torque, s.gravity.from.torque);
  EXPECT_EQ(r.gravity.to.force, s.gravity.to.force);
  EXPECT_EQ(r.gravity.to.torque, s.gravity.to.torque);
  EXPECT_EQ(r.gravity.evaluated.force, s.gravity.evaluated.force);
  EXPECT_EQ(r.gravity.evaluated.torque, s.gravity.evaluated.torque);
  EXPECT_EQ(r.gravity.places, s.gravity.places);
  EXPECT_EQ(r.gravity.evaluated_time, s.gravity.evaluated_time);
  EXPECT_EQ(r.gravity.interval, s.gravity.interval);
  EXPECT_EQ(r.gravity.steps, s.gravity.steps);
  EXPECT_EQ(r.gravity.due, s.gravity.due);
  EXPECT_EQ(r.gravity.attitude.coeffs(), s.gravity.attitude.coeffs());
  EXPECT_EQ(r.gravity.miss, s.gravity.miss);
  EXPECT_EQ(r.gravity.time, s.gravity.time);
  EXPECT_EQ(r.gravity.omega, s.gravity.omega);
  EXPECT_EQ(r.clock.stage, 2u);
  EXPECT_EQ(r.clock.step, 30u);
  EXPECT_EQ(r.clock.steps, 40u);
  EXPECT_EQ(r.clock.total_steps, 500u);
  EXPECT_EQ(r.clock.stage_start, s.clock.stage_start);
  EXPECT_EQ(r.clock.dt, s.clock.dt);
  EXPECT_TRUE(r.control == s.control);
  EXPECT_EQ(r.ledger.dissipated, s.ledger.dissipated);
  EXPECT_EQ(r.ledger.control_work, s.ledger.control_work);
  EXPECT_EQ(r.ledger.relaxed, s.ledger.relaxed);
  EXPECT_EQ(r.relaxation.pile, s.relaxation.pile);
  EXPECT_EQ(r.relaxation.scale, s.relaxation.scale);
  EXPECT_EQ(r.relaxation.look, s.relaxation.look);
  EXPECT_EQ(r.ledger.control_momentum, s.ledger.control_momentum);
  EXPECT_EQ(r.ledger.perturbers.work, s.ledger.perturbers.work);
  EXPECT_EQ(r.ledger.perturbers.momentum, s.ledger.perturbers.momentum);
  EXPECT_EQ(r.ledger.perturbers.angular_momentum, s.ledger.perturbers.angular_momentum);
  EXPECT_EQ(r.ledger.perturbers.rates.force, s.ledger.perturbers.rates.force);
  EXPECT_EQ(r.ledger.perturbers.rates.torque, s.ledger.perturbers.rates.torque);
  EXPECT_EQ(r.ledger.perturbers.rates.power, s.ledger.perturbers.rates.power);
  EXPECT_EQ(r.frame.position, s.frame.position);
  EXPECT_EQ(r.frame.velocity, s.frame.velocity);
  EXPECT_EQ(r.shift.position, s.shift.position);
  EXPECT_EQ(r.shift.velocity, s.shift.velocity);
  EXPECT_EQ(r.ledger.largest_overlap, s.ledger.largest_overlap);
  EXPECT_EQ(r.ledger.recent_overlap, s.ledger.recent_overlap);
  EXPECT_EQ(r.ledger.start_momentum, s.ledger.start_momentum);
  EXPECT_EQ(r.ledger.start_angular_momentum, s.ledger.start_angular_momentum);
  EXPECT_EQ(r.k_n, s.k_n);
}

TEST(Constants, ReturnFromTheFile) {
  const Folder folder;
  State s = state_of_many_numbers();
  std::vector<std::string> shapes{"dumbbell"}, shapes_read;
  ResultFile file = ResultFile::create(folder / "state.h5", {}, false);
  file.write_static("bodies", body_constants(s.bodies));
  file.write_static("spheres", sphere_constants(s.bodies));
  file.write_static("shapes", {{"name", "", "", &shapes}});
  file.commit();
  Bodies r;
  read_constants(file, r, shapes_read);
  EXPECT_EQ(shapes_read, shapes);
  EXPECT_EQ(r.mass, s.bodies.mass);
  EXPECT_EQ(r.inertia, s.bodies.inertia);
  EXPECT_EQ(r.length, s.bodies.length);
  EXPECT_EQ(r.shape, s.bodies.shape);
  EXPECT_EQ(r.material, s.bodies.material);
  EXPECT_EQ(r.first_sphere, s.bodies.first_sphere);
  EXPECT_EQ(r.spheres.radius, s.bodies.spheres.radius);
  EXPECT_EQ(r.spheres.mass, s.bodies.spheres.mass);
  EXPECT_EQ(r.spheres.offset, s.bodies.spheres.offset);
  EXPECT_EQ(r.spheres.body, s.bodies.spheres.body);
}

}  // namespace
}  // namespace cairn
