#include "contact/candidates.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

Bodies loose_spheres(std::size_t count) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (std::size_t b = 0; b < count; ++b) add_body(bodies, ball, 0, 1.0, 1.0, 0, {});
  return bodies;
}

TEST(ContactList, RebuildKeepsTheHistoriesOfTouchingPairs) {
  const Bodies bodies = loose_spheres(4);
  ContactList list;
  std::vector<Pair> pairs{{0, 1}, {0, 3}, {1, 2}, {2, 3}};
  list.rebuild(pairs, bodies, kWhole);
  const ContactMemory<double> first{1.0, 2.0, {3.0, 4.0, 5.0}, {6.0, 7.0, 8.0}, 9.0};
  ContactMemory<double> second = first;
  second.slide.y = -1.5;
  list.set_memory(1, first);
  list.set_memory(3, second);
  pairs = {{0, 2}, {0, 3}, {1, 3}, {2, 3}};
  list.rebuild(pairs, bodies, kWhole);

  const std::vector<ContactRecord> records = list.records();
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].i, 0u);
  EXPECT_EQ(records[0].j, 3u);
  EXPECT_EQ(records[0].memory.slide.z, 5.0);
  EXPECT_EQ(records[0].memory.roll.x, 6.0);
  EXPECT_EQ(records[0].memory.twist, 9.0);
  EXPECT_EQ(records[0].memory.c_s, 2.0);
  EXPECT_EQ(records[1].i, 2u);
  EXPECT_EQ(records[1].memory.slide.y, -1.5);
  EXPECT_FALSE(list.touching(0));
  EXPECT_FALSE(list.touching(2));
  list.release(1);
  EXPECT_EQ(list.records().size(), 1u);
}

