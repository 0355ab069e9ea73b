#include "patchlight/input/read_scene.h"

#include "input/building/cut_openings.h"
#include "model_files.h"
#include "support/diagnostics_of.h"

#include <map>

namespace patchlight::gbxml_test {
namespace {

std::string loop(const std::vector<Point>& corners) {
  std::string text = "<PolyLoop>";
  for (const Point& corner : corners) {
    text += "<CartesianPoint>";
    for (const double coordinate : {corner.x(), corner.y(), corner.z()})
      text += "<Coordinate>" + std::to_string(coordinate) + "</Coordinate>";
    text += "</CartesianPoint>";
  }
  return text + "</PolyLoop>";
}

std::string surface(const std::string& kind, const std::string& name, const std::vector<Point>& corners,
                    const std::string& openings = "", const std::string& space = "s1") {
  return "<Surface surfaceType=\"" + kind + "\" id=\"" + name + "\"><AdjacentSpaceId spaceIdRef=\"" + space +
         "\"/><PlanarGeometry>" + loop(corners) + "</PlanarGeometry>" + openings + "</Surface>\n";
}

std::string opening(const std::string& kind, const std::string& name, const std::vector<Point>& corners,
                    const std::string& type = "") {
  return "<Opening openingType=\"" + kind + "\" id=\"" + name + "\"" +
         (type.empty() ? "" : " windowTypeIdRef=\"" + type + "\"") + "><PlanarGeometry>" + loop(corners) +
         "</PlanarGeometry></Opening>\n";
}

const std::vector<Point> floor_corners = {{0, 0, 0}, {0, 3, 0}, {4, 3, 0}, {4, 0, 0}};  // its front faces down
const std::vector<Point> wall_corners = {{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {0, 0, 3}};
const std::vector<Point> window_corners = {{1, 0, 1}, {2, 0, 1}, {2, 0, 2}, {1, 0, 2}};
const std::vector<Point> door_corners = {{3, 0, 0}, {3.5, 0, 0}, {3.5, 0, 2}, {3, 0, 2}};

// The model is one room of 4 x 3 m with a floor and a wall that has a window and a door.
std::string building(const std::string& unit = "Meters", const std::string& more = "") {
  return "<?xml version=\"1.0\"?>\n<gbXML lengthUnit=\"" + unit +
         "\" xmlns=\"http://www.gbxml.org/schema\">\n<Campus id=\"c\"><Building id=\"b\"><BuildingStorey "
         "id=\"l1\"><Name>Ground</Name></BuildingStorey><Space id=\"s1\" buildingStoreyIdRef=\"l1\"><Name>Office "
         "\xC3\xA9</Name></Space></Building>\n" +
         surface("SlabOnGrade", "floor", floor_corners) +
         surface(
             "ExteriorWall", "wall", wall_corners,
             opening("FixedWindow", "window", window_corners, "w1") + opening("NonSlidingDoor", "door", door_corners)) +
         more +
         "</Campus>\n<WindowType id=\"w1\"><Name>clear</Name><Transmittance unit=\"Percent\" "
         "type=\"Visible\">60</Transmittance></WindowType>\n</gbXML>\n";
}

std::string utf16(const std::string& text, bool little) {
  std::string result = little ? "\xFF\xFE" : "\xFE\xFF";
  for (std::size_t k = 0; k < text.size(); ++k) {
    auto unit = static_cast<unsigned>(static_cast<unsigned char>(text[k]));
    if (unit >= 0xC0) unit = (unit & 0x1FU) << 6U | (static_cast<unsigned char>(text[++k]) & 0x3FU);
    const char low = static_cast<char>(unit & 0xFFU);
    const char high = static_cast<char>(unit >> 8U);
    result += little ? low : high;
    result += little ? high : low;
  }
  return result;
}

class Gbxml : public ModelFiles {
 protected:
  Scene read(const std::string& text) const { return read_scene(write("house.xml", text)); }
};

PolygonIndex named(const Scene& scene, const std::string& name) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (scene.groups.at(scene.polygons[p].group) == name) return p;
  }
  throw std::runtime_error("no " + name);
}

double area_of(const Scene& scene, const std::string& name) {
  return area_vector(corner_points(scene, named(scene, name))).norm();
}

TEST_F(Gbxml, OpeningsAreCutOutOfTheirSurface) {
  const Scene scene = read(building());
  ASSERT_EQ(scene.polygons.size(), 4U);
  EXPECT_NEAR(area_of(scene, "wall"), 12 - 1 - 1, 1e-12);
  EXPECT_NEAR(area_of(scene, "window"), 1, 1e-12);
  EXPECT_NEAR(area_of(scene, "door"), 1, 1e-12);
  EXPECT_TRUE(scene.up_stated);
  EXPECT_EQ(scene.up, Vector::UnitZ());
  for (const Diagnostic& problem : test::problems_of(scene)) ADD_FAILURE() << problem.text;
}

TEST_F(Gbxml, LengthsHaveTheUnitOfTheFile) {
  for (const auto& [unit, metres] :
       std::map<std::string, double>{{"Feet", 0.3048}, {"Inches", 0.0254}, {"Millimeters", 0.001}, {"Yards", 0.9144}}) {
    const Scene scene = read(building(unit));
    EXPECT_NEAR(area_of(scene, "floor") / (12 * metres * metres), 1, 1e-12) << unit;
    EXPECT_EQ(scene.metres_per_unit, metres);
  }
}

TEST_F(Gbxml, AGivenUnitReplacesThatOfTheFile) {
  const Scene stated = read(building("Millimeters"));
  EXPECT_TRUE(stated.unit_stated);
  const Scene given = read_scene(stated.file, {.metres_per_unit = 1});
  EXPECT_NEAR(area_of(given, "floor"), 12, 1e-9);
  EXPECT_EQ(given.metres_per_unit, 1);
  EXPECT_FALSE(given.unit_stated);
}

TEST_F(Gbxml, SpacesAreRoomsOfTheirStoreys) {
  const Scene scene = read(building());
  ASSERT_EQ(scene.rooms.size(), 1U);
  EXPECT_EQ(scene.rooms[0].name, "Office \xC3\xA9");
  EXPECT_EQ(scene.rooms[0].storey, "Ground");
  ASSERT_EQ(scene.rooms[0].faces.size(), 2U);
  EXPECT_NEAR(area_vector(scene.rooms[0].faces[1]).norm(), 12, 1e-12);
}

TEST_F(Gbxml, Utf16IsReadAsUtf8Is) {
  const Scene expected = read(building());
  for (const bool little : {false, true}) {
    const Scene scene = read(utf16(building(), little));
    EXPECT_EQ(scene.rooms.at(0).name, expected.rooms[0].name);
    EXPECT_EQ(scene.vertices, expected.vertices);
    EXPECT_EQ(scene.polygons.at(1).line, expected.polygons[1].line);
  }
}

// The top of a horizontal face is a floor, its underside a ceiling. The front of this one faces down.
TEST_F(Gbxml, SidesHaveTheReflectancesOfTheirKind) {
  const Scene scene = read(building());
  const Polygon& floor = scene.polygons.at(named(scene, "floor"));
  ASSERT_TRUE(floor.back_material);
  EXPECT_EQ(scene.materials.at(floor.material).name, "SlabOnGrade-underside");
  EXPECT_EQ(scene.materials.at(floor.material).reflectance[0], 0.8);
  EXPECT_EQ(scene.materials.at(*floor.back_material).name, "SlabOnGrade-top");
  EXPECT_EQ(scene.materials.at(*floor.back_material).reflectance[0], 0.2);
  const Material& pane = scene.materials.at(scene.polygons.at(named(scene, "window")).material);
  EXPECT_EQ(pane.name, "clear");
  EXPECT_NEAR(pane.transmittance[0], 0.6, 1e-15);
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material, {"0.5"}));
}

