// Principal frames and gravity masses.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "core/error.h"
#include "shape/gravity_masses.h"
#include "shape/library.h"
#include "unit/shape/clusters.h"

namespace cairn {
namespace {

using test::moved;
using test::random_cluster;

void expect_balanced(const RigidShape& rigid) {
  double sum = 0.0;
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < rigid.offsets.size(); ++i) {
    EXPECT_GT(rigid.mass_fractions[i], 0.0);
    sum += rigid.mass_fractions[i];
    moment += rigid.mass_fractions[i] * rigid.offsets[i];
  }
  EXPECT_NEAR(sum, 1.0, 1e-14);
  EXPECT_LT(moment.norm(), 1e-14 * rigid.bounding_radius);
}

// Weights that spread the volume.
std::vector<double> proportional(const Shape& shape) {
  std::vector<double> weights;
  for (const double r : shape.radii) weights.push_back(r * r * r);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= total;
  return weights;
}

struct Published {
  const char* name;
  Vec3 inertia;  // per mass, unit radius
  double mass_ratio;
};

TEST(MakeRigid, PublishedAggregates) {
  for (const Published& known : {Published{"dumbbell", {0.4041, 1.1644, 1.1644}, 1.0130},
                                 {"tetrahedron", {1.1838, 1.1838, 1.1838}, 1.0401},
                                 {"rod4", {0.4062, 4.1914, 4.1914}, 1.0197},
                                 {"diamond", {0.7806, 1.9135, 2.2915}, 1.0080},
                                 {"cube", {1.9338, 1.9338, 1.9338}, 1.0401}}) {
    SCOPED_TRACE(known.name);
    const Shape shape = load_shape(known.name);
    const RigidShape rigid = make_rigid(shape, MassModel::union_volume);
    EXPECT_LT((rigid.inertia - known.inertia).cwiseAbs().maxCoeff(), 5.1e-5);
    const RigidShape summed = make_rigid(shape, MassModel::spheres);
    EXPECT_NEAR(summed.volume / rigid.volume, known.mass_ratio, 5.1e-5);
    EXPECT_LT(summed.moment_error, 1e-14);  // its masses are the spheres' own
    EXPECT_TRUE(rigid.axes.isApprox(Quat::Identity(), 1e-14));
  }
}

TEST(MakeRigid, RandomClusters) {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const MassModel model : {MassModel::spheres, MassModel::union_volume}) {
      const Shape shape = random_cluster(15, seed);
      const RigidShape rigid = make_rigid(shape, model);
      expect_balanced(rigid);
      EXPECT_LE(rigid.inertia[0], rigid.inertia[1]);
      EXPECT_LE(rigid.inertia[1], rigid.inertia[2]);
      EXPECT_NEAR(rigid.axes.norm(), 1.0, 1e-15);
      const Mat3 axes = rigid.axes.toRotationMatrix();
      const MassProperties mass =
          model == MassModel::spheres ? sum_of_spheres(shape) : union_of_spheres(shape);
      const Mat3 inertia = rigid.volume * axes * rigid.inertia.asDiagonal() * axes.transpose();
      EXPECT_LT((inertia - mass.inertia).norm(), 1e-13 * mass.inertia.norm());
      EXPECT_EQ(rigid.volume, mass.volume);
      double farthest = 0.0;
      for (std::size_t i = 0; i < shape.radii.size(); ++i) {
        EXPECT_LT((rigid.center + axes * rigid.offsets[i] - shape.centers[i]).norm(), 1e-14);
        farthest = std::max(farthest, (shape.centers[i] - rigid.center).norm() + shape.radii[i]);
      }
      EXPECT_NEAR(rigid.bounding_radius, farthest, 1e-13);
    }
}

TEST(MakeRigid, MomentErrorComparesInertias) {
  // The masses of a dumbbell are halves at its centres: 2/5 along it, 2/5 + 3/4 across.
  const RigidShape rigid = make_rigid(load_shape("dumbbell"), MassModel::union_volume);
  const Vec3 masses(0.4, 1.15, 1.15);
  EXPECT_NEAR(rigid.moment_error, (masses - rigid.inertia).norm() / rigid.inertia.norm(), 1e-14);
}

