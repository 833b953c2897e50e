// Spheres that stand for meshes: distances checked by other ways, and what a budget buys.
#include "shape/fit.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "models.h"
#include "shape/fit_error.h"
#include "shape/shape_file.h"
#include "shape/surface_samples.h"
#include "shape/union_surface.h"

namespace cairn {
namespace {

Shape fitted(const TriangleMesh& mesh, std::size_t spheres, FitStrategy strategy = FitStrategy::best,
             MassModel mass = MassModel::mesh) {
  return fit_spheres(make_solid(mesh), {.spheres = spheres, .strategy = strategy, .mass = mass});
}

double rms(const Shape& shape) {
  return shape.source->error.rms;
}

TEST(UnionSurface, TwoBallsAgainstClosedForms) {
  // Unit balls 1.2 apart meet in a circle of radius 0.8 in the plane x = 0.
  const Shape pair{"", "", {{-0.6, 0, 0}, {0.6, 0, 0}}, {1.0, 1.0}};
  const UnionSurface surface(pair);
  EXPECT_NEAR(surface.distance({0, 0, 0}, 2.0), -0.8, 1e-15);    // the circle
  EXPECT_NEAR(surface.distance({0, 0.3, 0}, 2.0), -0.5, 1e-15);  // its near side
  EXPECT_NEAR(surface.distance({0.1, 0, 0}, 2.0), -std::hypot(0.1, 0.8), 1e-15);
  EXPECT_NEAR(surface.distance({0.6, 0.5, 0}, 2.0), -0.5, 1e-15);  // a ball
  EXPECT_NEAR(surface.distance({2.0, 0, 0}, 2.0), 0.4, 1e-15);     // outside
  EXPECT_NEAR(surface.distance({0, 2.0, 0}, 2.0), std::hypot(0.6, 2.0) - 1.0, 1e-15);
  const auto points = surface.sample(20000);
  double right = 0.0;
  for (const UnionPoint& p : points) {
    EXPECT_NEAR(std::abs(surface.distance(p.point, 1.0)), 0.0, 1e-14);
    right += p.ball;
  }
  EXPECT_NEAR(right / static_cast<double>(points.size()), 0.5, 0.01);
}

TEST(UnionSurface, InsideDistancesAgainstDenseSamples) {
  Random random(11, 0);
  for (int trial = 0; trial < 5; ++trial) {
    Shape balls;
    for (int b = 0; b < 12; ++b) {
      balls.centers.push_back(0.8 * random.in_ball());
      balls.radii.push_back(random.uniform(0.3, 0.7));
    }
    const UnionSurface surface(balls);
    const auto points = surface.sample(40000);
    int deep = 0;
    for (int k = 0; k < 300; ++k) {
      const Vec3 x = random.in_ball();
      double nearest = HUGE_VAL, covered = HUGE_VAL;
      for (const UnionPoint& p : points) nearest = std::min(nearest, (p.point - x).norm());
      for (std::size_t b = 0; b < balls.radii.size(); ++b)
        covered = std::min(covered, (x - balls.centers[b]).norm() - balls.radii[b]);
      const double d = surface.distance(x, nearest);
      EXPECT_EQ(d < 0.0, covered < 0.0);
      EXPECT_LE(std::abs(d), nearest + 1e-12);
      EXPECT_GT(std::abs(d), nearest - 0.03);  // spacing of the samples
      deep += d < covered - 1e-9;              // the nearest point lies on a circle or corner
    }
    EXPECT_GT(deep, 20);
  }
}

TEST(FitError, OneBallInACube) {
  // The inscribed ball of a cube of edge 2: distances of the cube's surface are sqrt(1 + u^2 + v^2) - 1,
  // those of the ball's 1 - max |x_i|.
  TriangleMesh mesh = models::cube();
  for (Vec3& x : mesh.vertices) x *= 2.0;
  const SolidMesh solid = make_solid(mesh);
  const FitError error =
      measure_fit({"", "", {Vec3::Zero()}, {1.0}}, solid, SignedDistance(solid), mass_of(solid.surface));
  double from_mesh = 0.0, from_ball = 0.0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = (i + 0.5) / n, v = (j + 0.5) / n, l = std::sqrt(1 + u * u + v * v);
      from_mesh += (l - 1.0) * (l - 1.0) / (n * n);
      from_ball +=
          (1.0 - 1.0 / l) * (1.0 - 1.0 / l) / (l * l * l) / (n * n) / (kPi / 6.0);  // of its solid angle
    }
  EXPECT_NEAR(error.rms_from_mesh, std::sqrt(from_mesh), 2e-3);
  EXPECT_NEAR(error.rms_from_spheres, std::sqrt(from_ball), 2e-3);
  EXPECT_NEAR(error.rms, std::sqrt(0.5 * (from_mesh + from_ball)), 2e-3);
  EXPECT_NEAR(error.greatest_from_mesh, std::sqrt(3.0) - 1.0, 1e-12);
  EXPECT_NEAR(error.greatest_from_spheres, 1.0 - 1.0 / std::sqrt(3.0), 0.01);
  EXPECT_NEAR(error.volume, kPi / 6.0 - 1.0, 1e-12);
  EXPECT_NEAR(error.centroid, 0.0, 1e-12);
  EXPECT_NEAR(error.inertia, 0.4, 1e-12);  // 2/5 against 2/3 of an edge of 2
}

TEST(FitError, AgreesWithBruteForceOnAFit) {
  const SolidMesh solid = make_solid(models::boulder(2));
  const Shape shape = fit_spheres(solid, {.spheres = 12});
  // The mesh in the shape's frame.
  SolidMesh scaled = solid;
  for (Vec3& x : scaled.surface.vertices) x = (x - shape.source->origin) / shape.source->size;
  const SignedDistance distance(scaled);
  Random random(12, 0);
  std::vector<Vec3> exposed;
  double squares = 0.0, greatest = 0.0, total = 0.0;
  for (std::size_t b = 0; b < shape.radii.size(); ++b)
    for (int k = 0; k < 40000; ++k) {
      const Vec3 x = shape.centers[b] + shape.radii[b] * random.direction();
      bool covered = false;
      for (std::size_t c = 0; c < shape.radii.size(); ++c)
        covered = covered || (c != b && (x - shape.centers[c]).norm() < shape.radii[c]);
      if (covered) continue;
      exposed.push_back(x);
      if (k % 10 != 0) continue;
      const double d = distance(x).distance, area = shape.radii[b] * shape.radii[b];
      squares += area * d * d;
      total += area;
      greatest = std::max(greatest, std::abs(d));
    }
  EXPECT_NEAR(shape.source->error.rms_from_spheres, std::sqrt(squares / total),
              0.02 * std::sqrt(squares / total));
  EXPECT_NEAR(shape.source->error.greatest_from_spheres, greatest, 0.05 * greatest);
  double mesh_squares = 0.0;
  const auto samples = sample_surface(scaled.surface, 600, 77);
  for (const SurfaceSample& s : samples) {
    double nearest = HUGE_VAL;
    for (const Vec3& x : exposed) nearest = std::min(nearest, (x - s.point).squaredNorm());
    mesh_squares += nearest / static_cast<double>(samples.size());
  }
  EXPECT_NEAR(shape.source->error.rms_from_mesh, std::sqrt(mesh_squares), 0.05 * std::sqrt(mesh_squares));
}

TEST(Fit, HalfTheSpheresOfTheGreedyMethodDo) {
  for (const std::uint64_t seed : {2}) {
    const TriangleMesh mesh = models::boulder(seed);
    double last = 1.0;
    for (const std::size_t n : {4, 16}) {
      const double ours = rms(fitted(mesh, n));
      EXPECT_LT(ours, 0.8 * last) << n;
      last = ours;
      EXPECT_LT(ours, rms(fitted(mesh, 2 * n, FitStrategy::greedy))) << n;
    }
  }
}

TEST(Fit, GreedyBallsLieInsideAndTouch) {
  const SolidMesh solid = make_solid(models::boulder(4));
  const Shape shape = fit_spheres(solid, {.spheres = 40, .strategy = FitStrategy::greedy});
  const SignedDistance distance(solid);
  for (std::size_t b = 0; b < shape.radii.size(); ++b) {
    const Vec3 center = shape.source->origin + shape.source->size * shape.centers[b];
    EXPECT_NEAR(distance(center).distance, -shape.source->size * shape.radii[b], 1e-6);
  }
}

TEST(Fit, AnyBudgetHasGravityMassesAndTheMeshsOwnInertia) {
  Random random(13, 0);
  TriangleMesh mesh = models::boulder(5);
  const Quat turn = random.rotation();
  for (Vec3& x : mesh.vertices) x = turn * (7.0 * x) + Vec3(100, -50, 20);
  const MassProperties exact = mass_of(mesh);
  for (const FitStrategy strategy : {FitStrategy::best, FitStrategy::greedy})
    for (const std::size_t n : {1, 2, 3, 5}) {
      SCOPED_TRACE(n);
      const Shape shape = fitted(mesh, n, strategy);
      ASSERT_EQ(shape.radii.size(), n);
      const RigidShape rigid = make_rigid(shape, MassModel::mesh);
      EXPECT_EQ(rigid.mass_model, MassModel::mesh);
      const double size = shape.source->size;
      EXPECT_NEAR(rigid.volume * std::pow(size, 3) / exact.volume, 1.0, 1e-12);
      const Mat3 axes = rigid.axes.toRotationMatrix();
      const Mat3 inertia =
          axes * rigid.inertia.asDiagonal() * axes.transpose() * rigid.volume * std::pow(size, 5);
      EXPECT_NEAR((inertia - exact.inertia).norm() / exact.inertia.norm(), 0.0, 1e-10);
      EXPECT_NEAR((shape.source->origin - exact.centroid).norm(), 0.0, 1e-12);
      double sum = 0.0;
      Vec3 first = Vec3::Zero();
      for (std::size_t b = 0; b < n; ++b) {
        sum += rigid.mass_fractions[b];
        first += rigid.mass_fractions[b] * rigid.offsets[b];
        EXPECT_GT(rigid.mass_fractions[b], 0.0);
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_NEAR(first.norm(), 0.0, 1e-12);
    }
}

TEST(Fit, TheSumOfSpheresOnRequest) {
  const Shape shape = fitted(models::boulder(1), 64, FitStrategy::best, MassModel::spheres);
  EXPECT_LT(shape.source->error.inertia_of_spheres, 0.02);
  const Vec3 moments = make_rigid(shape, MassModel::spheres).inertia;
  const Vec3 exact = make_rigid(shape, MassModel::mesh).inertia;
  EXPECT_LT(((moments - exact).cwiseQuotient(exact)).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Fit, SameBitsForAnyNumberOfThreadsAndSeedsDiffer) {
  const TriangleMesh mesh = models::boulder(3);
  const int threads = omp_get_max_threads();
  std::string texts[3];
  for (int k = 0; k < 3; ++k) {
    omp_set_num_threads(k + 1);
    texts[k] = shape_text(fitted(mesh, 10));
  }
  omp_set_num_threads(threads);
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_EQ(texts[0], texts[2]);
  EXPECT_NE(texts[0], shape_text(fit_spheres(make_solid(mesh), {.spheres = 10, .seed = 2})));
}

TEST(Fit, FewestSpheresForAnError) {
  const SolidMesh solid = make_solid(models::ellipsoid({1.0, 0.8, 0.6}, 6));
  const Shape shape = fit_spheres(solid, {.error = 0.05});
  EXPECT_LE(rms(shape), 0.05);
  EXPECT_GT(rms(fit_spheres(solid, {.spheres = shape.radii.size() - 1})), 0.05);
  EXPECT_THROW(fit_spheres(solid, {}), InputError);
  std::vector<std::size_t> tried;
  double done = 0.0;
  const auto progress = [&](const FitProgress& p) {
    if (tried.empty() || tried.back() != p.spheres) tried.push_back(p.spheres);
    EXPECT_EQ(p.last, tried.size() > 1 ? tried[tried.size() - 2] : 0u);
    EXPECT_EQ(p.last > 0, p.rms > 0.0);
    done = std::max(done, p.done);
  };
  try {  // told long before all 1024
    fit_spheres(make_solid(models::boulder(1)), {.error = 1e-4, .progress = progress});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_TRUE(
        std::string(error.what()).starts_with("an RMS distance of 0.0001 is out of reach of 1024 spheres"))
        << error.what();
  }
  EXPECT_EQ(tried, (std::vector<std::size_t>{1, 2, 4, 8, 16, 32}));
  EXPECT_GT(done, 0.9);
  EXPECT_THROW(fit_spheres(solid, {.spheres = kMostFitSpheres + 1}), InputError);
}

TEST(ShapeFile, AFittedShapeReadsBackTheSame) {
  Shape shape = fitted(models::boulder(2), 5);
  shape.name = "my \"rock\"";
  shape.description = "a \\ b";
  shape.source->file = "../rock.obj";
  shape.source->unit = 1e-3;
  const std::string text = shape_text(shape);
  const Shape read = parse_shape(text, "rock.toml");
  EXPECT_EQ(shape_text(read), text);
  EXPECT_EQ(read.name, shape.name);
  EXPECT_EQ(read.radii, shape.radii);
  EXPECT_EQ(read.centers, shape.centers);
  EXPECT_EQ(read.source->mass.inertia, shape.source->mass.inertia);
  EXPECT_EQ(read.source->error.greatest_from_spheres, shape.source->error.greatest_from_spheres);
  ASSERT_TRUE(read.source->fit);
  EXPECT_EQ(read.source->fit->strategy, FitStrategy::best);
  EXPECT_EQ(read.source->fit->mass, MassModel::mesh);
  EXPECT_EQ(read.source->fit->seed, 1u);
  shape.source->fit.reset();  // as in files of older versions
  EXPECT_FALSE(parse_shape(shape_text(shape), "rock.toml").source->fit);
}

TEST(ShapeFile, TextIsEscaped) {
  const Shape shape{.name = "a\"b\n\\", .description = "", .centers = {Vec3::Zero()}, .radii = {1.0}};
  EXPECT_TRUE(shape_text(shape).starts_with("name = \"a\\\"b\\u000A\\\\\"\n")) << shape_text(shape);
}

TEST(ShapeFile, MistakesInTheMeshTablesAreOneLine) {
  Shape shape = fitted(models::boulder(2), 2);
  shape.name = "rock";
  const std::string text = shape_text(shape);
  const auto complaint = [&](const std::string& from, const std::string& to) -> std::string {
    std::string other = text;
    const std::size_t at = other.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    other.replace(at, from.size(), to);
    try {
      parse_shape(other, "rock.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(complaint("volume = ", "volume = -").find("key 'volume': expected a number from"),
            std::string::npos);
  EXPECT_NE(complaint("inertia = [", "inertia = [9").find("no principal moment above the sum"),
            std::string::npos);
  EXPECT_NE(complaint("unit = ", "units = ").find("did you mean 'unit'?"), std::string::npos);
  EXPECT_NE(complaint("rms = ", "rmss = ").find("key 'rmss': unknown"), std::string::npos);
  EXPECT_NE(complaint("[mesh]", "[mash]").find("key 'mash': unknown, did you mean 'mesh'?"),
            std::string::npos);
  EXPECT_NE(complaint("strategy = \"best", "strategy = \"bes").find("key 'strategy': expected one of 'best'"),
            std::string::npos);
  EXPECT_NE(complaint("seed = 1", "seed = -1").find("key 'seed': expected an integer from 0 on"),
            std::string::npos);
  EXPECT_NE(complaint("origin = [", "origin = [nan, ").find("key 'origin': expected 3 numbers"),
            std::string::npos);
}

TEST(MakeRigid, OneSphereBesideTheMeshsCentroidIsRefused) {
  Shape shape = fitted(models::boulder(2), 1);
  shape.centers[0].x() += 1e-3;
  EXPECT_THROW(make_rigid(shape, MassModel::mesh), InputError);
  EXPECT_EQ(make_rigid(shape, MassModel::spheres).mass_model, MassModel::spheres);
  shape.source.reset();
  EXPECT_EQ(make_rigid(shape, MassModel::mesh).mass_model, MassModel::union_volume);
}

}  // namespace
}  // namespace cairn
