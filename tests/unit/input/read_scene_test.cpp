#include "patchlight/input/read_scene.h"

#include "patchlight/base/error.h"

#include "model_files.h"
#include "support/diagnostics_of.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace patchlight::read_scene_test {
namespace {

using ReadScene = ModelFiles;

constexpr const char* materials =
    "newmtl white\nKd 0.75 0.5 0.25\n"
    "newmtl light\nKd 0 0 0\nKe 17 12 4\n";

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::map<std::string, double> area_per_material(const Scene& scene) {
  std::map<std::string, double> area;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    area[scene.materials[scene.polygons[p].material].name] += area_vector(corner_points(scene, p)).norm();
  }
  return area;
}

TEST_F(ReadScene, KdIsReflectanceAndExitanceIsPiTimesKe) {
  write("m.mtl", materials);
  const Scene scene =
      read_scene(write("m.obj", "mtllib m.mtl\n" + square + "usemtl white\nf 1 2 3\nusemtl light\nf 1 3 4\n"));
  ASSERT_EQ(scene.polygons.size(), 2U);
  const Material& white = scene.materials[scene.polygons[0].material];
  const Material& light = scene.materials[scene.polygons[1].material];
  EXPECT_EQ(white.name, "white");
  EXPECT_EQ(light.name, "light");
  EXPECT_TRUE((white.reflectance == rgb(0.75, 0.5, 0.25)).all());
  EXPECT_TRUE((white.exitance == 0).all());
  EXPECT_TRUE((light.exitance == std::numbers::pi * rgb(17, 12, 4)).all());
  EXPECT_FALSE(is_lamp(scene, 0));
  EXPECT_TRUE(is_lamp(scene, 1));
}

TEST_F(ReadScene, LengthsScaleWithTheUnitAndAreasWithItsSquare) {
  write("m.mtl", materials);
  const auto file = write("m.obj", "mtllib m.mtl\n" + square + "usemtl white\nf 1 2 3 4\n");
  // A power of two, so that every product is exact.
  const Scene metres = read_scene(file);
  const Scene eighths = read_scene(file, {.metres_per_unit = 0.125, .settings = {}});
  for (std::size_t v = 0; v < metres.vertices.size(); ++v) {
    EXPECT_EQ(eighths.vertices[v], 0.125 * metres.vertices[v]);
  }
  EXPECT_EQ(area_vector(corner_points(eighths, 0)).norm(), area_vector(corner_points(metres, 0)).norm() / 64);
  EXPECT_EQ(eighths.metres_per_unit, 0.125);
  EXPECT_TRUE((eighths.materials[0].reflectance == metres.materials[0].reflectance).all());
}

TEST_F(ReadScene, CoordinatesAreTheNearestDoubles) {
  const Scene scene =
      read_scene(write("m.obj", "v 0.1 +2.5e-1 500000.123456789\nv .3 1. 1E2\nv -0.7 0.2 0\nf 1 2 3\n"));
  EXPECT_EQ(scene.vertices[0], Point(0.1, 0.25, 500000.123456789));
  EXPECT_EQ(scene.vertices[1], Point(0.3, 1, 100));
  EXPECT_EQ(scene.vertices[2], Point(-0.7, 0.2, 0));
}

TEST_F(ReadScene, AreasPerMaterialDoNotDependOnTheValence) {
  write("m.mtl", materials);
  // A concave, L-shaped hexagon and a square, once whole and once in triangles, with every form of index.
  const std::string vertices =
      "mtllib m.mtl\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nvt 0 0\nvn 0 0 1\n"
      "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\n";
  const Scene whole =
      read_scene(write("whole.obj", vertices + "usemtl white\nf 1 2 3 4 5 6\nusemtl light\nf 7 8 9 10\n"));
  const Scene triangles = read_scene(write(
      "triangles.obj", vertices + "usemtl white\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\nf 1/1/1 4/1/1 6/1/1\nf -7 -6 -5\n"
                                  "usemtl light\nf 7 8 10\nf 8 9 10\n"));
  ASSERT_EQ(whole.polygons.size(), 2U);
  EXPECT_EQ(whole.polygons[0].corners.size(), 6U);
  EXPECT_EQ(triangles.polygons.size(), 2U);
  const auto expected = std::map<std::string, double>{{"white", 3.0}, {"light", 1.5}};
  EXPECT_EQ(area_per_material(whole), expected);
  EXPECT_EQ(area_per_material(triangles), expected);
}

