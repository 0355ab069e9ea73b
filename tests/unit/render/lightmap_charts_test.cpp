#include "patchlight/base/error.h"
#include "patchlight/simulate.h"

#include "render/lightmap.h"
#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::lightmap_charts_test {
namespace {

using namespace test;

PatchMesh mesh_of(const Scene& scene) {
  Request request;
  request.mesh.max_edge = 0.5;
  return simulate(scene, request).mesh;
}

// A room of 4 x 3 x 2.5 m whose walls are two triangles each.
Scene room_of_triangles() {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10)});
  for (const Quad& q : box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true)) {
    scene = with_polygon(std::move(scene), {q[0], q[1], q[2]}, 0);
    scene = with_polygon(std::move(scene), {q[0], q[2], q[3]}, 0);
  }
  return with_quad(std::move(scene), {Point(1, 1, 2), Point(1, 2, 2), Point(2, 2, 2), Point(2, 1, 2)}, 1);
}

TEST(LightmapCharts, WallsOfTrianglesAreOneChartEach) {
  const Scene scene = room_of_triangles();
  const PatchMesh mesh = mesh_of(scene);
  const auto charts = charts_of(scene, mesh);
  ASSERT_EQ(charts.size(), 8U);  // six walls, the lamp and its back
  std::size_t patches = 0;
  for (const LightmapChart& chart : charts) {
    patches += chart.patches.size();
    // The extent is that of the wall, not of its diagonal.
    double area = 0;
    for (const PatchIndex patch : chart.patches) area += mesh.area[patch];
    EXPECT_NEAR(chart.extent[0] * chart.extent[1], area, 1e-9);
    // From the front, right and down are the same as on paper.
    EXPECT_NEAR(chart.right.cross(chart.down).dot(mesh.normal[chart.patches.front()]), -1, 1e-12);
  }
  EXPECT_EQ(patches, mesh.size());
}

TEST(LightmapCharts, MaterialsAndSidesAreApart) {
  Scene scene = empty_scene({grey(0.5, 1), grey(0.4)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)}, 0);
  scene = with_quad(std::move(scene), {Point(1, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0)}, 1);
  // Beside it, but upside down.
  scene = with_quad(std::move(scene), {Point(2, 0, 0), Point(2, 1, 0), Point(3, 1, 0), Point(3, 0, 0)}, 1);
  Request request;
  request.mesh.sides = Sides::front;
  request.mesh.max_edge = 1;
  EXPECT_EQ(charts_of(scene, simulate(scene, request).mesh).size(), 3U);
}

// Texels of charts and their padding belong to one chart, and all lie in the map.
TEST(LightmapCharts, LieApartInTheMap) {
  const Scene scene = room_of_triangles();
  const auto charts = charts_of(scene, mesh_of(scene));
  for (const std::optional<double> texel : {std::optional<double>(), std::optional<double>(0.1)}) {
    const PackedCharts packed = packed_charts(charts, texel);
    std::vector<int> owners(static_cast<std::size_t>(packed.width * packed.height));
    for (const LightmapChart& chart : packed.charts) {
      EXPECT_LE(std::max(chart.texel[0], chart.texel[1]), packed.texel * (1 + 1e-5));
      EXPECT_NEAR(chart.width * chart.texel[0], chart.extent[0], 1e-12);
      EXPECT_NEAR(chart.height * chart.texel[1], chart.extent[1], 1e-12);
      for (int y = chart.top - lightmap_padding; y < chart.top + chart.height + lightmap_padding; ++y) {
        for (int x = chart.left - lightmap_padding; x < chart.left + chart.width + lightmap_padding; ++x) {
          ASSERT_TRUE(x >= 0 && y >= 0 && x < packed.width && y < packed.height);
          EXPECT_EQ(owners[static_cast<std::size_t>(y * packed.width + x)]++, 0);
        }
      }
    }
    if (texel)
      EXPECT_EQ(packed.texel, *texel);
    else
      EXPECT_EQ(std::max(packed.width, packed.height), 256);
  }
}

TEST(LightmapCharts, ALargerMapThanTheLargestHasLargerTexels) {
  const Scene scene = room_of_triangles();
  const PackedCharts packed = packed_charts(charts_of(scene, mesh_of(scene)), 1e-5);
  EXPECT_EQ(packed.width, most_lightmap_edge);
  EXPECT_GT(packed.texel, 1e-5);
}

TEST(LightmapCharts, MoreChartsThanAMapHoldsAreRefused) {
  LightmapChart chart;
  chart.extent = {1, 1};
  // A cell of 5 x 5 texels each.
  const std::vector<LightmapChart> charts(std::size_t{820} * 820, chart);
  EXPECT_THROW(packed_charts(charts, std::nullopt), InputError);
}

// A linear function on a chart is interpolated exactly at its edge, and up to one texel beyond.
TEST(LightmapPadding, GoesOnLinearly) {
  Lightmap map;
  map.width = map.height = 12;
  map.patch.assign(144, no_patch);
  map.direct = map.indirect = map.radiance = TexelField::Zero(144, 1);
  const auto value = [](int x, int y) { return static_cast<float>(100 + 2 * x - 3 * y); };
  for (int y = 3; y < 9; ++y) {
    for (int x = 4; x < 8; ++x) {
      map.patch[static_cast<std::size_t>(12 * y + x)] = 0;
      map.direct(12 * y + x, 0) = value(x, y);
    }
  }
  const Lightmap padded = with_padding(map, lightmap_padding);
  for (int y = 2; y < 10; ++y) {
    for (int x = 3; x < 9; ++x) EXPECT_FLOAT_EQ(padded.direct(12 * y + x, 0), value(x, y)) << x << ' ' << y;
  }
  EXPECT_GT(padded.direct(12 * 5 + 2, 0), 0);  // two texels from the chart
  EXPECT_EQ(padded.direct(12 * 5 + 1, 0), 0);  // three
  EXPECT_EQ(padded.patch[12 * 2 + 3], no_patch);
}

// Two charts are so close that the padding of one ends at that of the other. Nothing is mixed.
TEST(LightmapPadding, IsOfOneChart) {
  Lightmap map;
  map.width = 8;
  map.height = 1;
  map.patch = {0, 0, no_patch, no_patch, no_patch, no_patch, 1, 1};
  map.direct = TexelField::Zero(8, 1);
  map.direct << 5, 5, 0, 0, 0, 0, 9, 9;
  map.indirect = map.radiance = map.direct;
  const Lightmap padded = with_padding(map, 2);
  TexelField expected(8, 1);
  expected << 5, 5, 5, 5, 9, 9, 9, 9;
  EXPECT_TRUE((padded.direct == expected).all());
}

}  // namespace
}  // namespace patchlight::lightmap_charts_test
