// A pile at rest is stepped without a single allocation.
#include <gtest/gtest.h>
#include <omp.h>

#include "allocations.h"
#include "shape/library.h"
#include "stage.h"

namespace cairn {
namespace {

TEST(Allocation, NoneInTheStepsOfAQuietPile) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // of several, one may meet its largest task late
  for (const char* shape : {"sphere", "tetrahedron"}) {
    Stage stage(R"(
[[body]]
shape = "sphere"
density = 1
[contact]
stiffness = 1e6
[gravity]
method = "tree"
interval = 1000
[[stage]]
name = "rest"
duration = 1e4
)");
    const RigidShape rigid = make_rigid(load_shape(shape, "."), MassModel::union_volume);
    for (int x = 0; x < 6; ++x)
      for (int y = 0; y < 6; ++y)
        for (int z = 0; z < 6; ++z)
          add_body(stage.state.bodies, rigid, 0, 1.0, 2000.0, 0,
                   {.position = 1.9999 * Vec3(x, y, z) * rigid.bounding_radius});
    stage.begin();
    stage.advance(100);
    const long before = g_allocations;
    stage.advance(500);
    EXPECT_EQ(g_allocations - before, 0) << shape;
    EXPECT_TRUE(rigid.radii.size() > 1 || stage.state.contacts.slots() > 0u);
  }
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace cairn
