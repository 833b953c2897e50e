#include "gravity/walk.h"

#include <gtest/gtest.h>

#include "clouds.h"

namespace cairn::gravity {
namespace {

// Counts how often each point is met by the points of one leaf: unit charges instead of expansions.
struct CountingKernel {
  using Local = std::vector<int>;  // meetings by source, so far
  using List = std::vector<std::uint32_t>;
  struct Scratch {};

  const Tree& tree;
  std::vector<Local>& counts;  // by target and source, in tree order

  Local descend(std::size_t, const Local& parent, const List& far, Scratch&) const {
    Local local = parent;
    local.resize(counts.size());
    for (const std::uint32_t c : far) {
      for (std::size_t j = tree.begin(c); j < tree.end(c); ++j) ++local[j];
    }
    return local;
  }
  void finish(std::size_t leaf, const Local& local, const List& near, const List& mixed, Scratch&) const {
    for (std::size_t i = tree.begin(leaf); i < tree.end(leaf); ++i) {
      counts[i] = local;
      for (const std::uint32_t c : near) {
        for (std::size_t j = tree.begin(c); j < tree.end(c); ++j) counts[i][j] += j != i;
      }
      for (const std::uint32_t c : mixed) {
        for (std::size_t j = tree.begin(c); j < tree.end(c); ++j) {
          counts[i][j] += tree.points().group[j] != tree.points().group[i];
        }
      }
    }
  }
};

void expect_each_pair_once(const Cloud& cloud, double theta, std::size_t leaf_size, double tolerance = 0.0) {
  Tree tree;
  tree.build(cloud.points(), leaf_size);
  std::vector<std::vector<int>> counts(cloud.size());
  const CountingKernel kernel{tree, counts};
  Walk(tree, Opening{.theta = theta, .tolerance = tolerance}, kernel).run();
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(counts[i].size(), cloud.size());
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      wrong += counts[i][j] != (tree.points().group[i] != tree.points().group[j]);
    }
  }
  EXPECT_EQ(wrong, 0u) << cloud.size() << " points, theta " << theta << ", leaves of " << leaf_size;
}

TEST(Walk, EveryTargetMeetsEverySourceOfOtherGroupsOnce) {
  for (const double theta : {0.0, 0.3, 0.7, 1.0}) {
    for (const std::size_t group : {1, 4, 60, 400}) {
      for (const std::size_t leaf_size : {1, 8, 20})
        expect_each_pair_once(ball(603, group), theta, leaf_size);
    }
  }
  for (const std::size_t n : {1, 2, 3, 20, 21}) expect_each_pair_once(ball(n), 0.7, 20);
}

TEST(Walk, GroupsOfSeveralSizesAmongLooseSpheres) {
  Cloud cloud = ball(400);
  Random random(9, 0);
  for (const std::size_t size : {300, 2, 50, 3}) {
    std::vector<Vec3> members;
    for (std::size_t i = 0; i < size; ++i) members.push_back(300.0 * random.in_ball());
    cloud.add_group(members, 1.0);
  }
  for (const double theta : {0.5, 1.0})
    for (const double tolerance : {0.0, 1e-7, 1e-5}) expect_each_pair_once(cloud, theta, 5, tolerance);
}

TEST(Tree, CellsHoldTheirPoints) {
  const Cloud cloud = ball(777, 3);
  Tree tree;
  tree.build(cloud.points(), 10);
  std::vector<int> seen(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) ++seen[tree.original(i)];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 777);
  for (std::size_t c = 0; c < tree.cells(); ++c) {
    for (std::size_t i = tree.begin(c); i < tree.end(c); ++i) {
      EXPECT_LE((cloud.x[tree.original(i)] - tree[c].centre).norm(), tree[c].radius * (1 + 1e-12));
    }
    if (tree.leaf(c)) {
      EXPECT_LE(tree.end(c) - tree.begin(c), 10u);
    } else {
      EXPECT_EQ(tree.begin(c), tree.begin(Tree::child(c, 0)));
      EXPECT_EQ(tree.end(Tree::child(c, 0)), tree.begin(Tree::child(c, 1)));
      EXPECT_EQ(tree.end(c), tree.end(Tree::child(c, 1)));
    }
  }
}

}  // namespace
}  // namespace cairn::gravity
