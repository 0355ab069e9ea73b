#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "model_files.h"
#include "room_files.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::formats_test {
namespace {

using Formats = ModelFiles;

constexpr const char* grey_surface = R"("pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]})";

class RoomIn : public Formats {
 protected:
  static constexpr double max_edge = 0.57;  // no edge is a multiple of it, so rounding does not change the patches

  // The room in one format, and the lamp in OBJ.
  Scene read(const std::filesystem::path& file) const {
    write("lamp.mtl", test::lamp_mtl);
    const std::vector<std::filesystem::path> files = {file, write("lamp.obj", test::lamp_obj)};
    return read_scene(files);
  }
  Field irradiance(const Scene& scene) const {
    Request request;
    request.mesh.max_edge = max_edge;
    return simulate(scene, request).solution.irradiance;
  }
  // The difference from the room in OBJ, relative to the mean irradiance.
  Field difference(const std::filesystem::path& file) const {
    const Field expected = irradiance(read(write("reference.obj", test::as_obj(test::room()))));
    const Field found = irradiance(read(file));
    EXPECT_EQ(found.rows(), expected.rows());
    if (found.rows() != expected.rows()) return Field::Ones(1, 1);
    return (found - expected).abs() / expected.mean();
  }
  // The same as one number: the area-weighted norm of the difference over that of the irradiance.
  double relative_difference(const std::filesystem::path& file) const {
    Request request;
    request.mesh.max_edge = max_edge;
    const Simulation expected = simulate(read(write("reference.obj", test::as_obj(test::room()))), request);
    const Simulation found = simulate(read(file), request);
    EXPECT_EQ(found.mesh.size(), expected.mesh.size());
    if (found.mesh.size() != expected.mesh.size()) return 1;
    const auto norm = [&](const Field& field) {
      return std::sqrt((field.square().colwise() * expected.problem.area.array()).sum());
    };
    return norm(found.solution.irradiance - expected.solution.irradiance) / norm(expected.solution.irradiance);
  }
};

// Coordinates in single precision have a relative error of 6e-8. Angles, form factors and irradiance change by a small
// multiple of that. One or two of a million shadow rays then pass an edge on the other side. That changes the form
// factor of one of 91,000 pairs by 1/16. Single patches change by up to a few 1e-3, the norm by less than 1e-4.
constexpr double float_tolerance = 1e-4;

// Formats with decimal digits give the same coordinates to the bit.
constexpr double double_tolerance = 1e-6;

TEST_F(RoomIn, PlyHasTheSameIrradiance) {
  EXPECT_LT(difference(write("room.ply", test::as_ply(test::room()))).maxCoeff(), double_tolerance);
}

TEST_F(RoomIn, StlHasTheSameIrradiance) {
  EXPECT_LT(difference(write("room.stl", test::as_stl(test::room()))).maxCoeff(), double_tolerance);
}

TEST_F(RoomIn, OffHasTheSameIrradiance) {
  EXPECT_LT(difference(write("room.off", test::as_off(test::room()))).maxCoeff(), double_tolerance);
}

TEST_F(RoomIn, ColladaHasTheSameIrradiance) {
  EXPECT_LT(relative_difference(write("room.dae", test::as_collada(test::room()))), float_tolerance);
}

TEST_F(RoomIn, IfcHasTheSameIrradiance) {
  EXPECT_LT(relative_difference(write("room.ifc", test::as_ifc(test::room()))), float_tolerance);
}

TEST_F(RoomIn, GltfHasTheSameIrradiance) {
  write("room.bin", test::gltf_buffer(test::room()));
  const std::string json = test::gltf_json(test::room(), R"("uri": "room.bin", )", "", grey_surface);
  EXPECT_LT(relative_difference(write("room.gltf", json)), float_tolerance);
}

TEST_F(RoomIn, GlbHasTheSameIrradiance) {
  EXPECT_LT(relative_difference(write("room.glb", test::as_glb(test::room(), "", grey_surface))), float_tolerance);
}