TEST_F(ReadScene, EveryPolygonKnowsItsLineMaterialAndGroup) {
  write("m.mtl", materials);
  // One face per material and group, in interleaved order. Comments and continued lines shift the line numbers.
  const Scene scene = read_scene(write("m.obj",
                                       "# 1\nmtllib m.mtl\n" + square +          // 1 to 6
                                           "g a\nusemtl white\nf 1 2 3\n"        // face on line 9
                                           "usemtl light\nf 1 3 4 # diagonal\n"  // 11
                                           "g b\nf 1 2 \\\n 3 4\n"               // 13
                                           "usemtl white\n\nf 2 3 4\n"           // 17
                                           "g a\n\tf\t1 2 4\n"));                // 19
  ASSERT_EQ(scene.polygons.size(), 5U);
  const std::vector<std::uint32_t> lines = {9, 11, 13, 17, 19};
  const std::vector<std::string> names = {"white", "light", "light", "white", "white"};
  const std::vector<std::string> groups = {"a", "a", "b", "b", "a"};
  const std::vector<std::size_t> corners = {3, 3, 4, 3, 3};
  for (std::size_t p = 0; p < 5; ++p) {
    EXPECT_EQ(scene.polygons[p].line, lines[p]);
    EXPECT_EQ(scene.materials[scene.polygons[p].material].name, names[p]);
    EXPECT_EQ(scene.groups[scene.polygons[p].group], groups[p]);
    EXPECT_EQ(scene.polygons[p].corners.size(), corners[p]);
  }
  EXPECT_EQ(scene.polygons[4].corners, (std::vector<std::uint32_t>{0, 1, 3}));
}

TEST_F(ReadScene, LineEndsDoNotMatter) {
  write("m.mtl", materials);
  const std::string unix_text = "mtllib m.mtl\n" + square + "usemtl light\nf 1 2 \\\n3 4\n";
  std::string dos_text;
  for (const char c : unix_text) dos_text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  std::string mac_text = unix_text;
  std::replace(mac_text.begin(), mac_text.end(), '\n', '\r');
  for (const std::string& text : {unix_text, dos_text, mac_text, "\xEF\xBB\xBF" + unix_text}) {
    const Scene scene = read_scene(write("m.obj", text));
    ASSERT_EQ(scene.polygons.size(), 1U);
    EXPECT_EQ(scene.polygons[0].line, 7U);
    EXPECT_EQ(scene.polygons[0].corners, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(scene.materials[0].name, "light");
    EXPECT_EQ(scene.vertices[2], Point(1, 1, 0));
  }
}

TEST_F(ReadScene, MaterialsComeFromAllLibrariesAndMayHaveSpaces) {
  write("one.mtl", "newmtl  dark red \nKd 0.5 0 0\n");
  write("two two.mtl", "newmtl light\nKd 0 0 0\nKe 1 1 1\n");
  write("three.mtl", "newmtl light\nKd 1 1 1\nnewmtl blue\nKd 0 0 0.5\n");
  const Scene scene =
      read_scene(write("m.obj", "mtllib two two.mtl\nmtllib one.mtl three.mtl\n" + square +
                                    "usemtl dark red\nf 1 2 3\nusemtl light\nf 1 3 4\nusemtl blue\nf 1 2 4\n"));
  ASSERT_EQ(scene.materials.size(), 3U);
  EXPECT_EQ(scene.materials[0].name, "light");
  EXPECT_GT(scene.materials[0].exitance[0], 0) << "of two definitions the first counts";
  EXPECT_EQ(scene.materials[1].name, "dark red");
  EXPECT_EQ(scene.materials[2].name, "blue");
}

TEST_F(ReadScene, UnusedMaterialsAreLeftOut) {
  write("m.mtl", std::string(materials) + "newmtl broken\nKd 7 7 7\n");
  const Scene scene = read_scene(write("m.obj", "mtllib m.mtl\n" + square + "usemtl light\nf 1 2 3 4\n"));
  ASSERT_EQ(scene.materials.size(), 1U);
  EXPECT_EQ(scene.materials[0].name, "light");
}

TEST_F(ReadScene, FacesWithoutMaterialGetADefaultAndANote) {
  const Scene scene = read_scene(write("m.obj", square + "f 1 2 3 4\n"));
  ASSERT_EQ(scene.materials.size(), 1U);
  EXPECT_EQ(scene.materials[0].name, "default");
  EXPECT_TRUE((scene.materials[0].reflectance == rgb(0.5, 0.5, 0.5)).all());
  EXPECT_TRUE((scene.materials[0].exitance == 0).all());
  EXPECT_EQ(number_of(scene, DiagnosticCode::no_material), 1U);
}

// The mean of the texture in linear light, times Kd unless that is 0 or missing. Files that are no pictures are
// ignored.
TEST_F(ReadScene, PicturesOfMapKdCountByTheirMean) {
  std::filesystem::create_directories(folder_ / "maps");
  write("maps/paint.png", two_pixels());
  write("bad.png", two_pixels().substr(0, 40));
  write("m.mtl",
        "newmtl half\nKd .5 .5 .5\nmap_Kd maps\\paint.png\nnewmtl zero\nKd 0 0 0\nmap_Kd maps/paint.png\nnewmtl "
        "bare\nmap_Kd maps/paint.png\nnewmtl bad\nKd .4 .4 .4\nmap_Kd bad.png\n");
  std::string text = "mtllib m.mtl\n" + square;
  for (const char* const name : {"half", "zero", "bare", "bad"}) text += std::string("usemtl ") + name + "\nf 1 2 3\n";
  const Scene scene = read_scene(write("m.obj", text));
  const double blue = std::pow((128 / 255. + .055) / 1.055, 2.4) / 2;
  ASSERT_EQ(scene.materials.size(), 4U);
  EXPECT_LT((scene.materials[0].reflectance - rgb(.25, 0, blue / 2)).abs().maxCoeff(), 1e-12);
  EXPECT_LT((scene.materials[1].reflectance - rgb(.5, 0, blue)).abs().maxCoeff(), 1e-12);
  EXPECT_LT((scene.materials[2].reflectance - rgb(.5, 0, blue)).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(scene.materials[3].reflectance[0], .4);
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_picture, {": 3 ", "m.obj:"}));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"bad.png", "'bad'", "map_Kd", "line 11"}));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"Kd", ": bad"}));
}

