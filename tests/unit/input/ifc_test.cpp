#include "patchlight/input/read_scene.h"

#include "ifc_files.h"
#include "model_files.h"

#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace patchlight::ifc_test {
namespace {

using test::IfcFile;
using test::IfcWay;

class Ifc : public ModelFiles {};

constexpr std::array all_ways = {IfcWay::upward,    IfcWay::across,  IfcWay::brep,  IfcWay::triangulated,
                                 IfcWay::polygonal, IfcWay::clipped, IfcWay::mapped};

// The area of the surface of a solid and the volume in it (divergence theorem).
struct Solid {
  double area = 0;
  double volume = 0;
};

// Keys are the groups' names without class and identifier.
std::map<std::string, Solid> solids_of(const Scene& scene) {
  std::map<std::string, Solid> solids;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::string& group = scene.groups.at(scene.polygons[p].group);
    const std::size_t begin = group.find('_') + 1;
    Solid& solid = solids[group.substr(begin, group.rfind('_') - begin)];
    const std::vector<Point> points = corner_points(scene, p);
    Vector twice = Vector::Zero();
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      twice += (points[k] - points[0]).cross(points[k + 1] - points[0]);
      solid.volume += points[0].dot(points[k].cross(points[k + 1])) / 6;
    }
    solid.area += twice.norm() / 2;
  }
  return solids;
}

// A wall of 5 m x 0.2 m x 3 m that begins at `y`, and openings in it, in mm.
Box wall_at(double y) { return {Point(0, y, 0), Point(5000, y + 200, 3000)}; }

Box opening_at(double y, double x, double z, double width, double height, double beyond) {
  return {Point(x, y - beyond, z), Point(x + width, y + 200 + beyond, z + height)};
}

// Area 2 (A - sum of openings) + d (rims of the wall and of the openings), volume d (A - sum of openings).
Solid wall_with_openings(double openings, double rims) {
  return {2 * (15 - openings) + 0.2 * (16 + rims), 0.2 * (15 - openings)};
}

void expect_solid(const Solid& found, const Solid& expected, const std::string& name) {
  EXPECT_NEAR(found.area, expected.area, 1e-6 * expected.area) << name;
  EXPECT_NEAR(found.volume, expected.volume, 2e-6 * expected.volume) << name;
}

// The area is known for openings inside the wall's thickness and beyond it. All representations of walls and openings
// are combined.
TEST_F(Ifc, OpeningsAreCutHoweverWallsAndOpeningsAreWritten) {
  for (const std::string schema : {"IFC4", "IFC2X3"}) {
    IfcFile file(schema);
    std::vector<std::string> names;
    for (const IfcWay way : all_ways) {
      for (const IfcWay opening_way : {IfcWay::upward, IfcWay::across, IfcWay::brep, IfcWay::triangulated}) {
        const auto is_new = [](IfcWay one) { return one == IfcWay::triangulated || one == IfcWay::polygonal; };
        if (schema == "IFC2X3" && (is_new(way) || is_new(opening_way))) continue;
        const double y = 1000. * static_cast<double>(names.size());
        names.push_back("wall " + std::to_string(names.size()));
        const std::string wall = file.element("IFCWALL", names.back(), file.box(wall_at(y), way));
        file.cut(wall, file.box(opening_at(y, 1000, 500, 1000, 2000, 0), opening_way));
        file.cut(wall, file.box(opening_at(y, 2500, 1000, 1500, 800, 70), opening_way));
      }
    }
    const std::map<std::string, Solid> solids = solids_of(read_scene(write("walls.ifc", file.text())));
    EXPECT_EQ(solids.size(), names.size());
    for (const std::string& name : names)
      expect_solid(solids.contains(name) ? solids.at(name) : Solid(), wall_with_openings(2 + 1.2, 6 + 4.6),
                   schema + " " + name);
  }
}

// A door that starts at the foot of the wall removes its sill from the wall.
TEST_F(Ifc, DoorsAreCutOutOfTheEdgeOfAWall) {
  IfcFile file;
  const std::string wall = file.element("IFCWALL", "wall", file.box(wall_at(0), IfcWay::upward));
  file.cut(wall, file.box(opening_at(0, 1000, 0, 1000, 2000, 50), IfcWay::across));
  expect_solid(solids_of(read_scene(write("door.ifc", file.text())))["wall"], wall_with_openings(2, 4), "door");
}

// Twelve windows in three rows give one wall, not twelve.
TEST_F(Ifc, WallsWithRowsOfWindowsKeepTheirArea) {
  IfcFile file;
  const std::string wall = file.element("IFCWALL", "wall", file.box(wall_at(0), IfcWay::upward));
  for (int k = 0; k < 12; ++k)
    file.cut(wall, file.box(opening_at(0, 200 + 1150 * (k % 4), 200 + 900 * (k / 4), 700, 600, 10), IfcWay::across));
  expect_solid(solids_of(read_scene(write("rows.ifc", file.text())))["wall"], wall_with_openings(12 * 0.42, 12 * 2.6),
               "rows");
}