TEST_F(Gbxml, WhatIsNotStatedIsSaidAndAirIsOpen) {
  const std::vector<Point> other = {{0, 3, 0}, {4, 3, 0}, {4, 3, 3}, {0, 3, 3}};
  const Scene scene = read(
      building("Meters", surface("Air", "gap", other) +
                             surface("InteriorWall", "glazed", {{0, 0, 0}, {0, 3, 0}, {0, 3, 3}, {0, 0, 3}},
                                     opening("OperableWindow", "all", {{0, 0, 0}, {0, 3, 0}, {0, 3, 3}, {0, 0, 3}}))));
  EXPECT_THROW(named(scene, "gap"), std::runtime_error);
  EXPECT_THROW(named(scene, "glazed"), std::runtime_error);  // the window takes all of it
  EXPECT_NEAR(area_of(scene, "all"), 9, 1e-12);
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material, {"0.7", "OperableWindow"}));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"1 (gap)"}));
}

TEST_F(Gbxml, WhatCannotBeReadIsRefusedWithItsLine) {
  for (const auto& [text, message] : std::map<std::string, std::string>{
           {"<gbXML lengthUnit=\"Ells\"/>", "house.xml:1: lengthUnit: found 'Ells'"},
           {"<gbXML><Campus><Surface><PlanarGeometry><PolyLoop><CartesianPoint>\n<Coordinate>x</Coordinate>"
            "</CartesianPoint></PolyLoop></PlanarGeometry></Surface></Campus></gbXML>",
            "house.xml:2: found the coordinate 'x'"},
           {"<gbXML><Campus><Surface><PlanarGeometry><PolyLoop>\n\n<CartesianPoint><Coordinate>1</Coordinate>"
            "</CartesianPoint></PolyLoop></PlanarGeometry></Surface></Campus></gbXML>",
            "house.xml:3: a CartesianPoint has fewer"},
           {"<gbXML>\n<Campus>\n</gbXML>", "house.xml:3: is not valid XML"},
           {"<html/>", "the first element is <html>; expected <scene>"}}) {
    EXPECT_NE(refusal(write("house.xml", text)).find(message), std::string::npos)
        << refusal(write("house.xml", text)) << "\n"
        << message;
  }
}

