// Walls with openings, read from several formats.
#include "input/building/cut_openings.h"
#include "model_files.h"

#include <algorithm>
#include <random>

namespace patchlight::openings_test {
namespace {

using Ring = std::vector<Point>;

// Vertical, in the plane y = 0.
Ring rectangle(double x, double z, double width, double height) {
  return {{x, 0, z}, {x + width, 0, z}, {x + width, 0, z + height}, {x, 0, z + height}};
}

double area_of(const std::vector<Ring>& parts) {
  double sum = 0;
  for (const Ring& part : parts) sum += area_vector(part).norm();
  return sum;
}

double area_of(const Scene& scene, const std::string& object) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (scene.groups.at(scene.polygons[p].group) == object) sum += area_vector(corner_points(scene, p)).norm();
  return sum;
}

// A wall of cells of 10 cm with windows that do not overlap. They may touch each other and the edge.
struct RandomWall {
  int width = 0, height = 0;
  std::vector<std::array<int, 4>> windows = {};  // left, bottom, width, height
  std::vector<bool> is_open = {};

  explicit RandomWall(unsigned seed) {
    std::mt19937 random(seed);
    const auto from_to = [&](int low, int high) { return low + static_cast<int>(random() % (high - low + 1U)); };
    width = from_to(20, 80);
    height = from_to(20, 40);
    is_open.assign(static_cast<std::size_t>(width * height), false);
    const int count = from_to(1, 12);
    for (int k = 0; k < count; ++k) {
      const int w = from_to(1, width / 3), h = from_to(1, height / 2);
      add({from_to(0, width - w), from_to(0, height - h), w, h});
    }
  }

  std::size_t cell(int x, int z) const { return static_cast<std::size_t>(x * height + z); }

  void add(const std::array<int, 4>& window) {
    const auto [left, bottom, w, h] = window;
    for (int x = left; x < left + w; ++x)
      for (int z = bottom; z < bottom + h; ++z)
        if (is_open[cell(x, z)]) return;
    for (int x = left; x < left + w; ++x)
      for (int z = bottom; z < bottom + h; ++z) is_open[cell(x, z)] = true;
    windows.push_back(window);
  }

  Ring outline() const { return rectangle(0, 0, width / 10.0, height / 10.0); }
  Ring window(std::size_t k) const {
    return rectangle(windows[k][0] / 10.0, windows[k][1] / 10.0, windows[k][2] / 10.0, windows[k][3] / 10.0);
  }
  double area() const { return 0.01 * static_cast<double>(std::count(is_open.begin(), is_open.end(), false)); }
};

std::string json_of(const Ring& ring) {
  std::string text;
  for (const Point& point : ring)
    text += (text.empty() ? "[" : ",[") + std::to_string(point.x()) + "," + std::to_string(point.y()) + "," +
            std::to_string(point.z()) + "]";
  return "[" + text + "]";
}

std::string honeybee_of(const RandomWall& wall) {
  const std::string more = R"(, "boundary_condition": {"type": "Outdoors"})";
  std::string windows;
  for (std::size_t k = 0; k < wall.windows.size(); ++k)
    windows += (k > 0 ? "," : "") + (R"({"type": "Aperture", "identifier": "w)" + std::to_string(k)) +
               R"(", "geometry": {"boundary": )" + json_of(wall.window(k)) + "}" + more + "}";
  return R"({"type": "Model", "units": "Meters", "orphaned_faces": [{"type": "Face", "identifier": "wall",
    "face_type": "Wall", "geometry": {"boundary": )" +
         json_of(wall.outline()) + R"(}, "apertures": [)" + windows + "]" + more + "}]}";
}

std::string loop_of(const Ring& ring) {
  std::string text;
  for (const Point& point : ring) {
    text += "<CartesianPoint>";
    for (const double value : point) text += "<Coordinate>" + std::to_string(value) + "</Coordinate>";
    text += "</CartesianPoint>";
  }
  return "<PlanarGeometry><PolyLoop>" + text + "</PolyLoop></PlanarGeometry>";
}

