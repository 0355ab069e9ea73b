#include "patchlight/input/read_scene.h"

#include "input/mitsuba/mitsuba_file.h"
#include "model_files.h"

#include <cmath>
#include <map>
#include <numbers>
#include <variant>

namespace patchlight::mitsuba_test {
namespace {

using std::numbers::pi;

const std::string red =
    "<bsdf type=\"twosided\" id=\"Red\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.6, 0.1, "
    "0.2\"/></bsdf></bsdf>\n";

class Mitsuba : public ModelFiles {
 protected:
  Mitsuba() { write("part.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3/1/1 -2/1/1 -1/1/1\n"); }
  std::filesystem::path file_of(const std::string& text) const {
    return write("scene.xml", "<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">\n" + text + "</scene>\n");
  }
  Scene read(const std::string& text, const ReadOptions& options = {}) const {
    return read_scene(file_of(text), options);
  }
  Material material(const std::string& bsdf) const {
    const Scene scene = read(red +
                             "<shape type=\"rectangle\"><transform name=\"to_world\"><translate "
                             "z=\"9\"/></transform><ref id=\"Red\"/></shape><shape type=\"rectangle\">" +
                             bsdf + "</shape>");
    return scene.materials.at(scene.polygons.at(1).material);
  }
};

void expect_corners(const Scene& scene, PolygonIndex p, const std::vector<Point>& expected) {
  const std::vector<Point> found = corner_points(scene, p);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_LT((found[k] - expected[k]).norm(), 1e-12) << k;
}

// Scaled to 4 x 6, then z rotated up from y, then moved: x 8 to 12, y 20, z 27 to 33.
TEST_F(Mitsuba, StepsOfATransformationApplyInTheirOrder) {
  const Scene scene =
      read(red +
           "<shape type=\"rectangle\"><transform name=\"toWorld\"><scale x=\"2\" y=\"3\"/><rotate "
           "x=\"1\" angle=\"90\"/><translate x=\"10\" y=\"20\" z=\"30\"/></transform><ref "
           "id=\"Red\"/><emitter type=\"area\"><rgb name=\"radiance\" value=\"5, 6, 7\"/></emitter></shape>\n");
  ASSERT_EQ(scene.polygons.size(), 1U);
  expect_corners(scene, 0, {{8, 20, 27}, {12, 20, 27}, {12, 20, 33}, {8, 20, 33}});
  const Material& material = scene.materials.at(0);
  EXPECT_EQ(material.name, "Red");
  EXPECT_TRUE((material.reflectance == rgb(0.6, 0.1, 0.2)).all());
  EXPECT_TRUE(material.exitance.isApprox(pi * rgb(5, 6, 7)));
}

// The frame looks along +z: the front of a rectangle faces the target.
TEST_F(Mitsuba, LookAtTurnsZToTheTarget) {
  const Scene scene = read(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0, "
      "-5, 0\" up=\"0 0 1\"/></transform></shape>\n");
  EXPECT_LT((front_normal(scene, 0) - Vector(0, -1, 0)).norm(), 1e-12);
  const Scene moved = read(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><matrix value=\"0 0 2 1  2 0 0 2  0 2 "
      "0 3  0 0 0 1\"/></transform></shape>\n");
  expect_corners(moved, 0, {{1, 0, 1}, {1, 4, 1}, {1, 4, 5}, {1, 0, 5}});
}

// Sum of p . A / 3: the volume with fronts outward.
double volume(const Scene& scene) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> corners = corner_points(scene, p);
    sum += corners[0].dot(area_vector(corners)) / 3;
  }
  return sum;
}

double area(const Scene& scene) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) sum += area_vector(corner_points(scene, p)).norm();
  return sum;
}

