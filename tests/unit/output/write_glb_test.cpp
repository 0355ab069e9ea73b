#include "glb_parts.h"
#include "output/mesh/write_mesh.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "temporary_folder.h"
#include "tiny_simulation.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>

namespace patchlight::write_glb_test {
namespace {

using Json = nlohmann::json;
using test::Glb;
using test::number_at;
using test::taken_apart;

constexpr double exposure = 0.125;

Glb written(const Scene& scene, const Simulation& simulation) {
  const TemporaryFolder folder;
  const Simulation in = in_scene(simulation, scene);
  write_glb(folder.path() / "result.glb", surface_of(in), {"patchlight solve \xff.obj", exposure});
  return taken_apart(content_of(folder.path() / "result.glb"));
}

std::size_t view_offset(const Glb& glb, const char* which) {
  const Json& primitive = glb.json["meshes"][0]["primitives"][0];
  const Json& accessor = std::string(which) == "indices" ? primitive["indices"] : primitive["attributes"][which];
  const Json& view = glb.json["bufferViews"][glb.json["accessors"][accessor.get<int>()]["bufferView"].get<int>()];
  const std::size_t offset = view["byteOffset"];
  EXPECT_LE(offset + view["byteLength"].get<std::size_t>(), glb.binary.size());
  EXPECT_EQ(offset % 4, 0U);
  return offset;
}

// The displayed position of a vertex: the node's translation plus the position.
Point shown(const Glb& glb, std::size_t vertex) {
  Point point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t offset = view_offset(glb, "POSITION") + 12 * vertex + 4 * axis;
    point[static_cast<Eigen::Index>(axis)] = glb.json["nodes"][0]["translation"][axis].get<double>() +
                                             static_cast<double>(number_at<float>(glb.binary, offset));
  }
  return point;
}

TEST(WriteGlb, IsUnlitOneSidedGltf) {
  const Glb glb = written(tiny_scene(), tiny_simulation());
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_EQ(glb.json["asset"]["extras"]["exposure"], exposure);
  EXPECT_EQ(glb.json["extensionsUsed"], Json::array({"KHR_materials_unlit"}));
  EXPECT_TRUE(glb.json["materials"][0]["extensions"].contains("KHR_materials_unlit"));
  EXPECT_EQ(glb.json["materials"][0]["doubleSided"], false);
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.binary.size());
  EXPECT_EQ(glb.json["scenes"][glb.json["scene"].get<int>()]["nodes"], Json::array({0}));
}

TEST(WriteGlb, KeepsTheRulesOfTheFormat) { test::expect_valid(written(tiny_scene(), tiny_simulation())); }

// The model's up axis becomes y. A rotation keeps lengths and the winding.
TEST(WriteGlb, TurnsTheUprightAxisToY) {
  Scene scene = tiny_scene();
  const Simulation simulation = tiny_simulation();
  const Glb from_z = written(scene, simulation);
  scene.up = Vector::UnitY();
  const Glb from_y = written(scene, simulation);
  for (std::size_t k = 0; k < 5; ++k) {
    const Point& point = simulation.mesh.vertices[k];
    EXPECT_EQ(shown(from_y, k), point);  // halves and whole numbers are exact in float
    EXPECT_EQ(shown(from_z, k), Point(point.x(), point.z(), -point.y()));
  }
}

// Far from the origin floats would be 6 cm apart. Relative to the center nothing is lost.
TEST(WriteGlb, KeepsItsShapeFarFromTheOrigin) {
  Scene scene = tiny_scene();
  Simulation simulation = tiny_simulation();
  const Vector shift(1e6, -1e6, 1e6);
  for (Point& vertex : scene.vertices) vertex += shift;
  for (Point& vertex : simulation.mesh.vertices) vertex += shift;
  const Glb glb = written(scene, simulation);
  EXPECT_EQ(shown(glb, 4) - shown(glb, 0), Vector(0.5, 2, -0.5));
}

TEST(WriteGlb, TrianglesKeepTheFrontOfTheirPatches) {
  const Simulation simulation = tiny_simulation();
  const Glb glb = written(tiny_scene(), simulation);
  const std::size_t first = view_offset(glb, "indices");
  const std::vector<std::size_t> patch_of = {0, 0, 1, 2};  // the quadrilateral gives two triangles
  ASSERT_EQ(glb.json["accessors"][2]["count"], 3 * patch_of.size());
  std::vector<double> area(3, 0);
  for (std::size_t t = 0; t < patch_of.size(); ++t) {
    std::array<Point, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = number_at<std::uint32_t>(glb.binary, first + 4 * (3 * t + k));
      ASSERT_LT(vertex, 5U);
      corners[k] = simulation.mesh.vertices[vertex];
    }
    const Vector normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]) / 2;
    area[patch_of[t]] += normal.dot(simulation.mesh.normal[patch_of[t]]);
  }
  for (std::size_t patch = 0; patch < 3; ++patch) EXPECT_NEAR(area[patch], simulation.mesh.area[patch], 1e-15);
}

// A viewer encodes the linear COLOR_0 as sRGB, which must give the tone-mapped bytes.
TEST(WriteGlb, ColoursAreLinearAndComeBackAsTheBytesOfTheToneMap) {
  const Simulation simulation = tiny_simulation();
  const Glb glb = written(tiny_scene(), simulation);
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;
  const auto expected =
      tone_map(smooth(simulation.mesh, radiance, simulation.problem.area, Occluder(tiny_scene())).at_vertices, exposure,
               usual_bands(3));
  EXPECT_EQ(glb.json["accessors"][1]["normalized"], true);
  const std::size_t first = view_offset(glb, "COLOR_0");
  for (std::size_t k = 0; k < 5; ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double linear = number_at<std::uint16_t>(glb.binary, first + 8 * k + 2 * c) / 65535.0;
      const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
      EXPECT_EQ(std::lround(255 * encoded), expected[k][c]);
    }
    EXPECT_EQ(number_at<std::uint16_t>(glb.binary, first + 8 * k + 6), 65535);
  }
}

// The specification requires the exact bounds of the floats.
TEST(WriteGlb, BoundsAreExact) {
  const Glb glb = written(tiny_scene(), tiny_simulation());
  const std::size_t first = view_offset(glb, "POSITION");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float lowest = 1e9F, highest = -1e9F;
    for (std::size_t k = 0; k < 5; ++k) {
      const auto value = number_at<float>(glb.binary, first + 12 * k + 4 * axis);
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    EXPECT_EQ(glb.json["accessors"][0]["min"][axis].get<float>(), lowest);
    EXPECT_EQ(glb.json["accessors"][0]["max"][axis].get<float>(), highest);
  }
}

}  // namespace
}  // namespace patchlight::write_glb_test