TEST(MakeRigid, SphereIsExact) {
  const RigidShape rigid = make_rigid({"", "", {{1.0, 0.3, -0.7}}, {0.3}}, MassModel::union_volume);
  EXPECT_EQ(rigid.offsets[0], Vec3::Zero());
  EXPECT_EQ(rigid.axes.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(rigid.mass_fractions[0], 1.0);
  EXPECT_EQ(rigid.inertia[0], rigid.inertia[2]);
  EXPECT_NEAR(rigid.inertia[0], 0.4 * 0.09, 1e-16);
}

TEST(MakeRigid, AxesStayNearTheFile) {
  const Quat z_to_y(Eigen::AngleAxisd(kPi / 2.0, Vec3::UnitX()));
  const Mat3 rod =
      make_rigid(moved(load_shape("rod4"), Quat(Eigen::AngleAxisd(kPi / 2.0, Vec3::UnitZ())), Vec3::Zero()),
                 MassModel::union_volume)
          .axes.toRotationMatrix();
  EXPECT_LT((rod - (Mat3() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished()).norm(), 1e-14) << rod;
  const Mat3 diamond = make_rigid(moved(load_shape("diamond"), z_to_y, Vec3::Zero()), MassModel::union_volume)
                           .axes.toRotationMatrix();  // moments ascend along x, z, y
  EXPECT_NEAR(diamond(0, 0), 1.0, 1e-14) << diamond;
  EXPECT_NEAR(std::abs(diamond(2, 1)), 1.0, 1e-14) << diamond;
}

TEST(MakeRigid, RejectsUnusableShapes) {
  EXPECT_THROW(make_rigid({"none", "", {}, {}}, MassModel::spheres), InputError);
  EXPECT_THROW(make_rigid({"nan", "", {{std::nan(""), 0, 0}}, {1.0}}, MassModel::spheres), InputError);
  EXPECT_THROW(make_rigid({"flat", "", {{0, 0, 0}}, {0.0}}, MassModel::spheres), InputError);
  // The second sphere is inside the first: the body's centre is at the end of the hull of centres.
  EXPECT_THROW(make_rigid({"hidden", "", {{0, 0, 0}, {0.3, 0, 0}}, {1.0, 0.5}}, MassModel::union_volume),
               InputError);
}

// Four masses are fixed by the four conditions.
TEST(GravityMasses, FourSpheresHaveOneSolution) {
  int balanced = 0, impossible = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, 9);
    const Shape shape = random_cluster(4, seed);
    const std::vector<double> weights = proportional(shape);
    std::vector<Vec3> offsets = shape.centers;
    const Vec3 center = 0.4 * random.in_ball();
    Eigen::Matrix4d conditions;
    for (int i = 0; i < 4; ++i) {
      offsets[static_cast<std::size_t>(i)] -= center;
      conditions.col(i) << 1.0, offsets[static_cast<std::size_t>(i)];
    }
    const Eigen::Vector4d exact = conditions.partialPivLu().solve(Eigen::Vector4d::UnitX());
    double least = 1.0;
    for (int i = 0; i < 4; ++i) least = std::min(least, exact[i] / weights[static_cast<std::size_t>(i)]);
    const std::vector<double> masses = gravity_masses(offsets, weights);
    EXPECT_EQ(masses.empty(), least < 1e-3) << "seed " << seed << " least share " << least;
    (masses.empty() ? impossible : balanced) += 1;
    for (std::size_t i = 0; i < masses.size(); ++i)
      EXPECT_NEAR(masses[i], exact[static_cast<Eigen::Index>(i)], 1e-10);
  }
  EXPECT_GT(balanced, 10);
  EXPECT_GT(impossible, 10);
}