TEST_F(RoomIn, OneObjWithBothHasTheSameIrradianceAsTwo) {
  write("lamp.mtl", test::lamp_mtl);
  std::string both = test::as_obj(test::room()) + test::lamp_obj;
  const std::size_t face = both.find("f 1 2 3 4");
  both.replace(face, 9, "f -4 -3 -2 -1");
  const Field expected = irradiance(read(write("reference.obj", test::as_obj(test::room()))));
  const Field found = irradiance(read_scene(write("both.obj", both)));
  ASSERT_EQ(found.rows(), expected.rows());
  EXPECT_LT((found - expected).abs().maxCoeff(), 1e-6 * expected.mean());
}

TEST_F(RoomIn, MixedFilesAllTakePart) {
  const Scene scene = read(write("room.ply", test::as_ply(test::room())));
  EXPECT_EQ(scene.polygons.size(), 13U);  // coplanar triangles are one polygon
  EXPECT_EQ(scene.files.size(), 2U);
  EXPECT_EQ(scene.polygons.front().file, 0U);
  EXPECT_EQ(scene.polygons.back().file, 1U);
  EXPECT_EQ(scene.materials.size(), 2U);
  EXPECT_TRUE(is_lamp(scene, 12));
}

TEST_F(Formats, UnitsThatAFileStatesAreMetres) {
  const Box expected(Point(0, 0, 0), Point(3, 2.4, 2.1));
  for (const auto& file : {write("room.dae", test::as_collada(test::room())),  // centimeters
                           write("room.ifc", test::as_ifc(test::room()))}) {   // millimeters
    const Box found = bounds(read_scene(file));
    EXPECT_LT((found.min() - expected.min()).norm(), 1e-6) << file;
    EXPECT_LT((found.max() - expected.max()).norm(), 1e-6) << file;
  }
}

TEST_F(Formats, TheUprightAxisIsThatOfTheFormat) {
  EXPECT_EQ(read_scene(write("room.dae", test::as_collada(test::room()))).up, Vector(0, 0, 1));
  EXPECT_EQ(read_scene(write("room.ifc", test::as_ifc(test::room()))).up, Vector(0, 0, 1));
  const auto glb = write("room.glb", test::as_glb(test::room(), "", grey_surface));
  EXPECT_EQ(read_scene(glb).up, Vector(0, 1, 0));
  EXPECT_EQ(read_scene(glb, {.metres_per_unit = 1, .up = Vector(0, 0, 1), .settings = {}}).up, Vector(0, 0, 1));
}

TEST_F(Formats, ColorsBecomeReflectancesAndNamesGroups) {
  for (const auto& file :
       {write("room.dae", test::as_collada(test::room())), write("room.ifc", test::as_ifc(test::room()))}) {
    const Scene scene = read_scene(file);
    ASSERT_EQ(scene.materials.size(), 1U) << file;
    EXPECT_EQ(scene.materials[0].name, "wall");
    EXPECT_TRUE((scene.materials[0].reflectance == rgb(0.5, 0.5, 0.5)).all()) << scene.materials[0].reflectance;
  }
  const Scene ifc = read_scene(folder_ / "room.ifc");
  EXPECT_TRUE(std::any_of(ifc.groups.begin(), ifc.groups.end(),
                          [](const std::string& name) { return name.find("room") != std::string::npos; }));
}

TEST_F(Formats, WithoutMaterialsAllIsOneGreyThatCanBeSet) {
  for (const auto& file : {write("room.ply", test::as_ply(test::room())), write("room.stl", test::as_stl(test::room())),
                           write("room.off", test::as_off(test::room()))}) {
    ReadOptions options;
    options.settings = {parse_material_setting("default.radiance=2")};
    const Scene scene = read_scene(file, options);
    ASSERT_EQ(scene.materials.size(), 1U);
    EXPECT_TRUE((scene.materials[0].reflectance == rgb(0.5, 0.5, 0.5)).all());
    EXPECT_TRUE((scene.materials[0].exitance == 2 * std::numbers::pi * rgb(1, 1, 1)).all());
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material, {"'default'"}));
  }
}