TEST(ContactList, KnowsWhereTheWrenchesOfBothPartnersAreSummed) {
  constexpr std::uint32_t kBlock = 256;  // of so few spheres
  ContactList list;
  std::vector<Pair> pairs{{0, 2}, {0, kBlock}, {1, 2}, {2, kBlock}, {2, kBlock + 1}, {kBlock, kBlock + 1}};
  list.rebuild(pairs, loose_spheres(kBlock + 2), kNormal);
  ASSERT_EQ(list.block_size(kBlock + 2), kBlock);
  ASSERT_EQ(list.block_count(), 2u);
  EXPECT_EQ(list.blocks[1].body, kBlock);
  EXPECT_EQ(list.blocks[1].slot, 5u);
  EXPECT_EQ(list.blocks[2].sphere, kBlock + 2);
  EXPECT_EQ(list.blocks[2].slot, 6u);
  EXPECT_EQ(list.share_of_j, (std::vector<std::uint32_t>{2, kBlock, 2, kBlock, kBlock + 1, 1}));
  EXPECT_EQ(list.shares.size(), 2u);  // the first block reaches two others
  const auto earlier = [&](std::uint32_t s) {
    return std::vector<std::uint32_t>(list.earlier.begin() + list.earlier_begin[s],
                                      list.earlier.begin() + list.earlier_begin[s + 1]);
  };
  EXPECT_EQ(earlier(2), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(earlier(kBlock), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(earlier(kBlock + 1), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(list.sources, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(list.blocks[1].source, 0u);
  EXPECT_EQ(list.blocks[2].source, 1u);
}

TEST(ContactList, BlocksAreMadeOfWholeBodies) {
  Bodies bodies;
  const RigidShape rod = make_rigid(load_shape("rod4", "."), MassModel::union_volume);
  for (int b = 0; b < 100; ++b) add_body(bodies, rod, 0, 1.0, 1.0, 0, {});
  ContactList list;
  std::vector<Pair> pairs{{256, 399}};
  list.rebuild(pairs, bodies, kNormal);
  ASSERT_EQ(list.block_count(), 2u);
  EXPECT_EQ(list.blocks[1].sphere, 256u);
  EXPECT_EQ(list.blocks[1].body, 64u);
  EXPECT_EQ(list.blocks[1].slot, 0u);
  EXPECT_FALSE(list.blocks[0].balls);
}

/// A ball of aggregates that turns about z and moves on as one body.
struct TurningPile {
  Bodies bodies;
  RigidMotion motion{
      .center = {3.0, 4.0, 5.0}, .velocity = {2.0, -1.0, 0.5}, .spin = {0.1, 0.0, 0.4}, .time = 10.0};
  std::vector<Vec3> offset;
  std::vector<Quat> attitude;

  TurningPile() {
    const RigidShape shape = make_rigid(load_shape("diamond", "."), MassModel::union_volume);
    Random random(1, 0);
    for (int b = 0; b < 80; ++b) {
      offset.push_back(15.0 * random.in_ball());
      attitude.push_back(random.rotation());
      add_body(bodies, shape, 0, 1.0, 2500.0, 0, {.position = motion.center + offset.back()});
    }
    place(motion.time);
  }

  void place(double time) {
    const double t = time - motion.time;
    const Quat turn(Eigen::AngleAxisd(motion.spin.norm() * t, motion.spin.normalized()));
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies.position[b] = motion.center + t * motion.velocity + turn * offset[b];
      bodies.orientation[b] = turn * attitude[b];
    }
    place_spheres(bodies);
  }
};

TEST(Candidates, OfAPileThatTurnsAsOneBodyNeverExpire) {
  TurningPile pile;
  Candidates candidates;
  ContactList contacts;
  EXPECT_TRUE(candidates.expired(pile.bodies, pile.motion.time, contacts));
  candidates.rebuild(pile.bodies, pile.motion, kWhole, contacts);
  EXPECT_GT(contacts.slots(), 50u);
  for (double t = 10.0; t < 1000.0; t += 0.7) {
    pile.place(t);
    ASSERT_FALSE(candidates.expired(pile.bodies, t, contacts)) << t;
  }
  // One body that leaves its place by more than half the skin (a tenth of the smallest radius) ends the list.
  pile.place(500.0);
  pile.bodies.position[7].x() += 0.04;
  place_spheres(pile.bodies);
  EXPECT_FALSE(candidates.expired(pile.bodies, 500.0, contacts));
  pile.bodies.position[7].x() += 0.02;
  place_spheres(pile.bodies);
  EXPECT_TRUE(candidates.expired(pile.bodies, 500.0, contacts));
}

TEST(Candidates, HoldEveryTouchingPairUntilTheyExpire) {
  TurningPile pile;
  Candidates candidates;
  ContactList contacts;
  candidates.rebuild(pile.bodies, pile.motion, kWhole, contacts);
  Random random(2, 0);
  for (Vec3& x : pile.offset) x += 0.0499 * random.direction();  // almost half the skin, any way
  pile.place(60.0);
  ASSERT_FALSE(candidates.expired(pile.bodies, 60.0, contacts));
  const Spheres& s = pile.bodies.spheres;
  std::size_t touching = 0;
  for (std::uint32_t i = 0; i < s.size(); ++i)
    for (std::uint32_t j = i + 1; j < s.size(); ++j) {
      if (s.body[i] == s.body[j] || (s.position[i] - s.position[j]).norm() >= s.radius[i] + s.radius[j])
        continue;
      ++touching;
      bool listed = false;
      for (std::size_t slot = 0; slot < contacts.slots(); ++slot) listed |= contacts.pair(slot) == Pair{i, j};
      EXPECT_TRUE(listed) << i << ' ' << j;
    }
  EXPECT_GT(touching, 50u);
}

TEST(Candidates, KeepTouchingPairsThatHaveFlownApart) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const double x : {0.0, 1.9, 3.8}) add_body(bodies, ball, 0, 1.0, 1.0, 0, {.position = {x, 0.0, 0.0}});
  Candidates candidates;
  ContactList contacts;
  candidates.rebuild(bodies, {}, kWhole, contacts);
  ASSERT_EQ(contacts.slots(), 2u);
  ContactMemory<double> memory{};
  memory.twist = 0.25;
  contacts.set_memory(0, memory);
  contacts.set_memory(1, memory);
  bodies.position[0].x() = -50.0;
  place_spheres(bodies);
  candidates.rebuild(bodies, {}, kWhole, contacts);
  ASSERT_EQ(contacts.records().size(), 2u);  // each once
  EXPECT_EQ(contacts.slots(), 2u);
  EXPECT_EQ(contacts.memory(0).twist, 0.25);
  contacts.release(0);
  candidates.rebuild(bodies, {}, kWhole, contacts);
  EXPECT_EQ(contacts.slots(), 1u);
}

TEST(Candidates, SkinGrowsWhenListsAreShortLivedAndShrinksWhenTheyLast) {
  Bodies bodies;
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const double x : {0.0, 100.0})
    add_body(bodies, ball, 0, 1.0 + 0.01 * x, 1.0, 0, {.position = {x, 0.0, 0.0}});
  ContactList contacts;
  // Largest displacement (m) that a list made with this history outlives: half the skin.
  const auto half_skin = [&](std::uint64_t age, int times) {
    Candidates candidates;
    bodies.position[1].x() = 100.0;
    place_spheres(bodies);
    candidates.rebuild(bodies, {}, kNormal, contacts);
    for (int k = 0; k < times; ++k) candidates.adapt_skin(age, {});
    candidates.rebuild(bodies, {}, kNormal, contacts);
    for (double moved = 0.0;; moved += 0.005) {
      bodies.spheres.position[1].x() = 100.0 + moved;
      if (candidates.expired(bodies, 0.0, contacts)) return moved;
    }
  };
  EXPECT_NEAR(half_skin(100, 3), 0.05, 0.006);
  EXPECT_NEAR(half_skin(5, 1), 0.075, 0.006);
  EXPECT_NEAR(half_skin(5, 20), 0.5, 0.006);  // at most the smallest radius
  EXPECT_NEAR(half_skin(5000, 1), 0.035, 0.006);
  EXPECT_NEAR(half_skin(5000, 20), 0.01, 0.006);  // at least a fiftieth of it
}

