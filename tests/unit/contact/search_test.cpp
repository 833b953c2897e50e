#include "contact/search.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/random.h"

namespace cairn {
namespace {

struct Cloud {
  std::vector<Vec3> positions;
  std::vector<double> radii;
  std::vector<std::uint32_t> body;

  void add(const Vec3& x, double r) { add(x, r, static_cast<std::uint32_t>(body.size())); }
  void add(const Vec3& x, double r, std::uint32_t b) {
    positions.push_back(x);
    radii.push_back(r);
    body.push_back(b);
  }
};

std::vector<Pair> brute_force(const Cloud& cloud, double gap) {
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < cloud.body.size(); ++i)
    for (std::uint32_t j = i + 1; j < cloud.body.size(); ++j) {
      const Vec3 d = cloud.positions[i] - cloud.positions[j];
      const double limit = (cloud.radii[i] + cloud.radii[j]) + gap;
      if (cloud.body[i] != cloud.body[j] && closer_than(d.x(), d.y(), d.z(), limit)) pairs.push_back({i, j});
    }
  return pairs;
}

std::vector<Pair> search(const Cloud& cloud, double gap) {
  std::vector<Pair> pairs;
  NeighbourSearch().find(cloud.positions, cloud.radii, cloud.body, gap, pairs);
  return pairs;
}

// Radii from 1 to `ratio` with n(r) ~ r^-3, in a ball that they would fill to `filling`.
Cloud power_law(std::size_t count, double ratio, double filling, std::uint64_t seed) {
  Random random(seed, 0);
  Cloud cloud;
  double volume = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = 1.0 / std::sqrt(random.uniform(1.0 / (ratio * ratio), 1.0));
    volume += r * r * r;
    cloud.add(Vec3::Zero(), r);
  }
  for (Vec3& x : cloud.positions) x = std::cbrt(volume / filling) * random.in_ball();
  return cloud;
}

// An exact cubic lattice: every contact distance is a tie of the strict inequality.
Cloud lattice(int side, double spacing, double radius) {
  Cloud cloud;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z) cloud.add(spacing * Vec3(x, y, z), radius);
  return cloud;
}

TEST(NeighbourSearch, MatchesBruteForceInRandomClouds) {
  for (const double gap : {0.0, 0.3, 5.0})
    for (const double ratio : {1.0 + 1e-9, 3.0, 8.0, 100.0, 1e4}) {
      const Cloud cloud = power_law(1000, ratio, 0.6, 7);
      const auto expected = brute_force(cloud, gap);
      EXPECT_FALSE(expected.empty());
      EXPECT_EQ(search(cloud, gap), expected) << "ratio " << ratio << " gap " << gap;
    }
}

TEST(NeighbourSearch, TouchingIsNotCloser) {
  const Cloud cloud = lattice(12, 2.0, 1.0);
  EXPECT_TRUE(search(cloud, 0.0).empty());
  const auto nearest = search(cloud, std::numeric_limits<double>::epsilon() * 2.0);
  EXPECT_EQ(nearest.size(), 3u * 12 * 12 * 11);
  EXPECT_EQ(nearest, brute_force(cloud, std::numeric_limits<double>::epsilon() * 2.0));
}

TEST(NeighbourSearch, LatticesFarFromTheOrigin) {
  for (const double offset : {0.0, -1e3, 1e9, -1e12}) {
    Cloud cloud = lattice(11, 1.9375, 1.0);
    for (Vec3& x : cloud.positions) x += Vec3(offset, 0.5 * offset, -offset);
    EXPECT_EQ(search(cloud, 0.9), brute_force(cloud, 0.9)) << offset;
  }
}

TEST(NeighbourSearch, FarDebris) {
  for (const double distance : {1e9, 1e12, 1e15, 1e200}) {
    Cloud cloud = power_law(1500, 20.0, 0.6, 3);
    Random random(1, 1);
    for (int k = 0; k < 200; ++k) {
      const Vec3 x = distance * random.direction();
      cloud.add(x, 1.0);
      cloud.add(x + Vec3(1.5, 0.0, 0.0), 2.0);
    }
    EXPECT_EQ(search(cloud, 0.1), brute_force(cloud, 0.1)) << distance;
  }
}