std::string gbxml_of(const RandomWall& wall) {
  std::string windows;
  for (std::size_t k = 0; k < wall.windows.size(); ++k)
    windows += "<Opening openingType=\"FixedWindow\" id=\"w" + std::to_string(k) + "\">" + loop_of(wall.window(k)) +
               "</Opening>";
  return "<gbXML lengthUnit=\"Meters\"><Campus id=\"c\"><Surface surfaceType=\"ExteriorWall\" id=\"wall\">" +
         loop_of(wall.outline()) + windows + "</Surface></Campus></gbXML>";
}

// The closed cells, one by one.
std::string obj_of(const RandomWall& wall) {
  std::string text = "o wall\n";
  for (int x = 0; x < wall.width; ++x) {
    for (int z = 0; z < wall.height; ++z) {
      if (wall.is_open[wall.cell(x, z)]) continue;
      for (const Point& point : rectangle(x / 10.0, z / 10.0, 0.1, 0.1))
        text += "v " + std::to_string(point.x()) + " 0 " + std::to_string(point.z()) + "\n";
      text += "f -4 -3 -2 -1\n";
    }
  }
  return text;
}

class Openings : public ModelFiles {};

TEST_F(Openings, WallsHaveOneAreaInAllFormats) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    const RandomWall wall(seed);
    for (const auto& [name, text] : {std::pair("wall.hbjson", honeybee_of(wall)), std::pair("wall.xml", gbxml_of(wall)),
                                     std::pair("wall.obj", obj_of(wall))}) {
      const Scene scene = read_scene(write(name, text));
      EXPECT_NEAR(area_of(scene, "wall") / wall.area(), 1, 1e-6) << name << " of seed " << seed;
      for (std::size_t k = 0; k < wall.windows.size() && name != std::string("wall.obj"); ++k)
        EXPECT_NEAR(area_of(scene, "w" + std::to_string(k)) / area_of({wall.window(k)}), 1, 1e-6) << name;
    }
  }
}

// 50 x 30 windows, each with a smaller one inside.
TEST(WithoutOpenings, TakesManyAndNestedOpenings) {
  std::vector<Ring> openings;
  for (int x = 0; x < 50; ++x) {
    for (int z = 0; z < 30; ++z) {
      openings.push_back(rectangle(x + 0.1, z + 0.1, 0.6, 0.6));
      openings.push_back(rectangle(x + 0.2, z + 0.2, 0.2, 0.2));
    }
  }
  const CutOutline cut = without_openings(rectangle(0, 0, 50, 30), openings, 1e-3);
  EXPECT_TRUE(cut.is_cut);
  EXPECT_NEAR(area_of(cut.parts) / (1500 * (1 - 0.36)), 1, 1e-6);
  EXPECT_LT(cut.parts.size(), 400U);
}

// 2,000 windows along the lower edge of a wall. Without cuts one part would have 8,004 corners.
TEST(WithoutOpenings, BoundsTheCornersOfParts) {
  constexpr int count = 2000;
  std::vector<Ring> openings;
  for (int x = 0; x < count; ++x) openings.push_back(rectangle(x + 0.2, 0, 0.6, 1));
  const CutOutline cut = without_openings(rectangle(0, 0, count, 3), openings, 1e-3);
  EXPECT_NEAR(area_of(cut.parts) / (count * (3 - 0.6)), 1, 1e-6);
  // A part has at most 64 openings with four corners each, plus its own corners. There are at most two parts per 64
  // openings.
  for (const Ring& part : cut.parts) EXPECT_LE(part.size(), 4 * 64 + 4U);
  EXPECT_LE(cut.parts.size(), 2 * count / 64 + 1U);
}

