#include "core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

using Block = std::array<std::uint32_t, 4>;

TEST(Philox, AgreesWithTheKnownAnswersOfRandom123) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(philox({ones, ones, ones, ones}, {ones, ones}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, DependsOnSeedStreamAndIndexAlone) {
  Random a(1, 2), again(1, 2), other_seed(2, 2), other_stream(1, 3);
  for (int k = 0; k < 100; ++k) {
    const std::uint64_t bits = a.bits();
    EXPECT_EQ(bits, again.bits());
    EXPECT_NE(bits, other_seed.bits());
    EXPECT_NE(bits, other_stream.bits());
  }
}

TEST(Random, UniformNumbersFillEveryBinEqually) {
  constexpr int bins = 64, draws = 64'000;
  Random random(3, 0);
  std::array<int, bins> counts{};
  for (int k = 0; k < draws; ++k) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++counts[static_cast<std::size_t>(bins * u)];
  }
  double chi2 = 0.0;  // 63 degrees of freedom: mean 63, standard deviation 11.2
  for (int c : counts) chi2 += std::pow(c - draws / bins, 2) / (draws / bins);
  EXPECT_GT(chi2, 63.0 - 4.0 * 11.2);
  EXPECT_LT(chi2, 63.0 + 4.0 * 11.2);
}

TEST(Random, SuccessiveNumbersAreUncorrelated) {
  constexpr int draws = 100'000;
  Random random(4, 0);
  double previous = random.uniform() - 0.5, sum = 0.0;
  for (int k = 0; k < draws; ++k) {
    const double next = random.uniform() - 0.5;
    sum += 12.0 * previous * next;
    previous = next;
  }
  EXPECT_LT(std::abs(sum / draws), 4.0 / std::sqrt(draws));
}

TEST(Random, DirectionsAreUnitVectorsWithNoPreference) {
  constexpr int draws = 40'000;
  Random random(5, 0);
  Vec3 mean = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int k = 0; k < draws; ++k) {
    const Vec3 n = random.direction();
    ASSERT_NEAR(n.norm(), 1.0, 1e-14);
    mean += n / draws;
    second += n * n.transpose() / draws;
  }
  EXPECT_LT(mean.norm(), 4.0 / std::sqrt(draws));
  EXPECT_LT((second - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(), 4.0 * 0.3 / std::sqrt(draws));
}

TEST(Random, PointsFillTheBallEvenly) {
  constexpr int draws = 20'000;
  Random random(6, 0);
  std::vector<double> shell;
  for (int k = 0; k < draws; ++k) shell.push_back(std::pow(random.in_ball().norm(), 3));  // uniform in [0, 1)
  std::sort(shell.begin(), shell.end());
  double distance = 0.0;
  for (int k = 0; k < draws; ++k)
    distance = std::max(distance, std::abs(shell[static_cast<std::size_t>(k)] - (k + 0.5) / draws));
  EXPECT_LT(distance, 1.9 / std::sqrt(draws));  // Kolmogorov: exceeded once in 700
}

TEST(Random, RotationsTakeAnyDirectionToAnyOther) {
  constexpr int draws = 40'000;
  Random random(7, 0);
  Mat3 mean = Mat3::Zero();
  double angle = 0.0;
  for (int k = 0; k < draws; ++k) {
    const Quat q = random.rotation();
    ASSERT_NEAR(q.norm(), 1.0, 1e-14);
    mean += q.toRotationMatrix() / draws;
    angle += 2.0 * std::acos(std::min(1.0, std::abs(q.w()))) / draws;
  }
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 4.0 * 0.58 / std::sqrt(draws));
  EXPECT_NEAR(angle, 0.5 * kPi + 2.0 / kPi, 4.0 * 0.65 / std::sqrt(draws));  // mean angle over all rotations
}

}  // namespace
}  // namespace cairn