/// Whether the sweep would look at every pair that overlaps.
void expect_all_seen(const Bodies& bodies, const ContactList& contacts, const Box& box = {}) {
  const Spheres& s = bodies.spheres;
  for (std::uint32_t i = 0; i < s.size(); ++i)
    for (std::uint32_t j = i + 1; j < s.size(); ++j) {
      Vec3 d = s.position[j] - s.position[i];
      if (box.periodic()) d += box.edge.cwiseProduct(box.nearest_image(d));
      if (s.body[i] == s.body[j] || d.norm() >= s.radius[i] + s.radius[j]) continue;
      bool seen = false;
      for (std::size_t slot = 0; slot < contacts.slots(); ++slot)
        seen |= contacts.pair(slot) == Pair{i, j} &&
                (contacts.touching(slot) || contacts.moved[i] + contacts.moved[j] >= -contacts.c_n[slot]);
      ASSERT_TRUE(seen) << i << ' ' << j;
    }
}

// A few that fly through the rest, slowly and fast, end the list of all but now and then.
TEST(Candidates, OfAFewThatFlyHaveSkinsOfTheirOwn) {
  for (const Box& box : {Box{}, Box{.edge = {40, 40, 40}}}) {
    TurningPile pile;
    Bodies& bodies = pile.bodies;
    Candidates candidates;
    ContactList contacts;
    RigidMotion still;
    still.center = pile.motion.center;
    candidates.rebuild(bodies, still, kWhole, contacts, box);
    const std::size_t slots = contacts.slots();
    std::size_t most_slots = 0;
    int lists = 0;
    std::uint64_t age = 0;
    Random random(3, 0);
    for (int step = 0; step < 600; ++step) {
      bodies.position[5].x() += 0.03;
      bodies.position[6].y() -= 0.004;
      for (Vec3& x : bodies.position) x += 1e-5 * random.direction();
      place_spheres(bodies);
      ++age;
      if (candidates.expired(bodies, 0.0, contacts, box)) {
        candidates.adapt_skin(age, contacts);
        candidates.rebuild(bodies, still, kWhole, contacts, box);
        most_slots = std::max(most_slots, contacts.slots());
        ++lists;
        age = 0;
      }
      expect_all_seen(bodies, contacts, box);
    }
    EXPECT_LE(lists, 12);  // with one skin for all, however wide, at least 600 * 0.03 / 0.5 = 36
    EXPECT_LE(most_slots, 2 * slots);
  }
}

TEST(Candidates, PositionThatIsNotFiniteExpires) {
  TurningPile pile;
  Candidates candidates;
  ContactList contacts;
  candidates.rebuild(pile.bodies, pile.motion, kNormal, contacts);
  pile.bodies.spheres.position[3].y() = std::nan("");
  EXPECT_TRUE(candidates.expired(pile.bodies, pile.motion.time, contacts));
}

}  // namespace
}  // namespace cairn
