// Omitted contents of model files, counted by kind and weighted by area.
#include "input/left_out.h"

#include "model_files.h"
#include "scene/repair.h"

#include <cmath>

namespace patchlight::left_out_test {
namespace {

class Losses : public ModelFiles {};

constexpr auto little = DiagnosticCode::little_left_out;
constexpr auto much = DiagnosticCode::left_out;

std::vector<Point> square_of(double area) {
  const double side = std::sqrt(area);
  return {Point(0, 0, 0), Point(side, 0, 0), Point(side, side, 0), Point(0, side, 0)};
}

// A square of 1 m^2 that is the object "wall".
Scene wall() {
  Scene scene;
  scene.file = "wall.obj";
  scene.materials.emplace_back();
  scene.groups = {"wall"};
  scene.vertices = square_of(1);
  scene.polygons.push_back({.corners = {0, 1, 2, 3}});
  return scene;
}

// 1 % of the area of the model, which includes the wall and the omitted faces.
TEST_F(Losses, FacesOfMoreThanOnePercentOfTheAreaMakeResultsWrong) {
  const double limit = 0.01 / 0.99;
  for (const auto& [area, kind] : {std::pair(0.98 * limit, little), {1.02 * limit, much}}) {
    LeftOut left_out;
    left_out.lose_face("bad", "wall", {.corners = square_of(area / 2)});
    left_out.lose_face("worse", "wall", {.corners = square_of(area / 2)});
    const Scene scene = repair(left_out.on(wall()));
    EXPECT_EQ(number_of(scene, kind), 2U) << area;
    EXPECT_EQ(scene.diagnostics.size(), 2U);
    EXPECT_NEAR(scene.diagnostics.at(0).area, area / 2, 1e-12);
    EXPECT_EQ(chosen(scene.diagnostics, makes_results_wrong).size(), kind == much ? 2U : 0U);
    EXPECT_EQ(remarks_of(scene).size(), kind == much ? 0U : 2U);
  }
}

TEST_F(Losses, WholeObjectsAndLightSourcesMakeResultsWrong) {
  LeftOut left_out;
  left_out.lose_face("bad", "wall");
  left_out.lose_face("bad", "gone");
  left_out.lose("dark", "lamp");
  left_out.lose_without_area("thin", "curve", 3);
  left_out.add("remark", "wall");
  const Scene scene = left_out.on(wall());
  EXPECT_EQ(number_of(scene, little), 4U);
  EXPECT_EQ(number_of(scene, much), 2U);
  EXPECT_EQ(number_of(scene, DiagnosticCode::simplified_part), 1U);
}

// Each format has two valid faces and one with two corners, in one object.
TEST_F(Losses, FacesOfTwoCornersAreCounted) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nelement edge 2\nproperty int vertex1\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n2 0 1\n3 0 2 3\n0\n1\n";
  const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const std::string end = "endloop\nendfacet\n";
  for (const auto& [file, lost] : std::vector<std::pair<std::filesystem::path, std::size_t>>{
           {write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a\nf 1 2 3\nf 1 2\nf 1 3 4\n"), 1},
           {write("a.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n2 0 1\n3 0 2 3\n"), 1},
           {write("a.ply", ply), 3},
           {write("a.stl", "solid a\n" + facet + "vertex 1 1 0\n" + end + facet + end + facet + "vertex 0 1 0\n" + end),
            1}}) {
    const Scene scene = read_scene(file, {.keep_faces = true});
    EXPECT_EQ(scene.polygons.size(), 2U) << file;
    EXPECT_EQ(number_of(scene, little), lost) << file;
    EXPECT_EQ(number_of(scene, much), 0U) << file;
  }
}

TEST_F(Losses, ObjectsWithoutASoundFaceAreWholeObjects) {
  const Scene scene =
      read_scene(write("a.obj",
                       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\no a\nf 1 2 3\no flat\nf 1 2 4\no short\nf 1 2\n"
                       "o patch\nsurf 0 1 0 1 1 2 3\n"));
  EXPECT_EQ(scene.polygons.size(), 1U);
  EXPECT_EQ(number_of(scene, much), 3U) << "flat, short and patch";
}

TEST_F(Losses, LightsLinesAndSplinesOfColladaAreCounted) {
  const std::string points =
      "<source id=\"p\"><float_array id=\"pa\" count=\"9\">0 0 0 1 0 0 1 1 0</float_array><technique_common><accessor "
      "source=\"#pa\" stride=\"3\" count=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
      "type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices "
      "id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>";
  const std::string corners = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
  const Scene scene = read_scene(
      write("a.dae",
            "<COLLADA version=\"1.4.1\"><library_lights><light id=\"bulb\"><technique_common><point><color>1 1 "
            "1</color></point></technique_common></light></library_lights><library_geometries><geometry "
            "id=\"g\"><mesh>" +
                points + "<triangles count=\"1\">" + corners + "<p>0 1 2</p></triangles><lines count=\"1\">" + corners +
                "<p>0 1</p></lines></mesh></geometry><geometry id=\"c\"><spline/></geometry><geometry "
                "id=\"hull\"><convex_mesh/></geometry><geometry "
                "id=\"unused\"><convex_mesh/></geometry></library_geometries><library_visual_scenes><visual_scene "
                "id=\"s\"><node name=\"plate\"><instance_geometry url=\"#g\"/><instance_geometry "
                "url=\"#c\"/><instance_geometry url=\"#hull\"/></node><node name=\"lamp\"><instance_light "
                "url=\"#bulb\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene "
                "url=\"#s\"/></scene></COLLADA>"));
  EXPECT_EQ(scene.polygons.size(), 1U);
  EXPECT_EQ(number_of(scene, little), 2U) << "a line and a spline";
  EXPECT_EQ(number_of(scene, much), 2U) << "a light and a convex mesh";
}

// Both files have a sun, but a scene has only one.
TEST_F(Losses, TheSunOfASecondFileIsALoss) {
  const std::string sky = "void light sun_color\n0\n0\n3 1 1 1\nsun_color source sun\n0\n0\n4 0 0 1 0.5\n";
  const std::string plate = "void plastic grey\n0\n0\n5 .5 .5 .5 0 0\ngrey polygon p\n0\n0\n9 0 0 0 1 0 0 1 1 0\n";
  const std::vector<std::filesystem::path> files = {write("a.rad", sky + plate), write("b.rad", sky + plate)};
  EXPECT_EQ(number_of(read_scene(files), much), 1U);
}

}  // namespace
}  // namespace patchlight::left_out_test
