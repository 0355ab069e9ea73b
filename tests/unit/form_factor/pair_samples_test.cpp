#include "form_factor/pair_samples.h"

#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::pair_samples_test {
namespace {

using namespace test;

PatchShape shape_of_polygon(const std::vector<Point>& corners) {
  PatchMesh mesh;
  mesh.vertices = corners;
  mesh.corners = {{0, 1, 2, static_cast<std::uint32_t>(corners.size() - 1)}};
  mesh.centroid = {area_centroid(corners)};
  mesh.normal = {area_vector(corners).normalized()};
  mesh.area = {area_vector(corners).norm()};
  return patch_shapes(mesh)[0];
}

struct PairCase {
  std::string name;
  PatchShape from, to;
};

void PrintTo(const PairCase& pair, std::ostream* out) { *out << pair.name; }

std::vector<PairCase> pair_cases() {
  const PatchShape square = shape_of_polygon({Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  const PatchShape kite = shape_of_polygon({Point(0, 1, 4), Point(0.7, 0.8, 4), Point(1, 0, 4), Point(0, 0, 4)});
  const PatchShape triangle = shape_of_polygon({Point(3, 0, 1), Point(3, 0, 2), Point(3, 1, 1)});
  return {{"square_kite", square, kite},
          {"kite_square", kite, square},
          {"square_triangle", square, triangle},
          {"triangle_kite", triangle, kite}};
}

class PairSampling : public testing::TestWithParam<PairCase> {};

// The mean weight times the areas is the exchange area. For smooth integrands the error of n Owen-scrambled Sobol
// points is much smaller than n^-1/2. 4096 samples of a weight that varies by a fifth reach 1e-3 with margin.
TEST_P(PairSampling, MeanIsTheExchangeArea) {
  const TracingFrame frame{Point(1, 1, 1), 0.2};
  const SampledPatch from = sampled_patch(GetParam().from, 0, frame);
  const SampledPatch to = sampled_patch(GetParam().to, 1, frame);
  const SampleTable table(4096, 1);
  PairSamples samples;
  double sum = 0;
  for (std::uint32_t k = 0; k < 4096; k += 16) {
    for (const int half : {0, 8}) {
      add_samples(samples, half, 8, from, to, table.of_pair(3, 4), k + static_cast<std::uint32_t>(half), frame.scale);
    }
    for (const float weight : samples.weight) sum += weight;
  }
  const double expected = unoccluded_exchange_area(GetParam().from, GetParam().to);
  EXPECT_NEAR(sum / 4096 * GetParam().from.area * GetParam().to.area, expected, 1e-3 * expected);
}

TEST_P(PairSampling, EndsLieOnThePatches) {
  const TracingFrame frame{Point(1, 1, 1), 0.2};
  const auto inside = [&](const PatchShape& shape, double x, double y, double z) {
    const Point point = Point(x, y, z) / frame.scale + frame.centre;
    bool result = std::abs(shape.normal.dot(point - shape.centroid)) < 1e-6;
    for (int k = 0; k < shape.corners.count; ++k) {
      const Point& a = shape.corners.points[static_cast<std::size_t>(k)];
      const Point& b = shape.corners.points[static_cast<std::size_t>((k + 1) % shape.corners.count)];
      result = result && shape.normal.dot((b - a).cross(point - a)) > -1e-6;
    }
    return result;
  };
  const SampleTable table(64, 1);
  PairSamples samples;
  for (std::uint32_t k = 0; k < 64; k += 16) {
    add_samples(samples, 0, 16, sampled_patch(GetParam().from, 5, frame), sampled_patch(GetParam().to, 7, frame),
                table.of_pair(1, 2), k, frame.scale);
    const ShadowPacket& rays = samples.rays;
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
      ASSERT_TRUE(inside(GetParam().from, rays.from_x[lane], rays.from_y[lane], rays.from_z[lane]));
      ASSERT_TRUE(inside(GetParam().to, rays.from_x[lane] + rays.toward_x[lane],
                         rays.from_y[lane] + rays.toward_y[lane], rays.from_z[lane] + rays.toward_z[lane]));
      ASSERT_EQ(rays.from_polygon[lane], 5U);
      ASSERT_EQ(rays.to_polygon[lane], 7U);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PairSampling, testing::ValuesIn(pair_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace patchlight::pair_samples_test