// The plane is oblique: rounding separates touching edges by 1e-16 m.
TEST(WithoutOpenings, TakesTouchingOpeningsInAnyPlane) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()).toRotationMatrix();
  const auto turned = [&](Ring ring) {
    for (Point& point : ring) point = turn * point + Point(31, -7, 5);
    return ring;
  };
  std::vector<Ring> openings;
  for (int k = 0; k < 5; ++k) openings.push_back(turned(rectangle(1 + 0.3 * k, 1, 0.3, 0.1 + 0.2 * k)));
  openings.push_back(turned(rectangle(0, 2.5, 4, 0.5)));  // at three edges
  const CutOutline cut = without_openings(turned(rectangle(0, 0, 4, 3)), openings, 1e-3);
  EXPECT_EQ(cut.beyond, 0U);
  EXPECT_NEAR(area_of(cut.parts) / (12 - 2 - 0.3 * 2.5), 1, 1e-6);
  for (const Ring& part : cut.parts) EXPECT_GT(area_vector(part).dot(area_vector(turned(rectangle(0, 0, 1, 1)))), 0);
}

TEST(WithoutOpenings, CutsWithinTheOutlineOnly) {
  const CutOutline cut = without_openings(rectangle(0, 0, 4, 3), {rectangle(3, 1, 2, 1)}, 1e-3);
  EXPECT_EQ(cut.beyond, 1U);
  EXPECT_NEAR(area_of(cut.parts), 11, 1e-9);
}

const Diagnostic* loss(const Scene& scene, const std::string& name) {
  for (const Diagnostic& problem : scene.diagnostics)
    if (problem.code == DiagnosticCode::left_out && problem.text.find(name) != std::string::npos) return &problem;
  return nullptr;
}

// A model of honeybee with a floor and more keys.
std::string with_floor(const std::string& more) {
  return R"({"type": "Model", "orphaned_faces": [{"identifier": "floor", "face_type": "Floor", "geometry":
    {"boundary": [[0,0,0],[4,0,0],[4,3,0],[0,3,0]]}, "boundary_condition": {"type": "Ground"}}])" +
         more + "}";
}

TEST_F(Openings, AShadeMeshIsTheShadeOfItsOutline) {
  const Scene mesh = read_scene(write(
      "mesh.hbjson", with_floor(R"(, "shade_meshes": [{"type": "ShadeMesh", "identifier": "m", "geometry": {"type":
        "Mesh3D", "vertices": [[0,-1,0],[4,-1,0],[4,-1,3],[0,-1,3]], "faces": [[0,1,2],[0,2,3]]}}])")));
  const Scene shade = read_scene(write(
      "shade.hbjson", with_floor(R"(, "orphaned_shades": [{"type": "Shade", "identifier": "m", "geometry": {"type":
        "Face3D", "boundary": [[0,-1,0],[4,-1,0],[4,-1,3],[0,-1,3]]}}])")));
  ASSERT_EQ(mesh.polygons.size(), 2U);
  ASSERT_EQ(shade.polygons.size(), 2U);
  EXPECT_NEAR(area_of(mesh, "m"), 12, 1e-12);
  EXPECT_NEAR(area_of(shade, "m"), 12, 1e-12);
  const auto reflectance = [](const Scene& scene) {
    return scene.materials.at(scene.polygons[1].material).reflectance[0];
  };
  EXPECT_EQ(reflectance(mesh), reflectance(shade));
}

TEST_F(Openings, ShadesOfOrphanedOpeningsAreRead) {
  const Scene scene = read_scene(
      write("shade.hbjson",
            with_floor(R"(, "orphaned_apertures": [{"type": "Aperture", "identifier": "pane", "geometry": {"boundary":
        [[0,-1,0],[4,-1,0],[4,-1,3]]}, "outdoor_shades": [{"type": "Shade", "identifier": "awning", "geometry":
        {"boundary": [[0,-2,3],[4,-2,3],[4,-1,3],[0,-1,3]]}}]}])")));
  EXPECT_NEAR(area_of(scene, "awning"), 4, 1e-12);
}