TEST_F(Mitsuba, ShapesHaveTheirVolumesAndAreas) {
  constexpr double digits = 1e-10;
  EXPECT_NEAR(volume(read("<shape type=\"cube\"/>")), 8, digits);
  EXPECT_NEAR(volume(read("<shape type=\"cube\"><boolean name=\"flipNormals\" value=\"true\"/></shape>")), -8, digits);
  const Scene sphere = read(
      "<shape type=\"sphere\"><float name=\"radius\" value=\"2\"/><point name=\"center\" x=\"1\" "
      "y=\"2\" z=\"3\"/></shape>");
  EXPECT_NEAR(area(sphere), 16 * pi, digits);
  EXPECT_GT(volume(sphere), 0.95 * 32 * pi / 3);
  EXPECT_NEAR(area(read("<shape type=\"disk\"/>")), pi, digits);
  EXPECT_NEAR(area(read("<shape type=\"cylinder\"><point name=\"p1\" value=\"0, 0, 3\"/><float name=\"radius\" "
                        "value=\".5\"/></shape>")),
              3 * pi, digits);
}

TEST_F(Mitsuba, AMirroredMeshKeepsItsFront) {
  const Scene scene = read(
      "<shape type=\"obj\"><string name=\"filename\" value=\"part.obj\"/><transform "
      "name=\"toWorld\"><scale x=\"-1\"/></transform></shape>\n");
  ASSERT_EQ(scene.polygons.size(), 1U);
  EXPECT_GT(front_normal(scene, 0).z(), 0.99);
  EXPECT_EQ(scene.inputs.size(), 2U);
}

// A pane of index n that absorbs nothing transmits 2 n / (n^2 + 1). A metal of eta and k reflects ((eta - 1)^2 + k^2) /
// ((eta + 1)^2 + k^2).
TEST_F(Mitsuba, BsdfsBecomeMaterials) {
  const Material glass = material(
      "<bsdf type=\"thindielectric\"><float name=\"intIOR\" value=\"1.5\"/><float "
      "name=\"extIOR\" value=\"1\"/></bsdf>");
  EXPECT_NEAR(glass.transmittance[0], 2 * 1.5 / 3.25, 1e-12);
  EXPECT_EQ(glass.index, 1.5);
  EXPECT_NEAR(material("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"water\"/><string name=\"ext_ior\" "
                       "value=\"vacuum\"/></bsdf>")
                  .index,
              1.333, 1e-12);
  const Material mirror = material(
      "<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"2\"/><rgb name=\"k\" "
      "value=\"1\"/></bsdf>");
  EXPECT_NEAR(mirror.specular_reflectance[0], 2. / 10, 1e-12);
  EXPECT_EQ(
      material("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>").specular_reflectance[2],
      1);
  const Material rough = material(
      "<bsdf type=\"roughconductor\"><rgb name=\"specularReflectance\" value=\".5\"/><rgb "
      "name=\"eta\" value=\"2\"/><rgb name=\"k\" value=\"1\"/></bsdf>");
  EXPECT_NEAR(rough.reflectance[0], .1, 1e-12);
  EXPECT_EQ(
      material("<bsdf type=\"plastic\"><rgb name=\"diffuse_reflectance\" value=\".1 .2 .3\"/></bsdf>").reflectance[1],
      .2);
  EXPECT_EQ(material("<bsdf type=\"mask\"><bsdf type=\"bumpmap\"><ref id=\"Red\"/></bsdf></bsdf>").reflectance[0], .6);
  const Material paper = material("<bsdf type=\"difftrans\"><rgb name=\"transmittance\" value=\".4\"/></bsdf>");
  EXPECT_EQ(paper.diffuse_transmittance[0], .4);
}