TEST_F(ReadScene, NamesWhatItIgnores) {
  write("m.mtl",
        "newmtl plain\nKd .5 .5 .5\nKs 0 0 0\nd 1\nillum 2\n"
        "newmtl glossy\nKd .5 .5 .5\nKs .1 .1 .1\n"
        "newmtl painted\nKd .5 .5 .5\nmap_Kd wood.png\n"
        "newmtl leaves\nKd .5 .5 .5\nmap_d leaves.png\n"
        "newmtl mirror\nKd .5 .5 .5\nillum 3\n"
        "newmtl bare\nKa 2 2 2\n");
  std::string text = "mtllib m.mtl\n" + square + "v 0 0 1 1 0 0\nl 1 2\nl 2 3\np 4\n";
  for (const char* name : {"plain", "glossy", "painted", "leaves", "mirror", "bare"}) {
    text += std::string("usemtl ") + name + "\nf 1 2 3\n";
  }
  const Scene scene = read_scene(write("m.obj", text));
  for (const std::vector<std::string>& words : {std::vector<std::string>{"Ks", ": glossy"},
                                                {"Kd", ": painted, leaves"},
                                                {"map_d", ": leaves"},
                                                {"illum", ": mirror"}}) {
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, words)) << words[0];
  }
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material, {"Kd", ": bare"}));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"colors", ": 1"}));
  EXPECT_EQ(number_of(scene, DiagnosticCode::little_left_out), 3U) << "two lines, one point";
  for (const Diagnostic& found : scene.diagnostics) EXPECT_EQ(found.text.find("plain"), std::string::npos);
  ASSERT_EQ(scene.unsimulated.size(), 2U);
  EXPECT_EQ(scene.unsimulated[0].property, UnsimulatedProperty::mirror);
  EXPECT_EQ(scene.unsimulated[0].materials, 2U) << "glossy, mirror";
  EXPECT_EQ(scene.unsimulated[1].property, UnsimulatedProperty::glass);
  EXPECT_EQ(scene.unsimulated[1].materials, 1U) << "leaves";
  ASSERT_EQ(scene.lamp_hints.size(), 1U) << "a Ka above 1 may be meant as a lamp's Ke";
  EXPECT_EQ(scene.lamp_hints[0].material, "bare");
  EXPECT_TRUE((scene.lamp_hints[0].radiance == 2).all());

  // The Ka of a material with a Ke gives no note.
  write("m.mtl", "newmtl bare\nKd 0 0 0\nKa 2 2 2\nKe 1 1 1\n");
  const Scene lit = read_scene(write("m.obj", "mtllib m.mtl\n" + square + "usemtl bare\nf 1 2 3\n"));
  EXPECT_TRUE(test::notes_of(lit).empty());
  EXPECT_TRUE(lit.lamp_hints.empty());
}