TEST_F(Formats, BinaryPlyAndStlHaveTheSameGeometryAsText) {
  const test::Triangles room = test::room();
  const Scene expected = read_scene(write("room.ply", test::as_ply(room)));
  for (const auto& file :
       {write("little.ply", test::as_binary_ply(room, false)), write("big.ply", test::as_binary_ply(room, true)),
        write("binary.stl", test::as_binary_stl(room))}) {
    const Scene scene = read_scene(file);
    ASSERT_EQ(scene.polygons.size(), expected.polygons.size()) << file;
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      for (std::size_t k = 0; k < 3; ++k) {
        // STL holds floats: 2^-24 of at most 3 m.
        EXPECT_LT((corner_points(scene, p)[k] - corner_points(expected, p)[k]).norm(), 4e-7) << file;
      }
    }
  }
  EXPECT_EQ(read_scene(folder_ / "big.ply").vertices, expected.vertices) << "doubles to the bit";
}

TEST_F(Formats, PlyPassesOverWhatIsNotGeometry) {
  const Scene scene = read_scene(
      write("m.ply",
            "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement light 1\r\nproperty list uchar float power\r\n"
            "element vertex 4\r\nproperty float nx\r\nproperty float z\r\nproperty float y\r\nproperty float x\r\n"
            "property uchar red\r\nelement face 1\r\nproperty uchar flag\r\nproperty list uchar int vertex_index\r\n"
            "end_header\r\n2 7 8\r\n9 0 0 0 255\r\n9 0 0 1 255\r\n9 0 1 1 255\r\n9 0 1 0 255\r\n1 4 0 1 2 3\r\n"));
  EXPECT_EQ(area_vector(corner_points(scene, 0)), Vector(0, 0, 1));
  EXPECT_EQ(scene.polygons[0].line, 21U);
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 1U) << "light";
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"colors"}));
}

TEST_F(Formats, OffMayHaveCommentsColorsAndCountsBesideTheKeyWord) {
  const Scene scene = read_scene(write(
      "m.off",
      "COFF 4 1 0 # counts\n\n0 0 0 1 0 0\n1 0 0 1 0 0\n1 1 0 1 0 0 # corner\n0 1 0 1 0 0\n4 0 1 2 3 0.5 0.5 0.5\n"));
  EXPECT_EQ(area_vector(corner_points(scene, 0)), Vector(0, 0, 1));
  EXPECT_EQ(scene.polygons[0].line, 7U);
}

TEST_F(Formats, StlMayBeInCapitals) {
  const std::string stl =
      "SOLID Part\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\n"
      "ENDSOLID\n";
  for (const std::string& text : {stl, stl + std::string(200, '\n')}) {  // short, and longer than a binary header
    const Scene scene = read_scene(write("m.stl", text));
    ASSERT_EQ(scene.polygons.size(), 1U);
    EXPECT_EQ(area_vector(corner_points(scene, 0)), Vector(0, 0, 0.5));
    EXPECT_EQ(scene.groups, std::vector<std::string>{"Part"});
  }
}

TEST_F(Formats, BadNumbersAreRefusedNamingTheLine) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string off = "OFF\n3 1 0\n";
  const std::string stl = "solid\nfacet normal 0 0 1\nouter loop\n";
  for (const auto& [name, content, line] : std::vector<std::tuple<const char*, std::string, int>>{
           {"m.ply", ply + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 11},
           {"m.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 13},
           {"m.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 13},
           {"m.ply", "ply\nformat ascii 1.0\nelement vertex -3\n", 3},
           {"m.ply", "ply\nformat text 1.0\n", 2},
           {"m.off", off + "0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", 4},
           {"m.off", off + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6},
           {"m.off", off + "0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", 6},
           {"m.stl", stl + "vertex 0 0 0\nvertex 1 0\n", 5},
           {"m.stl", stl + "vertex 0 0 0\n", 3}}) {
    const auto file = write(name, content);
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string() + ":" + std::to_string(line) + ": ", 0), 0U) << message << content;
  }
}

