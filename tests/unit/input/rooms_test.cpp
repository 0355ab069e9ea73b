#include "patchlight/input/read_scene.h"

#include "input/toml/new_scene_file.h"
#include "model_files.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"

#include <numbers>
#include <utility>

namespace patchlight::rooms_test {
namespace {

// A slab of 10 m x 3 m and a roof, in mm, and two spaces of 4 m x 3 m x 2.5 m between them: Living at the origin and
// Kitchen at x = 5 m.
std::string house() {
  std::string text =
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
      "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
      "#1=IFCCARTESIANPOINT((0.,0.,0.));\n#2=IFCAXIS2PLACEMENT3D(#1,$,$);\n#3=IFCLOCALPLACEMENT($,#2);\n"
      "#4=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#2,$);\n#5=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);\n"
      "#6=IFCUNITASSIGNMENT((#5));\n#7=IFCPROJECT('project',#21,'p',$,$,$,$,(#4),#6);\n"
      "#8=IFCSITE('site',#21,'s',$,$,#3,$,$,.ELEMENT.,$,$,$,$,$);\n#9=IFCRELAGGREGATES('a',#21,$,$,#7,(#8));\n"
      "#15=IFCDIRECTION((0.,0.,1.));\n#21=IFCOWNERHISTORY(#22,#25,$,.ADDED.,$,$,$,0);\n"
      "#22=IFCPERSONANDORGANIZATION(#23,#24,$);\n#23=IFCPERSON($,'','',$,$,$,$,$);\n"
      "#24=IFCORGANIZATION($,'',$,$,$);\n#25=IFCAPPLICATION(#24,'1','t','t');\n"
      "#30=IFCBUILDINGSTOREY('1xS3BCk291UvhgP2dvNMKI',#21,'Level 1',$,$,#3,$,$,.ELEMENT.,0.);\n"
      "#31=IFCRELAGGREGATES('b',#21,$,$,#8,(#30));\n#32=IFCRELAGGREGATES('d',#21,$,$,#30,(#140,#240));\n"
      "#33=IFCRELCONTAINEDINSPATIALSTRUCTURE('c',#21,$,$,(#340,#440),#30);\n";
  const auto box = [&](int id, double x, double z, double length, double height, const std::string& product) {
    const auto n = [id](int k) { return "#" + std::to_string(id + k); };
    text += n(1) + "=IFCCARTESIANPOINT((" + std::to_string(x) + ",0.," + std::to_string(z) + "));\n" + n(2) +
            "=IFCAXIS2PLACEMENT3D(" + n(1) + ",$,$);\n" + n(3) + "=IFCRECTANGLEPROFILEDEF(.AREA.,$," + n(4) + "," +
            std::to_string(length) + ",3000.);\n" + n(4) + "=IFCAXIS2PLACEMENT2D(" + n(5) + ",$);\n" + n(5) +
            "=IFCCARTESIANPOINT((" + std::to_string(length / 2) + ",1500.));\n" + n(6) + "=IFCEXTRUDEDAREASOLID(" +
            n(3) + "," + n(2) + ",#15," + std::to_string(height) + ");\n" + n(7) +
            "=IFCSHAPEREPRESENTATION(#4,'Body','SweptSolid',(" + n(6) + "));\n" + n(8) +
            "=IFCPRODUCTDEFINITIONSHAPE($,$,(" + n(7) + "));\n" + n(40) + "=" + product + "," + n(8) + ",$,$);\n";
  };
  const auto space = [](const std::string& identifier, const std::string& name) {
    return "IFCSPACE('" + identifier + "',#21,'" + name + "','',$,#3";
  };
  const auto closed = [&](int id, double x, const std::string& product) {
    box(id, x, 0, 4000, 2500, product);
    // A space has four more attributes than a slab.
    text.replace(text.rfind(",$,$);"), 6, ",'',.ELEMENT.,.INTERNAL.,$);");
  };
  closed(100, 0, space("0BTBFw6f90Nfh9rP1dlXr2", "Living"));
  closed(200, 5000, space("0BTBFw6f90Nfh9rP1dlXr3", "Kitchen"));
  box(300, 0, -200, 10000, 200, "IFCSLAB('2OBrcmyk58NupXoVOHUtxr',#21,'Floor','',$,#3");
  text.replace(text.rfind(",$,$);"), 6, ",$,.FLOOR.);");
  box(400, 0, 2500, 10000, 200, "IFCSLAB('2OBrcmyk58NupXoVOHUtxs',#21,'Roof','',$,#3");
  text.replace(text.rfind(",$,$);"), 6, ",$,.ROOF.);");
  return text + "ENDSEC;\nEND-ISO-10303-21;\n";
}

class Rooms : public ModelFiles {
 protected:
  Rooms() { write("house.ifc", house()); }

