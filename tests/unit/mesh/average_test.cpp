#include "base/parallel.h"
#include "mesh/interpolate.h"
#include "mesh/mesher.h"
#include "support/polygon_shapes.h"
#include "support/sloped_field.h"

#include <gtest/gtest.h>
#include <random>

namespace patchlight::average_test {
namespace {

Field random_field(const PatchMesh& mesh) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(0, 1);
  Field field(mesh.size(), 2);
  for (Eigen::Index k = 0; k < field.size(); ++k) field.data()[k] = value(random);
  return field;
}

// Integrals over all patches, per column.
Eigen::ArrayXd integral(const PatchMesh& mesh, const Field& field) {
  const Eigen::Map<const Eigen::ArrayXd> area(mesh.area.data(), mesh.size());
  return (field.colwise() * area).colwise().sum().transpose();
}

class AverageInEveryShape : public testing::TestWithParam<tiny::Shape> {};

// Rounding moves a clipped corner by about 1e-16 of the extent, so areas have errors of that over the thickness.
double tolerance(const tiny::Shape& shape) { return 1e-12 + 1e-15 / shape.thickness; }

TEST_P(AverageInEveryShape, OverItselfIsTheIdentity) {
  const Scene& scene = GetParam().scene;
  for (const double max_edge : {10.0, 0.3, 0.05}) {
    const PatchMesh mesh = tessellate(scene, tiny::both_sides(scene), max_edge);
    const Field field = random_field(mesh);
    EXPECT_LT((average_over(mesh, mesh, field) - field).abs().maxCoeff(), tolerance(GetParam()));
  }
}

TEST_P(AverageInEveryShape, KeepsIntegralsAndConstants) {
  const Scene& scene = GetParam().scene;
  const KeptSides sides = tiny::both_sides(scene);
  for (const double edge : {10.0, 0.3, 0.11}) {
    for (const double other_edge : {0.4, 0.07}) {
      const PatchMesh mesh = tessellate(scene, sides, edge);
      const PatchMesh other = tessellate(scene, sides, other_edge);
      const Field field = random_field(other);
      const Eigen::ArrayXd expected = integral(other, field);
      const Eigen::ArrayXd found = integral(mesh, average_over(mesh, other, field));
      EXPECT_LT(((found - expected) / expected).abs().maxCoeff(), tolerance(GetParam()));
      EXPECT_LT((average_over(mesh, other, Field::Ones(other.size(), 1)) - 1).abs().maxCoeff(), 1e-15);
    }
  }
}

TEST_P(AverageInEveryShape, LinearFieldsHaveTheirValuesAtTheCentroids) {
  // The mean of x over a patch is its value at the centroid, from any mesh whose patches fill it. From another mesh
  // there is an error from the parts of patches that protrude, each of which moves x by at most an edge.
  const Scene& scene = GetParam().scene;
  const KeptSides sides = tiny::front_sides(scene);
  const double fine = 0.05;
  const PatchMesh mesh = tessellate(scene, sides, 0.4);
  const PatchMesh other = tessellate(scene, sides, fine);
  Field x(other.size(), 3);
  for (PatchIndex k = 0; k < other.size(); ++k) x.row(k) = other.centroid[k].transpose().array();
  const Field means = average_over(mesh, other, x);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    EXPECT_LT((means.row(i).matrix().transpose() - mesh.centroid[i]).norm(), fine) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Average, AverageInEveryShape, testing::ValuesIn(tiny::polygon_shapes()),
                         [](const auto& instance) { return instance.param.name; });

TEST(Average, IsExactWherePatchesAreHalved) {
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const KeptSides sides = tiny::front_sides(square);
  const PatchMesh mesh = tessellate(square, sides, 0.25);
  const PatchMesh other = tessellate(square, sides, 0.125);
  Field x(other.size(), 1);
  for (PatchIndex k = 0; k < other.size(); ++k) x(k, 0) = 3 + 2 * other.centroid[k].x() - other.centroid[k].y();
  const Field means = average_over(mesh, other, x);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    EXPECT_NEAR(means(i, 0), 3 + 2 * mesh.centroid[i].x() - mesh.centroid[i].y(), 1e-14);
  }
}

TEST(Average, KeepsPolygonsAndSidesApart) {
  const Scene box = tiny::box({2, 1, 1});
  const KeptSides sides = tiny::both_sides(box);
  const PatchMesh mesh = tessellate(box, sides, 0.3);
  const PatchMesh other = tessellate(box, sides, 0.17);
  Field number(other.size(), 1);
  for (PatchIndex k = 0; k < other.size(); ++k) number(k, 0) = 2.0 * other.polygon[k] + (other.side[k] == Side::back);
  const Field means = average_over(mesh, other, number);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    EXPECT_DOUBLE_EQ(means(i, 0), 2.0 * mesh.polygon[i] + (mesh.side[i] == Side::back));
  }
}

// A step from 0 to 1 stays between both: slopes do not overshoot.
TEST_P(AverageInEveryShape, SlopesLeadNowhereBeyondWhatIsAround) {
  const Scene& scene = GetParam().scene;
  const KeptSides sides = tiny::both_sides(scene);
  const PatchMesh mesh = tessellate(scene, sides, 0.05);
  const PatchMesh other = tessellate(scene, sides, 0.17);
  const double middle = (scene.vertices[0].x() + scene.vertices[2].x()) / 2;
  Field step(other.size(), 1);
  for (PatchIndex k = 0; k < other.size(); ++k) step(k, 0) = other.centroid[k].x() < middle ? 0 : 1;
  const Field means = test::average_over(mesh, other, test::with_slopes(other, step));
  EXPECT_GE(means.minCoeff(), -tolerance(GetParam()));
  EXPECT_LE(means.maxCoeff(), 1 + tolerance(GetParam()));
}

TEST(Average, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = tiny::in_triangles(tiny::box({4, 3, 2.5}));
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.4);
  const PatchMesh other = tessellate(scene, tiny::front_sides(scene), 0.23);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return average_over(mesh, other, random_field(other));
  };
  EXPECT_TRUE((with_threads(1) == with_threads(2)).all());
}

}  // namespace
}  // namespace patchlight::average_test