TEST_F(Formats, GltfEmissionIsFactorTimesStrength) {
  const std::string lamp = std::string(grey_surface) +
                           R"(, "emissiveFactor": [1, 0.5, 0.25], "extensions": )"
                           R"({"KHR_materials_emissive_strength": {"emissiveStrength": 20}})";
  const Scene scene = read_scene(write("lamp.glb", test::as_glb(test::room(), "", lamp)));
  ASSERT_EQ(scene.materials.size(), 1U);
  EXPECT_TRUE(scene.materials[0].exitance.isApprox(std::numbers::pi * rgb(20, 10, 5), 1e-12));
}

TEST_F(Formats, GltfNodesMoveAndMirror) {
  ReadOptions options;
  options.keep_faces = true;
  const Scene scene =
      read_scene(write("room.glb", test::as_glb(test::room(),
                                                R"(, "translation": [10, 20, 30], "scale": [-2, 1, 1], )"
                                                R"("rotation": [0, 0, 0.7071067811865476, 0.7071067811865476])",
                                                grey_surface)),
                 options);
  // First scaled to x in [-6, 0], then rotated by 90 degrees about z: (x, y) to (-y, x), then moved.
  EXPECT_TRUE(bounds(scene).isApprox(Box(Point(7.6, 14, 30), Point(10, 20, 32.1)), 1e-6));
  // The mirrored room still faces inward: the signed volume (1/3) sum p . A keeps its sign.
  double volume = 0;
  for (PolygonIndex p = 0; p < 12; ++p) {
    const std::vector<Point> corners = corner_points(scene, p);
    volume += area_vector(corners).dot(corners[0]) / 3;
  }
  EXPECT_NEAR(volume, -2 * 3 * 2.4 * 2.1, 1e-4);
}

TEST_F(Formats, GltfTexturesAreReplacedByTheirMean) {
  // A PNG of two pixels, black and white: the mean is 0.5 in linear light for any encoding of the values.
  constexpr const char* image =
      "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAAAAADRSSBWAAAAC0lEQVR4nGNg+A8AAQIBAEK+vGgAAAAASUVORK5CYII=";
  std::string json = test::gltf_json(
      test::room(), R"("uri": "room.bin", )", "",
      R"("pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1], "baseColorTexture": {"index": 0}})");
  write("room.bin", test::gltf_buffer(test::room()));
  json.pop_back();
  json += R"(, "textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,)" + std::string(image) + "\"}]}";
  const Scene scene = read_scene(write("room.gltf", json));
  EXPECT_TRUE(scene.materials[0].reflectance.isApprox(rgb(0.4, 0.2, 0.1), 1e-12)) << scene.materials[0].reflectance;
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_picture));
}

TEST_F(Formats, GltfWithAMissingTextureIsReadWithANote) {
  std::string json = test::gltf_json(
      test::room(), R"("uri": "room.bin", )", "",
      R"("pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1], "baseColorTexture": {"index": 0}})");
  write("room.bin", test::gltf_buffer(test::room()));
  json.pop_back();
  json += R"(, "textures": [{"source": 0}], "images": [{"uri": "absent.png"}]})";
  const Scene scene = read_scene(write("room.gltf", json));
  EXPECT_TRUE(scene.materials[0].reflectance.isApprox(rgb(0.8, 0.4, 0.2), 1e-12));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"wall"}));
}

TEST_F(Formats, UnknownExtensionsAreRefusedByName) {
  std::string json = test::gltf_json(test::room(), R"("uri": "room.bin", )", "", grey_surface);
  json.pop_back();
  json += R"(, "extensionsRequired": ["EXT_unheard_of"]})";
  write("room.bin", test::gltf_buffer(test::room()));
  EXPECT_NE(refusal(write("room.gltf", json)).find("EXT_unheard_of"), std::string::npos);
}