// A color of sRGB by IEC 61966-2-1. A constant spectrum is white.
TEST_F(Mitsuba, ColoursAreLinearRgb) {
  const auto colour = [&](const std::string& element) {
    return material("<bsdf type=\"diffuse\">" + element + "</bsdf>").reflectance;
  };
  EXPECT_NEAR(colour("<srgb name=\"reflectance\" value=\"#ff8000\"/>")[1], std::pow((128 / 255. + .055) / 1.055, 2.4),
              1e-12);
  EXPECT_NEAR(colour("<spectrum name=\"reflectance\" value=\"300:0.5, 900:0.5\"/>")[0], .5, 1e-12);
  EXPECT_EQ(colour("<spectrum name=\"reflectance\" value=\"0.25\"/>")[2], .25);
  EXPECT_EQ(colour("<texture name=\"reflectance\" type=\"checkerboard\"><rgb name=\"color0\" value=\".1\"/><rgb "
                   "name=\"color1\" value=\".5\"/></texture>")[0],
            .3);
  EXPECT_EQ(colour("<texture name=\"reflectance\" type=\"bitmap\"/>")[0], .5);
}

TEST_F(Mitsuba, PicturesCountByTheirMean) {
  write("paint.png", two_pixels());
  const Material painted = material(
      R"(<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="paint.png"/></texture></bsdf>)");
  EXPECT_NEAR(painted.reflectance[0], .5, 1e-12);
  EXPECT_EQ(painted.reflectance[1], 0);
  EXPECT_NEAR(painted.reflectance[2], std::pow((128 / 255. + .055) / 1.055, 2.4) / 2, 1e-12);
}

// Red light beyond 600 nm has more red than green, and no blue. The three parts of a spectrum add up to it.
TEST(RgbOfWavelengths, IsLinearAndTellsColoursApart) {
  using Samples = std::vector<std::pair<double, double>>;
  const Spectrum low = rgb_of_wavelengths(Samples{{380, 1}, {480, 1}, {480.001, 0}});
  const Spectrum middle = rgb_of_wavelengths(Samples{{480.0005, 0}, {480.001, 1}, {600, 1}, {600.001, 0}});
  const Spectrum high = rgb_of_wavelengths(Samples{{600.0005, 0}, {600.001, 1}, {780, 1}});
  EXPECT_NEAR((low + middle + high - 1).abs().maxCoeff(), 0, 1e-9);
  EXPECT_GT(high[0], 2 * std::abs(high[1]));
  EXPECT_LT(std::abs(high[2]), .05);
  EXPECT_GT(low[2], 0.9);
}

TEST_F(Mitsuba, EmittersWithoutSurfacesAreLights) {
  const std::string shape = "<shape type=\"rectangle\"/>";
  const Scene even = read(shape + "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>");
  ASSERT_TRUE(even.sky);
  EXPECT_EQ(even.sky->zenith_radiance[1], 2);
  EXPECT_EQ(even.sky->ground_radiance[2], 3);
  ReadOptions centimetres;
  centimetres.metres_per_unit = 0.01;
  const Scene point = read(shape +
                               "<emitter type=\"point\"><point name=\"position\" value=\"100, 200, 300\"/><rgb "
                               "name=\"intensity\" value=\"5e4\"/></emitter>",
                           centimetres);
  ASSERT_EQ(point.luminaires.size(), 1U);
  EXPECT_LT((point.luminaires[0].position - Point(1, 2, 3)).norm(), 1e-12);
  // The irradiance at a point equals that of the scene in its own unit: I / d^2.
  EXPECT_NEAR(std::get<PointLight>(point.luminaires[0].light).intensity[0], 5, 1e-12);
  const Scene sun = read(shape +
                         "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-3\" z=\"-4\"/><rgb "
                         "name=\"irradiance\" value=\"7\"/></emitter>");
  ASSERT_TRUE(sun.sun);
  EXPECT_LT((sun.sun->direction - Vector(0, .6, .8)).norm(), 1e-12);
  EXPECT_EQ(sun.sun->normal_irradiance[0], 7);
  EXPECT_EQ(number_of(read(shape + "<emitter type=\"sunsky\"/>"), DiagnosticCode::left_out), 1U);
}