TEST_F(ReadScene, SettingsChangeMaterials) {
  write("m.mtl", std::string(materials) + "newmtl broken\nKd 7 7 7\n");
  const auto file = write(
      "m.obj", "mtllib m.mtl\n" + square + "usemtl white\nf 1 2 3\nusemtl light\nf 1 3 4\nusemtl broken\nf 1 2 4\n");
  const auto settings = [](const std::vector<std::string>& texts) {
    ReadOptions options;
    for (const std::string& text : texts) options.settings.push_back(parse_material_setting(text));
    return options;
  };
  const Scene scene = read_scene(file, settings({"white.exitance=1,2,3", "light.radiance=2", "broken.reflectance=0.5",
                                                 "broken.reflectance=0.25"}));
  EXPECT_TRUE((scene.materials[0].exitance == rgb(1, 2, 3)).all());
  EXPECT_TRUE((scene.materials[0].reflectance == rgb(0.75, 0.5, 0.25)).all()) << "the rest stays";
  EXPECT_TRUE((scene.materials[1].exitance == std::numbers::pi * rgb(2, 2, 2)).all());
  EXPECT_TRUE((scene.materials[2].reflectance == rgb(0.25, 0.25, 0.25)).all()) << "the last one wins, before the check";

  const std::string message = refusal(file, settings({"wall.exitance=1"}));
  EXPECT_EQ(message.rfind("read.settings: ", 0), 0U) << message;
  EXPECT_TRUE(contains(message, "'wall'")) << message;
  EXPECT_TRUE(contains(message, "white, light, broken")) << message;
}

TEST_F(ReadScene, TheChecksumCoversTheModelAndItsMaterials) {
  const std::string text = "mtllib m.mtl\n" + square + "usemtl light\nf 1 2 3 4\n";
  write("m.mtl", materials);
  const std::string first = read_scene(write("m.obj", text)).sha256;
  EXPECT_EQ(first.size(), 64U);
  EXPECT_EQ(read_scene(write("copy.obj", text)).sha256, first);
  EXPECT_NE(read_scene(write("m.obj", text + "#\n")).sha256, first);
  write("m.mtl", std::string(materials) + "#\n");
  EXPECT_NE(read_scene(write("m.obj", text)).sha256, first);
}

TEST_F(ReadScene, TakesNameUnitAndUpFromTheCaller) {
  const auto file = write("m.OBJ", square + "f 1 2 3 4\n");
  const Scene scene = read_scene(file, {.up = Vector::UnitY(), .settings = {}});
  EXPECT_EQ(scene.file, file.string());
  EXPECT_EQ(scene.up, Vector(Vector::UnitY()));
}

TEST_F(ReadScene, RefusesUnusableFilesNamingThem) {
  for (const auto& [file, part] : std::vector<std::pair<std::filesystem::path, std::string>>{
           {folder_ / "missing.obj", "does not exist"},
           {folder_, "folder"},
           {write("empty.obj", ""), "empty"},
           {write("comment.obj", "# nothing\n"), "no faces"},
           {write("lines.obj", square + "l 1 2\nl 2 3\n"), "lines (l), left out: 2"},
           {write("m.md", "solid"), "'.md' is not known; expected one of .obj, .ply"},
           {write("plain", "solid"), "expected one of .obj"},
           {"/dev/null", "extension"}}) {
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string() + ": ", 0), 0U) << message;
    EXPECT_TRUE(contains(message, part)) << message;
  }
}