TEST_F(Openings, LossesAreNamed) {
  const Scene lists = read_scene(write(
      "lists.hbjson", with_floor(R"(, "fixtures": [{"identifier": "lamp 7"}], "orphaned_shades": [{"identifier": "line",
        "geometry": {"boundary": [[0,0,1],[1,0,1]]}}, {"identifier": "ball", "geometry": {"radius": 1}}])")));
  for (const char* const name : {"'fixtures' of models", "lamp 7", "(line)", "(ball)"})
    EXPECT_TRUE(loss(lists, name)) << name;
  EXPECT_FALSE(loss(read_scene(write("whole.hbjson", with_floor(""))), ""));
  const Scene surfaces = read_scene(write("house.xml",
                                          "<gbXML><Campus id=\"c\"><Surface surfaceType=\"Roof\" id=\"roof\"/><Surface "
                                          "surfaceType=\"ExteriorWall\" id=\"wall\">" +
                                              loop_of(rectangle(0, 0, 4, 3)) + "</Surface></Campus></gbXML>"));
  EXPECT_TRUE(loss(surfaces, "(roof)"));
}

TEST_F(Openings, MeshesThatNameNoVertexAreRefused) {
  const auto file =
      write("mesh.hbjson", with_floor(R"(, "shade_meshes": [{"identifier": "m", "geometry": {"vertices": [[0,0,1],
        [1,0,1],[0,1,1]], "faces": [[0,1,3]]}}])"));
  for (const char* words : {"mesh.hbjson: m: ", "vertex 3", "0 to 2"})
    EXPECT_NE(refusal(file).find(words), std::string::npos) << words;
}

// A quad of 0.5 m in glTF.
std::string quad(bool double_sided) {
  return std::string(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "materials": [{"emissiveFactor": [1, 1, 1], "doubleSided": )") +
         (double_sided ? "true" : "false") +
         R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,)"
         R"(AACAvgAAAAAAAIC+AACAPgAAAAAAAIC+AACAPgAAAAAAAIA+AACAvgAAAAAAAIA+AAABAAIAAAACAAMA"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-0.25, 0, -0.25],
    "max": [0.25, 0, 0.25]}, {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]})";
}

TEST_F(Openings, DoubleSidedEmittersShineOnBothSides) {
  for (const bool double_sided : {false, true}) {
    const Scene scene = read_scene(write("quad.gltf", quad(double_sided)));
    ASSERT_FALSE(scene.polygons.empty());
    EXPECT_TRUE(emits(scene, 0, Side::front));
    EXPECT_EQ(emits(scene, 0, Side::back), double_sided);
  }
}

TEST_F(Openings, SpotsOfMitsubaAreLuminaires) {
  const auto scene = [&](const std::string& numbers) {
    return write("spot.xml", "<scene version=\"3.0.0\">\n<shape type=\"rectangle\"/><emitter type=\"spot\">" + numbers +
                                 "<transform name=\"to_world\"><lookat origin=\"1 2 3\" target=\"1 2 0\" up=\"0 1 "
                                 "0\"/></transform></emitter></scene>");
  };
  const Scene read =
      read_scene(scene("<rgb name=\"intensity\" value=\"5\"/><float name=\"cutoff_angle\" value=\"40\"/>"));
  ASSERT_EQ(read.luminaires.size(), 1U);
  EXPECT_LT((read.luminaires[0].position - Point(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((read.luminaires[0].aim + Vector::UnitZ()).norm(), 1e-12);
  const auto& spot = std::get<SpotLight>(read.luminaires[0].light);
  EXPECT_EQ(spot.intensity[0], 5);
  EXPECT_NEAR(spot.beam_half_angle, 35, 1e-12);  // half way from 30 to 40 degrees
  EXPECT_NEAR(spot.field_half_angle, 39, 1e-12);
  EXPECT_NE(refusal(scene("<float name=\"cutoff_angle\" value=\"100\"/>")).find("spot.xml:2: "), std::string::npos);
}

}  // namespace
}  // namespace patchlight::openings_test
