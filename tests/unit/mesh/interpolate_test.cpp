#include "mesh/interpolate.h"

#include "mesh/mesher.h"
#include "support/polygon_shapes.h"

#include <gtest/gtest.h>
#include <random>

namespace patchlight::interpolate_test {
namespace {

// Two bands, each a linear function of position.
Eigen::Array<double, 1, 2> linear(const Point& x) {
  return {1.5 + Vector(0.3, -0.7, 0.2).dot(x), -2 + Vector(1, 0.4, -0.9).dot(x)};
}

Eigen::Array<double, 1, Eigen::Dynamic> interpolated(const PatchMesh& mesh, const Field& vertex_values,
                                                     PatchIndex patch, const Point& point) {
  return interpolate(mesh, vertex_values, patch, interpolation_weights(mesh, patch, point));
}

Field linear_at_vertices(const PatchMesh& mesh) {
  Field values(static_cast<Eigen::Index>(mesh.vertices.size()), 2);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    values.row(static_cast<Eigen::Index>(v)) = linear(mesh.vertices[v]);
  }
  return values;
}

Point mix(const PatchCorners& patch, std::mt19937& random) {
  std::uniform_real_distribution<double> weight(0, 1);
  Point sum = Point::Zero();
  double total = 0;
  for (int k = 0; k < patch.count; ++k) {
    const double w = weight(random);
    sum += w * patch.points[static_cast<std::size_t>(k)];
    total += w;
  }
  return sum / total;
}

TEST(Interpolate, ReproducesLinearFunctions) {
  // Bilinear weights reproduce linear functions in every convex quadrilateral. Their error is rounding over the patch's
  // relative thickness: 1e-15 over 1 / 10, or over the thickness of a sliver.
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    const PatchMesh mesh = tessellate(shape.scene, tiny::both_sides(shape.scene), 0.2);
    const Field values = linear_at_vertices(mesh);
    const double tolerance = 1e-14 / shape.thickness;
    std::mt19937 random(7);
    for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
      const PatchCorners corners = mesh.corner_points(patch);
      for (int k = 0; k < 5; ++k) {
        const Point point = mix(corners, random);
        const Eigen::Array<double, 1, 2> expected = linear(point);
        // A point off the plane counts as its projection.
        const auto value = interpolated(mesh, values, patch, point + 0.01 * mesh.normal[patch]);
        EXPECT_NEAR(value[0], expected[0], tolerance) << shape.name;
        EXPECT_NEAR(value[1], expected[1], tolerance) << shape.name;
      }
    }
  }
}

TEST(Interpolate, TakesTheCornersValueAtACorner) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    const PatchMesh mesh = tessellate(shape.scene, tiny::front_sides(shape.scene), 0.7);
    Field values(static_cast<Eigen::Index>(mesh.vertices.size()), 1);
    for (Eigen::Index v = 0; v < values.rows(); ++v) values(v, 0) = static_cast<double>(v % 7);
    for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
      for (const std::uint32_t vertex : mesh.corners[patch]) {
        const auto value = interpolated(mesh, values, patch, mesh.vertices[vertex]);
        // Rounding of 1e-16 in position over a thickness of at least 1e-6 x 0.3. At a straight corner of a
        // quadrilateral the inverse has a square root: (1e-16)^(1/2).
        EXPECT_NEAR(value[0], values(vertex, 0), 7 * 3e-8) << shape.name;
      }
    }
  }
}

TEST(Interpolate, StaysWithinTheCornersValuesOutside) {
  const Scene trapezoid = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {0.8, 0.9, 0}, {0, 0.9, 0}});
  const PatchMesh mesh = tessellate(trapezoid, tiny::front_sides(trapezoid), 10);
  ASSERT_EQ(mesh.size(), 1u);
  const Field values = linear_at_vertices(mesh);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-5, 5);
  for (int k = 0; k < 1000; ++k) {
    const auto value = interpolated(mesh, values, 0, {anywhere(random), anywhere(random), 0});
    EXPECT_GE(value[0], values.col(0).minCoeff() - 1e-15);
    EXPECT_LE(value[0], values.col(0).maxCoeff() + 1e-15);
  }
}

CornerWeights areas(const PatchMesh& mesh) {
  return Eigen::Map<const Eigen::ArrayXd>(mesh.area.data(), mesh.size()).replicate(1, 4);
}

TEST(VertexMeans, AreExactForConstants) {
  const Scene scene = tiny::in_triangles(tiny::box({4, 3, 2.5}));
  const PatchMesh mesh = tessellate(scene, tiny::both_sides(scene), 0.5);
  const Field constant = Field::Constant(mesh.size(), 3, 0.7);
  // A mean of about ten equal numbers: a few roundings.
  EXPECT_LE((vertex_means(mesh, constant, areas(mesh)) - 0.7).abs().maxCoeff(), 1e-15);
}

TEST(VertexMeans, AreLinearInsideASymmetricGrid) {
  // In a regular grid the four patches around an inner vertex are symmetric about it. So means of a linear function at
  // the centroids are exact there.
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const PatchMesh mesh = tessellate(square, tiny::front_sides(square), 0.1);
  Field values(mesh.size(), 1);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) values(patch, 0) = linear(mesh.centroid[patch])[0];
  const Field means = vertex_means(mesh, values, areas(mesh));
  int inner = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point& x = mesh.vertices[v];
    if (x.x() < 0.01 || x.x() > 0.99 || x.y() < 0.01 || x.y() > 0.99) continue;
    ++inner;
    EXPECT_NEAR(means(static_cast<Eigen::Index>(v), 0), linear(x)[0], 1e-14);
  }
  EXPECT_EQ(inner, 81);
}

TEST(VertexMeans, WeighByArea) {
  const Scene scene =
      tiny::scene_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {4, 0, 0}, {4, 1, 0}}, {{0, 1, 2, 3}, {1, 4, 5, 2}});
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 10);
  Field values(2, 1);
  values << 8, 4;
  const Field means = vertex_means(mesh, values, areas(mesh));
  EXPECT_DOUBLE_EQ(means(mesh.corners[0][0], 0), 8);
  EXPECT_DOUBLE_EQ(means(mesh.corners[0][1], 0), 5);  // (1 m^2 x 8 + 3 m^2 x 4) / 4 m^2
  EXPECT_DOUBLE_EQ(means(mesh.corners[1][1], 0), 4);
}

}  // namespace
}  // namespace patchlight::interpolate_test