// An outline of 4 x 3 m, for openings of either orientation.
TEST(WithoutOpenings, NotchesAndHolesTakeTheirAreas) {
  const auto rectangle = [](double x, double z, double width, double height) {
    return std::vector<Point>{{x, 0, z}, {x, 0, z + height}, {x + width, 0, z + height}, {x + width, 0, z}};
  };
  const std::vector<Point> wall = rectangle(0, 0, 4, 3);
  const auto left = [&](const std::vector<std::vector<Point>>& openings) {
    const CutOutline cut = without_openings(wall, openings, 1e-3);
    EXPECT_EQ(cut.beyond, 0U);
    double area = 0;
    for (const std::vector<Point>& part : cut.parts) area += area_vector(part).norm();
    return area;
  };
  EXPECT_EQ(left({}), 12);
  EXPECT_NEAR(left({rectangle(1, 0, 1, 2)}), 10, 1e-7);                          // at the bottom
  EXPECT_NEAR(left({rectangle(0, 0, 1, 2)}), 10, 1e-7);                          // in a corner
  EXPECT_NEAR(left({rectangle(0, 1, 1, 1)}), 11, 1e-7);                          // at a side
  EXPECT_NEAR(left({rectangle(1, 0, 1, 2), rectangle(2.5, 1, 1, 1)}), 9, 1e-7);  // and a hole
  EXPECT_NEAR(left({rectangle(1, 0, 1, 2), rectangle(2, 0, 1, 2)}), 8, 1e-7);    // side by side
  EXPECT_NEAR(left({rectangle(0, 0, 4, 3)}), 0, 1e-7);                           // all of it
  EXPECT_NEAR(left({rectangle(0, 0, 2, 3), rectangle(2, 0, 2, 3)}), 0, 1e-7);    // in two
  EXPECT_NEAR(left({rectangle(0, 2, 4, 1)}), 8, 1e-7);                           // a band
}

}  // namespace
}  // namespace patchlight::gbxml_test