TEST_F(Formats, DamagedFilesAreRefusedByName) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"room.ply", test::as_ply(test::room())},
      {"room.stl", test::as_stl(test::room())},
      {"room.off", test::as_off(test::room())},
      {"room.dae", test::as_collada(test::room())},
      {"room.ifc", test::as_ifc(test::room())},
      {"room.glb", test::as_glb(test::room(), "", grey_surface)},
      {"room.gltf", test::gltf_json(test::room(), R"("uri": "absent.bin", )", "", grey_surface)}};
  for (const auto& [name, content] : files) {
    for (const std::string& damaged : {std::string("x"), content.substr(0, 90)}) {
      const auto file = write(name, damaged);
      const std::string message = refusal(file);
      EXPECT_EQ(message.rfind(file.string() + ":", 0), 0U) << message;
      EXPECT_EQ(message.find("exception"), std::string::npos) << message;
      const std::size_t end = message.find('\n');
      EXPECT_TRUE(end == std::string::npos || message.substr(end).starts_with("\nhint: ")) << message;
      EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), end == std::string::npos ? 0 : 1) << message;
    }
  }
  EXPECT_NE(refusal(write("room.gltf", files.back().second)).find("absent.bin"), std::string::npos);
}

TEST_F(Formats, GltfNestedDeeperThanTheStackIsRefused) {
  constexpr int depth = 200000;
  std::string lists = std::string(depth, '[') + std::string(depth, ']');
  std::string nodes;
  for (int k = 1; k < depth; ++k) nodes += R"({"children": [)" + std::to_string(k) + "]}, ";
  for (const std::string& deep :
       {R"("extras": )" + lists, R"("scenes": [{"nodes": [0]}], "nodes": [)" + nodes + "{}]"}) {
    const auto file = write("deep.gltf", R"({"asset": {"version": "2.0"}, )" + deep + "}");
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string() + ": ", 0), 0U) << message;
  }
}

TEST_F(Formats, AGltfNodeIsInTheTreeOnce) {
  // Each of 60 nodes includes the previous one twice, which gives 2^60. Another node is its own descendant.
  std::string nodes;
  for (int k = 1; k < 60; ++k) nodes += R"({"children": [)" + std::to_string(k) + ", " + std::to_string(k) + "]}, ";
  for (const std::string& tree : {nodes + "{}", std::string(R"({"children": [0]})")}) {
    const auto file =
        write("tree.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [)" + tree + "]}");
    EXPECT_NE(refusal(file).find("tree.gltf: "), std::string::npos);
  }
}

TEST_F(Formats, TheFormatCanBeGiven) {
  ReadOptions options;
  options.format = "off";
  options.keep_faces = true;
  EXPECT_EQ(read_scene(write("room.txt", test::as_off(test::room())), options).polygons.size(), 24U);
}

TEST_F(Formats, EqualMaterialsOfSeveralFilesAreShared) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::string above = "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";  // coincident faces would be merged
  write("a.mtl", "newmtl wall\nKd .5 .5 .5\nnewmtl floor\nKd .1 .1 .1\n");
  write("b.mtl", "newmtl wall\nKd .5 .5 .5\nnewmtl floor\nKd .2 .2 .2\n");
  const std::string faces = "usemtl wall\nf 1 2 3\nusemtl floor\nf 1 3 4\n";
  const std::vector<std::filesystem::path> files = {write("a.obj", "mtllib a.mtl\n" + square + faces),
                                                    write("b.obj", "mtllib b.mtl\n" + above + faces)};
  const Scene scene = read_scene(files);
  ASSERT_EQ(scene.materials.size(), 3U);
  ASSERT_EQ(scene.polygons.size(), 4U);
  EXPECT_EQ(scene.polygons[0].material, scene.polygons[2].material);
  EXPECT_EQ(scene.materials[scene.polygons[3].material].name, "floor (b.obj)");
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::renamed_material, {"'floor (b.obj)'"}));
}

TEST_F(Formats, AFaultIsFoundInItsOwnFile) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::vector<std::filesystem::path> files = {write("a.obj", square + "f 1 2 3 4\n"),
                                                    write("b.obj", square + "f 1 2 5\n")};
  try {
    read_scene(files);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(files[1].string() + ":5: ", 0), 0U) << error.what();
  }
}

}  // namespace
}  // namespace patchlight::formats_test