// Profiles with voids, like those of window frames: polygons and a circle of 0.5 m, which becomes a polygon.
TEST_F(Ifc, VoidsOfProfilesAreCut) {
  IfcFile file;
  const std::string outline = file.outline({{0, 0}, {5000, 0}, {5000, 3000}, {0, 3000}});
  const std::string pane = file.outline({{1000, 500}, {1000, 2500}, {2000, 2500}, {2000, 500}});
  const std::string triangle = file.outline({{3000, 1000}, {4000, 1000}, {3000, 2000}});
  const std::string middle = file.add("IFCAXIS2PLACEMENT2D(" + file.add("IFCCARTESIANPOINT((3500.,1500.))") + ",$)");
  const std::string circle = file.add("IFCCIRCLE(" + middle + ",500.)");
  const auto profile = [&](const std::string& voids) {
    return file.add("IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$," + outline + ",(" + voids + "))");
  };
  file.element("IFCPLATE", "polygons", file.across(profile(pane + "," + triangle), 0, 200));
  file.element("IFCPLATE", "circle", file.across(profile(circle), 1000, 200));
  const std::map<std::string, Solid> solids = solids_of(read_scene(write("plates.ifc", file.text())));
  expect_solid(solids.at("polygons"), wall_with_openings(2.5, 8 + std::sqrt(2.0)), "polygons");
  EXPECT_NEAR(solids.at("circle").volume, 0.2 * (15 - 0.25 * std::numbers::pi), 0.01);
}

TEST_F(Ifc, LengthsAreMetresWhateverTheUnit) {
  const std::string foot =
      "IFCCONVERSIONBASEDUNIT(#901,.LENGTHUNIT.,'FOOT',#902);\n#901=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n"
      "#902=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048),#903);\n#903=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)";
  const std::vector<std::pair<std::string, double>> units = {
      {"IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)", 1}, {"IFCSIUNIT(*,.LENGTHUNIT.,.CENTI.,.METRE.)", 0.01}, {foot, 0.3048}};
  for (const auto& [unit, metres] : units) {
    IfcFile file("IFC4", unit);
    file.element("IFCSLAB", "slab", file.box({Point(1, 2, 3), Point(9, 8, 4)}, IfcWay::brep));
    const std::filesystem::path written = write("slab.ifc", file.text());
    const Box found = bounds(read_scene(written));
    EXPECT_LT((found.min() - metres * Point(1, 2, 3)).norm(), 1e-6) << unit;
    EXPECT_LT((found.max() - metres * Point(9, 8, 4)).norm(), 1e-6) << unit;
    const Box twice = bounds(read_scene(written, {.metres_per_unit = 2}));
    EXPECT_LT((twice.max() - 2 * Point(9, 8, 4)).norm(), 1e-6) << unit;
  }
}

// Rooms have a name and a long name with all their letters, and a storey. Their bodies are no faces.
TEST_F(Ifc, SpacesAreRoomsWithLongNames) {
  IfcFile file;
  const auto body = [&](double x) { return file.box({Point(x, 0, 0), Point(x + 4000, 3000, 2500)}, IfcWay::upward); };
  file.space("A102", "K\\X2\\00FC\\X0\\che", body(0));
  file.space("Hall", "", body(5000));
  file.space("Attic", "Attic", body(10000));
  file.element("IFCSLAB", "slab", file.box({Point(0, 0, -200), Point(14000, 3000, 0)}, IfcWay::upward));
  const Scene scene = read_scene(write("rooms.ifc", file.text()));
  ASSERT_EQ(scene.rooms.size(), 3U);
  EXPECT_EQ(scene.rooms[0].name, "A102 K\u00fcche");
  EXPECT_EQ(scene.rooms[1].name, "Hall");
  EXPECT_EQ(scene.rooms[2].name, "Attic");
  for (const NamedRoom& room : scene.rooms) {
    EXPECT_EQ(room.storey, "Level 1");
    double volume = 0;
    for (const std::vector<Point>& face : room.faces) volume += face[0].dot(face[1].cross(face[2])) / 6;
    EXPECT_NEAR(volume, 4 * 3 * 2.5, 1e-5);
  }
  EXPECT_EQ(scene.polygons.size(), 6U);
}