// Perpendicular to the view, 90 degrees horizontally at 2 : 1. Half of it is vertical: 2 atan(1 / 2).
TEST_F(Mitsuba, ASensorIsAView) {
  const Scene scene = read(
      "<shape type=\"rectangle\"/><sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/><transform "
      "name=\"to_world\"><lookat origin=\"1 2 3\" target=\"1 2 9\" up=\"0 1 0\"/></transform><film "
      "type=\"hdrfilm\"><integer "
      "name=\"width\" value=\"200\"/><integer name=\"height\" value=\"100\"/></film></sensor>");
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_LT((scene.cameras[0].eye - Point(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((scene.cameras[0].target - Point(1, 2, 4)).norm(), 1e-12);
  EXPECT_NEAR(scene.cameras[0].vertical_field_of_view, 2 * std::atan(.5) * 180 / pi, 1e-12);
}

TEST_F(Mitsuba, FilesIncludeOthersAndNamesHaveValues) {
  write("more.xml",
        "<scene version=\"3.0.0\"><default name=\"size\" value=\"9\"/><shape type=\"rectangle\"><transform "
        "name=\"to_world\"><scale value=\"$size\"/></transform></shape></scene>");
  const Scene scene = read(
      "<default name=\"size\" value=\"2\"/><default name=\"what\" value=\"more\"/>\n<include filename=\"$what.xml\"/>");
  ASSERT_EQ(scene.polygons.size(), 1U);
  EXPECT_NEAR(area(scene), 16, 1e-12);
  EXPECT_EQ(scene.polygons[0].line, 4U);
  const Scene instances = read(
      "<shape type=\"shapegroup\" id=\"chairs\"><shape type=\"cube\"/></shape><shape type=\"instance\"><ref "
      "id=\"chairs\"/></shape><shape type=\"instance\"><ref id=\"chairs\"/><transform name=\"to_world\"><translate "
      "x=\"9\"/></transform></shape>");
  EXPECT_NEAR(volume(instances), 16, 1e-10);
}

TEST_F(Mitsuba, WhatIsLostIsNamed) {
  const Scene scene = read(
      "<bsdf type=\"roughconductor\" id=\"Metal\"/><shape type=\"cube\"><ref id=\"Metal\"/></shape><shape "
      "type=\"obj\"><string name=\"filename\" value=\"absent.obj\"/></shape><shape type=\"serialized\" "
      "id=\"teapot\"/><shape "
      "type=\"disk\"><transform name=\"to_world\"><translate z=\"5\"/></transform><bsdf "
      "type=\"null\"/></shape><emitter type=\"envmap\"/>");
  EXPECT_EQ(scene.polygons.size(), 6U);
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 3U) << "absent.obj, teapot, envmap";
  for (const char* const part : {"1 (Metal)", "null"})
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {part})) << part;
}

TEST_F(Mitsuba, WhatCannotBeReadIsRefusedWithItsLine) {
  write("self.xml", "<scene>\n<include filename=\"self.xml\"/></scene>");
  for (const auto& [text, message] : std::map<std::string, std::string>{
           {"<shape type=\"cube\"><transform name=\"to_world\">\n<shear x=\"1\"/></transform></shape>",
            ":4: the transformation <shear>"},
           {"<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>",
            ":3: <matrix> has 2 numbers"},
           {"<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"a\"/></transform></shape>",
            ":3: <scale>: found 'a'"},
           {"<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>",
            ":3: '$r' names a variable without a <default>"},
           {"<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>", ":3: the sphere has a radius"},
           {"<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 2\"/></bsdf></shape>",
            ":3: <rgb>: found '1 2'"},
           {"<include filename=\"absent.xml\"/>", ":3: "},
           {"<include filename=\"self.xml\"/>", "self.xml:2: includes "},
           {"<shape type=\"instance\" id=\"a\"><ref id=\"b\"/></shape><shape id=\"b\" type=\"shapegroup\"><shape "
            "type=\"instance\"><ref id=\"b\"/></shape></shape>",
            ":3: instances stand in each other"},
           {"<shape", ":3: is not valid XML"}}) {
    EXPECT_NE(refusal(file_of(text)).find(message), std::string::npos) << refusal(file_of(text)) << "\n" << message;
  }
}

}  // namespace
}  // namespace patchlight::mitsuba_test