TEST_F(ReadScene, RefusesBadStatementsNamingTheLine) {
  write("m.mtl", materials);
  const std::string head = "mtllib m.mtl\n" + square + "usemtl white\n";  // lines 1 to 6
  std::string many_corners = "f 1";
  for (int k = 0; k < 2500; ++k) many_corners += " 1 2 3 4";
  for (const auto& [statement, part] :
       std::vector<std::pair<std::string, std::string>>{{"v 0 0 nan", "'nan'"},
                                                        {"v inf 0 0", "'inf'"},
                                                        {"v 0 1e999 0", "'1e999'"},
                                                        {"v 0 0,5 0", "'0,5'"},
                                                        {"v 0 0 1x", "'1x'"},
                                                        {"v 0 0", "2 coordinates"},
                                                        {"v", "0 coordinates"},
                                                        {"f 1 2 0", "'0'"},
                                                        {"f 1 2 x", "'x'"},
                                                        {"f 1 2 3.5", "'3.5'"},
                                                        {"f 1 2 99999999999999999999", "'99999999999999999999'"},
                                                        {"f 1 2 5", "vertex 5"},
                                                        {"f 1 2 -5", "'-5'"},
                                                        {many_corners, "10001 corners"}}) {
    const auto file = write("m.obj", head + statement + "\nf 1 2 3 4\n");
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string() + ":7: ", 0), 0U) << message;
    EXPECT_TRUE(contains(message, part)) << message;
  }
}

const Diagnostic* find(const Scene& scene, DiagnosticCode code) {
  for (const Diagnostic& problem : scene.diagnostics) {
    if (problem.code == code) return &problem;
  }
  return nullptr;
}

TEST_F(ReadScene, FindsALibraryBesideTheModelWhereverItsPathLeads) {
  write("Room.MTL", materials);
  const std::string rest = "\n" + square + "usemtl light\nf 1 2 3 4\n";
  for (const char* name : {"scenes/Room.MTL", "/no/such/folder/Room.MTL", "..\\scenes\\Room.MTL",
                           "C:\\My Models\\Room.MTL", "room.mtl", "maps/room.mtl"}) {
    const Scene scene = read_scene(write("m.obj", std::string("mtllib ") + name + rest));
    EXPECT_TRUE(is_lamp(scene, 0)) << name;
    const Diagnostic* problem = find(scene, DiagnosticCode::moved_material_file);
    ASSERT_NE(problem, nullptr) << name;
    EXPECT_TRUE(contains(problem->text, "m.obj:1")) << problem->text;
    EXPECT_TRUE(contains(problem->text, name)) << problem->text;
  }
  std::filesystem::create_directory(folder_ / "sub");
  write("sub/b.mtl", materials);
  for (const char* name : {"sub/b.mtl", "sub\\b.mtl", "./sub/b.mtl"}) {
    const Scene scene = read_scene(write("m.obj", std::string("mtllib ") + name + rest));
    EXPECT_TRUE(is_lamp(scene, 0)) << name;
    EXPECT_TRUE(test::problems_of(scene).empty()) << name;
  }
}

TEST_F(ReadScene, UndefinedMaterialsAreGreyKeepTheirNamesAndAreReported) {
  const Scene scene =
      read_scene(write("m.obj", "mtllib gone.mtl\n" + square + "usemtl brick\nf 1 2 3\nusemtl\nf 1 3 4\n"),
                 {.settings = {parse_material_setting("brick.exitance=1")}});
  ASSERT_EQ(scene.materials.size(), 2U);
  EXPECT_EQ(scene.materials[0].name, "brick");
  EXPECT_TRUE((scene.materials[0].reflectance == 0.5).all());
  EXPECT_TRUE((scene.materials[0].exitance == 1).all()) << "--set knows the name";
  EXPECT_EQ(scene.materials[1].name, "default") << "usemtl without a name";
  ASSERT_EQ(test::problems_of(scene).size(), 3U);
  EXPECT_EQ(scene.diagnostics[0].code, DiagnosticCode::missing_material_file);
  EXPECT_TRUE(contains(scene.diagnostics[0].text, "gone.mtl"));
  EXPECT_EQ(scene.diagnostics[1].code, DiagnosticCode::unknown_material);
  EXPECT_TRUE(contains(scene.diagnostics[1].text, "'brick' (" + scene.file + ":6)")) << scene.diagnostics[1].text;
  EXPECT_EQ(scene.diagnostics[2].code, DiagnosticCode::no_material);
}

TEST_F(ReadScene, AMaterialThatNoFaceUsesNeedNotBeDefined) {
  const Scene scene = read_scene(write("m.obj", square + "usemtl\nf 1 2 3 4\nusemtl brick\n"));
  EXPECT_EQ(find(scene, DiagnosticCode::unknown_material), nullptr);
}