// A style of the body, a style of the material, and none, which gives the same gray as in other formats.
TEST_F(Ifc, StylesOfBodiesAndMaterialsAreFound) {
  IfcFile file;
  const auto body = [&](double y) { return file.box(wall_at(y), IfcWay::upward); };
  const std::string painted = body(0);
  file.paint(painted, file.style("paint", "0.7,0.6,0.5", "0."));
  file.element("IFCWALL", "painted", painted);
  file.make_of(file.element("IFCWALL", "made", body(1000)), file.style("brick", "0.4,0.3,0.2", "0."));
  file.element("IFCWALL", "bare", body(2000));
  const std::string glass = file.box({Point(0, 3000, 0), Point(1000, 3010, 1000)}, IfcWay::upward);
  file.paint(glass, file.style("glass", "0.1,0.1,0.1", "0.9"));
  file.element("IFCWINDOW", "window", glass);
  const Scene scene = read_scene(write("styles.ifc", file.text()));
  std::map<std::string, Material> materials;
  for (const Material& material : scene.materials) materials[material.name] = material;
  ASSERT_EQ(materials.size(), 5U) << "of the pane, which is a solid, one side counts";
  EXPECT_TRUE((materials.at("glass (second face)").transmittance == 1).all());
  EXPECT_TRUE((materials.at("paint").reflectance - rgb(0.7, 0.6, 0.5)).abs().maxCoeff() < 1e-12);
  EXPECT_TRUE((materials.at("brick").reflectance - rgb(0.4, 0.3, 0.2)).abs().maxCoeff() < 1e-12);
  EXPECT_TRUE((materials.at("default").reflectance == 0.5).all());
  EXPECT_TRUE((materials.at("glass").transmittance - 0.9).abs().maxCoeff() < 1e-12);
  EXPECT_EQ(materials.at("paint").transmittance.size(), 0);
}

// True north is 30 degrees from y towards x. A sun in the south at 45 degrees shines from there. A rotated model
// rotates its north, and a scene file may override it.
TEST_F(Ifc, AzimuthsAreFromTrueNorth) {
  IfcFile file("IFC4", "IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)", "(1.,1.7320508075688772)");
  file.element("IFCSLAB", "slab", file.box({Point(1, 2, 3), Point(9, 8, 4)}, IfcWay::brep));
  const std::filesystem::path written = write("slab.ifc", file.text());
  ReadOptions options;
  options.daylight.sun = DaylightSetting::SunPlace{.altitude = 45, .azimuth = 180};
  options.daylight.sun_illuminance = 80'000;
  const Vector to_sun(-std::sqrt(0.125), -std::sqrt(0.375), std::sqrt(0.5));
  EXPECT_LT((read_scene(written, options).sun.value().direction - to_sun).norm(), 1e-6);
  const Scene plain = read_scene(written);
  EXPECT_LT((plain.north - Vector(0.5, std::sqrt(0.75), 0)).norm(), 1e-9);
  EXPECT_TRUE(has(plain.diagnostics, DiagnosticCode::north_of_file));
  ;
  const std::string model = "[[model]]\nfile = \"slab.ifc\"\n";
  const Scene turned = read_scene(write("turned.toml", model + "rotate = {axis = \"z\", degrees = 30}\n"));
  EXPECT_LT((turned.north - Vector::UnitY()).norm(), 1e-9);
  EXPECT_EQ(read_scene(write("stated.toml", "north = [1, 0, 0]\n" + model)).north, Vector::UnitX());
}

TEST_F(Ifc, ElementsWithoutFacesAreNamed) {
  IfcFile file;
  file.element("IFCSLAB", "slab", file.box(wall_at(0), IfcWay::upward));
  file.element("IFCWALL", "no such body", "#9999");
  const Scene scene = read_scene(write("missing.ifc", file.text()));
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 1U);
}

// Text that is not IFC, parts of a file and changed bytes give a scene or one sentence that names the file.
TEST_F(Ifc, DamagedFilesAreReadOrRefused) {
  IfcFile file;
  const std::string wall = file.element("IFCWALL", "wall", file.box(wall_at(0), IfcWay::brep));
  file.cut(wall, file.box(opening_at(0, 1000, 500, 1000, 2000, 0), IfcWay::across));
  const std::string good = file.text();
  std::vector<std::string> texts = {"x", std::string(100, '\0'), "ISO-10303-21;", good.substr(0, good.size() / 2)};
  std::mt19937 random(1);
  for (int k = 0; k < 8; ++k) {
    texts.push_back(good);
    for (int change = 0; change < 10; ++change) texts.back()[random() % good.size()] = static_cast<char>(random());
  }
  for (const std::string& text : texts) {
    const std::filesystem::path written = write("damaged.ifc", text);
    try {
      read_scene(written);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(written.string() + ": ", 0), 0U) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
  EXPECT_NE(refusal(write("damaged.ifc", "x")).find("damaged.ifc: "), std::string::npos);
}

TEST_F(Ifc, WithoutNodeTheRemedyIsNamed) {
  const std::filesystem::path written = write("slab.ifc", IfcFile().text());
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder_.c_str(), 1);
  const std::string message = refusal(written);
  setenv("PATH", path.c_str(), 1);
  for (const char* word : {"Node.js", "scripts/install_packages.sh"})
    EXPECT_NE(message.find(word), std::string::npos) << message;
}

}  // namespace
}  // namespace patchlight::ifc_test