  // A new scene file for the house, with the contents of this scene.
  std::string new_text(const Scene& scene, const NewPlaces& places = {}) const {
    return new_scene_file(scene, new_light(scene), places, {folder_ / "house.ifc"}, {}, folder_ / "new.toml");
  }
};

TEST_F(Rooms, AreNamedByTheModelAndNoFacesOfIt) {
  const Scene scene = read_scene(folder_ / "house.ifc");
  ASSERT_EQ(scene.rooms.size(), 2U);
  EXPECT_EQ(scene.rooms[0].name, "Living");
  EXPECT_EQ(scene.rooms[1].name, "Kitchen");
  EXPECT_EQ(scene.rooms[1].storey, "Level 1");
  Box body;
  for (const auto& face : scene.rooms[1].faces)
    for (const Point& corner : face) body.extend(corner);
  EXPECT_TRUE(body.min().isApprox(Point(5, 0, 0), 1e-6) && body.max().isApprox(Point(9, 3, 2.5), 1e-6));
  EXPECT_EQ(scene.polygons.size(), 12U);
}

// Middles of 0.5 m cells over 4 m x 3 m, 0.5 m from the walls: 6 x 4 in each room, rotated and moved with the model.
TEST_F(Rooms, HaveAGridEach) {
  const Scene scene = read_scene(
      write("house.toml",
            "up = \"z\"\n[[model]]\nfile = \"house.ifc\"\nrotate = {axis = \"z\", degrees = 30}\n[[sensors]]\n"
            "name = \"desk\"\nroom = \"*\"\nheight = 0.8\nspacing = 0.5\n"));
  ASSERT_EQ(scene.sensors.size(), 2U);
  EXPECT_EQ(scene.sensors[0].name, "desk Living");
  EXPECT_EQ(scene.sensors[1].sensors.size(), 24U);
  for (const Sensor& sensor : scene.sensors[1].sensors) {
    const Point back = Eigen::AngleAxisd(-std::numbers::pi / 6, Vector::UnitZ()) * sensor.point;
    EXPECT_GT(back.x(), 5.5);
    EXPECT_LT(back.x(), 8.5);
    EXPECT_NEAR(back.z(), 0.8, 1e-6);
  }
}

// The rooms are 2.5 m high.
TEST_F(Rooms, HaveAWarningOfAGridOverTheirCeiling) {
  for (const auto& [height, warnings] : {std::pair{"0.8", 0}, {"2.4", 0}, {"80", 1}}) {
    const Scene scene = read_scene(write("house.toml", std::string("[[model]]\nfile = \"house.ifc\"\n[[sensors]]\n") +
                                                           "room = \"*\"\nspacing = 0.5\nheight = " + height + "\n"));
    EXPECT_EQ(test::count_of(scene.diagnostics, DiagnosticCode::doubtful_sensor), warnings) << height;
  }
}

TEST_F(Rooms, OfNoSuchNameAreRefusedWithANearOne) {
  const auto refused = [this](const std::string& room) {
    return refusal(write("house.toml", "[[model]]\nfile = \"house.ifc\"\n[[sensors]]\nroom = \"" + room +
                                           "\"\nheight = 0.8\nspacing = 0.5\n"));
  };
  EXPECT_NE(refused("Kitchne").find(" 'Kitchen'?"), std::string::npos);
}

// The scene file of `new` can be read again: the sky that the model needs, sensors and views.
TEST_F(Rooms, AreInANewSceneFile) {
  NewPlaces places;
  places.grid = FloorGrid{"work plane", {}, {"Living", "Kitchen"}, 0.8, {}, {}, {}, 0};
  places.cameras = {{Point(1, 1, 1.6), Point(3, 2, 1.3), 70, "Living"}};
  const Scene again = read_scene(write("new.toml", new_text(read_scene(folder_ / "house.ifc"), places)));
  EXPECT_TRUE(again.sky.has_value());
  ASSERT_EQ(again.sensors.size(), 2U);
  EXPECT_EQ(again.sensors[1].name, "work plane Kitchen");
  ASSERT_EQ(again.cameras.size(), 1U);
  EXPECT_EQ(again.cameras[0].name, "Living");
  EXPECT_EQ(again.cameras[0].eye, Point(1, 1, 1.6));
}

// A closed box surrounds both rooms. A lamp is over the middle of each floor, within half a cell of sqrt(12) / 10 m.
TEST_F(Rooms, ThatNoDaylightGetsIntoHaveALampEachInANewSceneFile) {
  const Scene house = read_scene(folder_ / "house.ifc");
  Scene box = test::with_box(test::empty_scene({test::grey(0.5)}), Point(0, 0, 0), Point(9, 3, 2.5), false);
  box.up = Vector::UnitZ();
  box.rooms = house.rooms;
  const Scene again = read_scene(write("new.toml", new_text(box)));
  EXPECT_FALSE(again.sky.has_value());
  ASSERT_EQ(again.luminaires.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const Point middle(k == 0 ? 2 : 7, 1.5, 1.8);
    EXPECT_LT((again.luminaires[k].position - middle).norm(), 0.25) << again.luminaires[k].position.transpose();
  }
}

// At most twelve rooms have one. The file lists the rooms without one, including a room that is too small.
TEST_F(Rooms, WithoutALampAreNamedInANewSceneFile) {
  const NamedRoom living = read_scene(folder_ / "house.ifc").rooms[0];
  Scene box = test::with_box(test::empty_scene({test::grey(0.5)}), Point(0, 0, 0), Point(9, 3, 2.5), false);
  box.up = Vector::UnitZ();
  for (int k = 0; k < 15; ++k) box.rooms.push_back({"room " + std::to_string(k), "", living.faces});
  for (std::vector<Point>& face : box.rooms[1].faces)
    for (Point& corner : face) corner.head<2>() *= 0.1;
  const std::string text = new_text(box);
  EXPECT_NE(text.find("\n# No lamp in: \"room 1\", \"room 13\", \"room 14\".\n"), std::string::npos) << text;
  EXPECT_EQ(read_scene(write("new.toml", text)).luminaires.size(), 12U);
  box.rooms.resize(1);
  EXPECT_EQ(new_text(box).find("No lamp in"), std::string::npos);
}

// A spire over a corner has no ceiling and is not over the middle of its box, so no position is found.
TEST_F(Rooms, HaveNoLampWhereNoPlaceIsFound) {
  Scene spire = test::empty_scene({test::grey(0.5)});
  spire.up = Vector::UnitZ();
  const Point a(0, 0, 0), b(0, 4, 0), c(4, 0, 0), top(0, 0, 3);
  for (const std::vector<Point>& face : {std::vector{a, c, b}, {a, b, top}, {a, top, c}, {b, c, top}})
    spire = test::with_polygon(std::move(spire), face);
  const std::string text = new_text(spire);
  for (const std::string line : {"# no place for it was found.\n# [[luminaire]]\n",
                                 "\n# name = \"lamp\"\n# kind = ", "\n# positions = [[X, Y, Z]]\n# lumens = 3000\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

// The scene file of a model in another unit can be read again.
TEST_F(Rooms, OfAModelInFeetAreInANewSceneFile) {
  const std::filesystem::path model =
      write("plate.obj", "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nusemtl floor\nf 1 2 3 4\n");
  for (const double unit : {0.3048, 0.0254, 0.01, 0.001, 1.0}) {
    const Scene scene = read_scene(model, {.metres_per_unit = unit, .up = Vector::UnitZ()});
    const Scene again =
        read_scene(write("new.toml", new_scene_file(scene, {}, {}, {model}, unit, folder_ / "new.toml")));
    EXPECT_NEAR(bounds(again).sizes().x(), 10 * unit, 1e-12);
  }
}

// The roof comes down to the floor, z = x up to the ridge at x = 2. There is no position at 0.8 m for x below 0.8.
TEST_F(Rooms, HaveNoSensorsAboveTheirRoofs) {
  const auto face = [](const std::string& name, const std::string& corners) {
    return R"({"type": "Face", "identifier": ")" + name +
           R"(", "face_type": "Wall", "boundary_condition": {"type": "Outdoors"}, "geometry": {"type": "Face3D", "boundary": )" +
           corners + "}}";
  };
  write("attic.hbjson",
        R"({"type": "Model", "units": "Meters", "rooms": [{"type": "Room", "identifier": "attic", "faces": [)" +
            face("floor", "[[0,0,0],[0,4,0],[4,4,0],[4,0,0]]") + "," +
            face("west", "[[0,0,0],[2,0,2],[2,4,2],[0,4,0]]") + "," +
            face("east", "[[4,4,0],[2,4,2],[2,0,2],[4,0,0]]") + "," + face("south", "[[0,0,0],[4,0,0],[2,0,2]]") + "," +
            face("north", "[[4,4,0],[0,4,0],[2,4,2]]") + R"(]}], "properties": {}})");
  const Scene scene =
      read_scene(write("attic.toml",
                       "[[model]]\nfile = \"attic.hbjson\"\n[[sensors]]\nname = \"desk\"\nroom = \"*\"\n"
                       "height = 0.8\nspacing = 0.5\nfrom_walls = 0.5\n"));
  ASSERT_EQ(scene.sensors.size(), 1U);
  EXPECT_EQ(scene.sensors[0].sensors.size(), scene.sensors[0].cells.size());
  EXPECT_GT(scene.sensors[0].sensors.size(), 20U);
  for (const Sensor& sensor : scene.sensors[0].sensors) {
    EXPECT_GT(sensor.point.x(), 0.8);
    EXPECT_LT(sensor.point.x(), 3.2);
  }
}

}  // namespace
}  // namespace patchlight::rooms_test