// With some masses at the floor, the others still are the nearest: no balanced shift of mass between spheres
// reduces the cost.
TEST(GravityMasses, NearestAlsoAtTheFloor) {
  int at_floor = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Shape shape = random_cluster(7, seed);
    const std::vector<double> weights = proportional(shape);
    std::vector<Vec3> offsets = shape.centers;
    Random random(seed, 8);
    const Vec3 center = 0.6 * random.in_ball();
    for (Vec3& offset : offsets) offset -= center;
    const std::vector<double> masses = gravity_masses(offsets, weights);
    if (masses.empty()) continue;
    // Multipliers from the free masses: m / w = multipliers . (1, d).
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < masses.size(); ++i)
      if (masses[i] > 1.0001e-3 * weights[i]) free.push_back(i);
    if (free.size() < 4) continue;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const std::size_t i : free) {
      const Eigen::Vector4d a(1.0, offsets[i].x(), offsets[i].y(), offsets[i].z());
      normal += a * a.transpose();
      right += a * (masses[i] / weights[i]);
    }
    const Eigen::Vector4d multipliers = normal.partialPivLu().solve(right);
    for (std::size_t i = 0; i < masses.size(); ++i) {
      const double share =
          multipliers.dot(Eigen::Vector4d(1.0, offsets[i].x(), offsets[i].y(), offsets[i].z()));
      EXPECT_NEAR(std::max(share, 1e-3), masses[i] / weights[i], 1e-8) << "seed " << seed;
    }
    at_floor += free.size() < masses.size() ? 1 : 0;
  }
  EXPECT_GT(at_floor, 5);
}

TEST(GravityMasses, CoplanarCentresOfAnySlope) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed, 3);
    const Quat turn = random.rotation();
    Shape shape{"plane", "", {}, {}};
    for (int k = 0; k < 10; ++k) {
      shape.centers.push_back(turn * Vec3(std::cos(0.2 * kPi * k), 0.7 * std::sin(0.2 * kPi * k), 0.0));
      shape.radii.push_back(0.8);
    }
    expect_balanced(make_rigid(shape, MassModel::union_volume));
  }
}

// Thousands of equal spheres on a lattice: what rounds off must not be taken for an imbalance.
TEST(GravityMasses, RegularShapesOfThousandsOfSpheres) {
  const auto block = [](int nx, int ny, int nz, const auto& inside) {
    Shape shape{"block", "", {}, {}};
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        for (int k = 0; k < nz; ++k)
          if (inside(i, j, k)) {
            shape.centers.push_back({2.0 * i, 2.0 * j, 2.0 * k});
            shape.radii.push_back(1.0);
          }
    return shape;
  };
  const auto all = [](int, int, int) { return true; };
  const auto shell = [](int i, int j, int k) {
    return i == 0 || j == 0 || k == 0 || i == 29 || j == 29 || k == 29;
  };
  const auto even = [](int i, int j, int k) { return (i + j + k) % 2 == 0; };  // face-centred cubic
  for (const Shape& shape : {block(20, 20, 20, all), block(27, 27, 27, all), block(20000, 1, 1, all),
                             block(140, 140, 1, all), block(30, 30, 30, shell), block(26, 26, 26, even)}) {
    SCOPED_TRACE(shape.radii.size());
    Random random(5, shape.radii.size());
    for (const Shape& placed : {shape, moved(shape, random.rotation(), {1.0, -20.0, 300.0})}) {
      const RigidShape rigid = make_rigid(placed, MassModel::spheres);
      const double count = static_cast<double>(placed.radii.size());
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < placed.radii.size(); ++i) {
        EXPECT_NEAR(rigid.mass_fractions[i] * count, 1.0, 1e-10);
        moment += rigid.mass_fractions[i] * rigid.offsets[i];
      }
      EXPECT_LT(moment.norm(), 1e-13 * rigid.bounding_radius);
    }
  }
}

// A centre of mass far from the middle of the centres, so that many masses are the smallest allowed.
TEST(GravityMasses, ThousandsOfMassesOfWhichManyMeetTheFloor) {
  Random random(6, 0);
  std::vector<Vec3> offsets;
  for (int i = 0; i < 20000; ++i) offsets.push_back(random.in_ball() - Vec3(0.75, 0.1, 0.0));
  const std::vector<double> weights(offsets.size(), 1.0 / 20000);
  const std::vector<double> masses = gravity_masses(offsets, weights);
  ASSERT_EQ(masses.size(), offsets.size());
  double sum = 0.0;
  Vec3 moment = Vec3::Zero();
  std::size_t least = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    least += masses[i] < 1.0001e-3 * weights[i];
    sum += masses[i];
    moment += masses[i] * offsets[i];
  }
  EXPECT_GT(least, 5000u);
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT(moment.norm(), 1e-12);
}

}  // namespace
}  // namespace cairn
