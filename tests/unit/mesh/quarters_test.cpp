#include "base/sampling.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "support/polygon_shapes.h"

#include <gtest/gtest.h>

namespace patchlight::quarters_test {
namespace {

// refine() cuts triangles and quadrilaterals into these. The points in each quarter identify it.
TEST(Quarters, AreThoseOfRefine) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    if (shape.thickness < 1) continue;
    const PatchMesh whole = tessellate(shape.scene, tiny::both_sides(shape.scene), 0.7);
    const PatchMesh parts = refine(whole);
    for (PatchIndex part = 0; part < parts.size(); ++part) {
      const PatchCorners patch = whole.corner_points(part / 4);
      const PatchCorners quarter = quarter_of(patch, static_cast<int>(part % 4));
      const PatchCorners expected = parts.corner_points(part);
      ASSERT_EQ(quarter.count, expected.count) << shape.name;
      for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((quarter.points[k] - expected.points[k]).norm(), 1e-14);
      for (const auto& sample : scrambled_sobol(16, part)) {
        const Point inside = square_to_quad(quarter.points, sample[0], sample[1]);
        EXPECT_EQ(quarter_at(patch, whole.normal[part / 4], inside), static_cast<int>(part % 4)) << shape.name;
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::quarters_test