TEST_F(ReadScene, AFaceMayHaveMoreCornersThanAByteCounts) {
  // A regular polygon of n corners on the unit circle: its area is n/2 sin(2 pi / n).
  for (const int n : {255, 256, 257, 2000}) {
    std::string text = square + "f 1 2 3 4\n";
    std::string positive = "f";
    std::string negative = "f";
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      text += "v " + std::to_string(std::cos(angle)) + ' ' + std::to_string(std::sin(angle)) + " 2\n";
      positive += ' ' + std::to_string(5 + k) + "//1";
      negative += ' ' + std::to_string(k - n);
    }
    for (const std::string& face : {positive, negative}) {
      const Scene scene = read_scene(write("m.obj", text + face + "\nf 1 2 3\n"));
      ASSERT_EQ(scene.polygons.size(), 3U);
      EXPECT_EQ(scene.polygons[1].corners.size(), static_cast<std::size_t>(n));
      EXPECT_EQ(scene.polygons[2].corners.size(), 3U);
      // std::to_string prints six digits, and each corner affects at most 2 pi / n of the area.
      EXPECT_NEAR(front_normal(scene, 1).z(), 1, 1e-6);
      EXPECT_NEAR(area_vector(corner_points(scene, 1)).norm(), n / 2.0 * std::sin(2 * std::numbers::pi / n), 1e-5);
    }
  }
}

TEST_F(ReadScene, ShortFacesAreLeftOutAndCounted) {
  const Scene scene = read_scene(write("m.obj", square + "f 1 2\nf 1 2 3 4\nf 3\nf\n"));
  ASSERT_EQ(scene.polygons.size(), 1U);
  EXPECT_EQ(scene.polygons[0].line, 6U);
  const Diagnostic* problem = find(scene, DiagnosticCode::little_left_out);
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->count, 3U);
  EXPECT_EQ(problem->faces.at(1).line, 7U);
  EXPECT_TRUE(contains(refusal(write("m.obj", square + "f 1 2\n")), "m.obj:5"));
}

// Exporters write the same room in many ways.
TEST_F(ReadScene, TabsNamesInAnyAlphabetAndSpacesDoNotMatter) {
  write("b\xC3\xBCro.mtl", "newmtl wei\xC3\x9F\n\tKd\t0.75 0.5\t0.25 \n");
  const Scene scene = read_scene(write("b\xC3\xBCro raum.obj",
                                       "mtllib\tb\xC3\xBCro.mtl \r\nv\t0 0\t0\nv  1 0 0 \n v 1 1 0\n\tv 0 1 0\n"
                                       "g\tW\xC3\xA4nde\nusemtl\twei\xC3\x9F\t\nf\t1\t2  3 4 \n"));
  EXPECT_EQ(scene.materials.at(0).name, "wei\xC3\x9F");
  EXPECT_EQ(scene.materials[0].reflectance[0], 0.75);
  EXPECT_EQ(scene.groups.at(scene.polygons.at(0).group), "W\xC3\xA4nde");
  EXPECT_TRUE(test::problems_of(scene).empty());
}

TEST_F(ReadScene, AFaceMayStandAboveItsVertices) {
  const Scene scene = read_scene(write("m.obj", "f 1 2 3 4\n" + square));
  EXPECT_EQ(area_vector(corner_points(scene, 0)), Vector(0, 0, 1));
}

TEST_F(ReadScene, RefusesBadMaterialsNamingFileAndLine) {
  const auto obj = write("m.obj", "mtllib m.mtl\n" + square + "usemtl a\nf 1 2 3 4\n");
  for (const char* statement : {"Kd nan 0 0", "Kd 0.5", "Ke 1 1 x", "Ke inf 1 1", "Kd spectral red.rfl"}) {
    const auto mtl = write("m.mtl", std::string("newmtl a\n") + statement + "\n");
    const std::string message = refusal(obj);
    EXPECT_EQ(message.rfind(mtl.string() + ":2: ", 0), 0U) << message;
    EXPECT_TRUE(contains(message, statement)) << message;
  }
  for (const char* statement : {"Kd 1.01 0 0", "Kd 0 -0.01 0", "Ke 0 0 -1"}) {
    write("m.mtl", std::string("newmtl a\n") + statement + "\n");
    const std::string message = refusal(obj);
    EXPECT_EQ(message.rfind(obj.string() + ": material 'a'", 0), 0U) << message;
  }
  write("m.mtl", "");
  EXPECT_TRUE(contains(refusal(obj), "m.mtl is empty"));
}

}  // namespace
}  // namespace patchlight::read_scene_test