// Cells wrap round after 2^21: a cluster across the seam of all axes.
TEST(NeighbourSearch, SeamOfWrappedCells) {
  for (const double turns : {1.0, 3.0}) {
    Cloud cloud;
    Random random(6, 0);
    cloud.add(Vec3::Zero(), 1.0);
    for (int k = 0; k < 400; ++k)
      cloud.add(turns * 0x1p21 * 2.0 * Vec3::Ones() + 6.0 * random.in_ball(), k % 8 ? 1.0 : 0.15);
    EXPECT_EQ(search(cloud, 0.0), brute_force(cloud, 0.0));
  }
}

// Strangers that share a wrapped cell.
TEST(NeighbourSearch, WrappedCells) {
  Cloud cloud;
  Random random(5, 0);
  const double wrap = 0x1p21 * 2.0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double turns : {1.0, 2.0, 7.0})
      for (int k = 0; k < 200; ++k)
        cloud.add((turns * wrap - 5.0) * Vec3::Unit(axis) + 5.0 * random.in_ball(), 1.0);
  cloud.add(Vec3(0.0, 0.0, 0.0), 1.0);
  EXPECT_EQ(search(cloud, 0.0), brute_force(cloud, 0.0));
}

TEST(NeighbourSearch, CoincidentCentres) {
  Cloud cloud;
  for (int k = 0; k < 100; ++k) cloud.add(Vec3(1.0, 2.0, 3.0), k % 2 ? 1.0 : 40.0);
  EXPECT_EQ(search(cloud, 0.0).size(), 100u * 99 / 2);
  EXPECT_EQ(search(cloud, 0.0), brute_force(cloud, 0.0));
}

TEST(NeighbourSearch, LongRow) {
  Cloud cloud;
  for (int k = 0; k < 2500; ++k) cloud.add(Vec3(0.0, 0.0, 1.9 * ((k * 7) % 2500)), k % 5 ? 1.0 : 0.1);
  EXPECT_EQ(search(cloud, 0.2), brute_force(cloud, 0.2));
}

TEST(NeighbourSearch, SpheresOfOneBodyAreNoPairs) {
  Cloud cloud = power_law(500, 5.0, 0.6, 2);
  for (std::uint32_t& b : cloud.body) b /= 4;
  EXPECT_EQ(search(cloud, 0.2), brute_force(cloud, 0.2));
  cloud.body.assign(cloud.body.size(), 9);
  EXPECT_TRUE(search(cloud, 0.2).empty());
}

TEST(NeighbourSearch, EmptyAndSingle) {
  Cloud cloud;
  EXPECT_TRUE(search(cloud, 1.0).empty());
  cloud.add(Vec3::Zero(), 1.0);
  EXPECT_TRUE(search(cloud, 1.0).empty());
}

TEST(NeighbourSearch, ScratchOfAnotherSceneDoesNotMatter) {
  NeighbourSearch reused;
  std::vector<Pair> pairs{{1, 2}};
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Cloud cloud = power_law(400 * seed, seed == 2 ? 50.0 : 2.0, 0.5, seed);
    reused.find(cloud.positions, cloud.radii, cloud.body, 0.1, pairs);
    EXPECT_EQ(pairs, brute_force(cloud, 0.1));
  }
  reused.find({}, {}, {}, 0.1, pairs);
  EXPECT_TRUE(pairs.empty());
}

TEST(NeighbourSearch, SameForAnyNumberOfThreads) {
  const Cloud cloud = power_law(20000, 10.0, 0.6, 4);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = search(cloud, 0.1);
  for (const int count : {2, 5}) {
    omp_set_num_threads(count);
    EXPECT_EQ(search(cloud, 0.1), one);
  }
  omp_set_num_threads(threads);
}

TEST(NeighbourSearch, NamesTheUnusableSphere) {
  Cloud cloud = lattice(10, 2.0, 1.0);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Cloud broken = cloud;
    broken.positions[321].y() = bad;
    try {
      search(broken, 0.1);
      FAIL();
    } catch (const UnstableError& error) {
      EXPECT_NE(std::string(error.what()).find("sphere 321 "), std::string::npos) << error.what();
    }
    broken = cloud;
    broken.radii[5] = bad;
    EXPECT_THROW(search(broken, 0.1), InputError);
    EXPECT_THROW(search(cloud, bad), InputError);
  }
  cloud.radii[7] = 0.0;
  EXPECT_THROW(search(cloud, 0.1), InputError);
  cloud.radii[7] = 1.0;
  EXPECT_THROW(search(cloud, -0.1), InputError);
}

}  // namespace
}  // namespace cairn
