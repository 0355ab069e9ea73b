#include "patchlight/input/read_scene.h"

#include "model_files.h"

#include <cmath>

namespace patchlight::scene_file_test {
namespace {

constexpr const char* room_obj =
    "mtllib room.mtl\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 1 1 2.5\nv 1 2 2.5\nv 2 2 2.5\nv 2 1 2.5\n"
    "o floor\nusemtl wall.low\nf 1 2 3 4\no lamp\nusemtl lamp\nf 5 6 7 8\n";
constexpr const char* room_mtl = "newmtl wall.low\nKd 0.1 0.2 0.3\nnewmtl lamp\nKd 0 0 0\nKe 1 2 3\n";

class SceneFile : public ModelFiles {
 protected:
  SceneFile() {
    write("room.obj", room_obj);
    write("room.mtl", room_mtl);
  }
  Scene read(const std::string& toml) const { return read_scene(write("scene.toml", toml)); }
  std::string refused(const std::string& toml, const ReadOptions& options = {}) const {
    return refusal(write("scene.toml", toml), options);
  }
  // All of these must be in the message.
  void expect_refused(const std::string& toml, const std::vector<std::string>& parts) const {
    const std::string message = refused(toml);
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  }
};

constexpr const char* room = "[[model]]\nfile = \"room.obj\"\n";

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v) EXPECT_EQ(a.vertices[v], b.vertices[v]);
  ASSERT_EQ(a.polygons.size(), b.polygons.size());
  for (std::size_t p = 0; p < a.polygons.size(); ++p) {
    EXPECT_EQ(a.polygons[p].corners, b.polygons[p].corners);
    EXPECT_EQ(a.polygons[p].material, b.polygons[p].material);
    EXPECT_EQ(place_of(a, a.polygons[p]), place_of(b, b.polygons[p]));
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t m = 0; m < a.materials.size(); ++m) {
    EXPECT_EQ(a.materials[m].name, b.materials[m].name);
    EXPECT_TRUE((a.materials[m].reflectance == b.materials[m].reflectance).all());
    EXPECT_TRUE((a.materials[m].exitance == b.materials[m].exitance).all());
  }
  EXPECT_EQ(a.up, b.up);
}

TEST_F(SceneFile, IsTheSceneThatTheOptionsMake) {
  ReadOptions options;
  options.metres_per_unit = 0.0254;
  options.up = Vector::UnitY();
  options.settings = {parse_material_setting("wall.low.reflectance=0.7"),
                      parse_material_setting("lamp.radiance=17,12,4")};
  const Scene by_file = read(
      "up = \"y\"\n[[model]]\nfile = \"room.obj\"\nunit = \"in\"\n[[material]]\nname = \"wall.low\"\n"
      "reflectance = 0.7\n[[material]]\nname = \"lamp\"\nradiance = [17, 12, 4]\n");
  expect_same(by_file, read_scene(folder_ / "room.obj", options));
}

TEST_F(SceneFile, OfTwoModelsIsTheSceneOfBoth) {
  write("lamp.obj", "mtllib room.mtl\nv 0 0 9\nv 0 1 9\nv 1 1 9\nusemtl lamp\nf 1 2 3\n");
  const std::vector<std::filesystem::path> files = {folder_ / "room.obj", folder_ / "lamp.obj"};
  expect_same(read(std::string(room) + "[[model]]\nfile = \"lamp.obj\"\n"), read_scene(files));
}

TEST_F(SceneFile, OptionsOverruleIt) {
  const auto file =
      write("scene.toml", "up = \"y\"\n" + std::string(room) + "[[material]]\nname=\"lamp\"\nexitance=5\n");
  ReadOptions options;
  options.up = Vector::UnitZ();
  options.settings = {parse_material_setting("lamp.exitance=6")};
  const Scene scene = read_scene(file, options);
  EXPECT_EQ(scene.up, Vector(0, 0, 1));
  EXPECT_EQ(scene.materials[1].exitance[0], 6);
}

TEST_F(SceneFile, PatternsNameMaterials) {
  const Scene scene = read(std::string(room) +
                           "[[material]]\nname = \"*\"\nreflectance = 0.4\n[[material]]\nname = \"l?m*\"\n"
                           "reflectance = [0.1, 0.2, 0.3]\n");
  EXPECT_TRUE((scene.materials[0].reflectance == 0.4).all());
  EXPECT_TRUE((scene.materials[1].reflectance == rgb(0.1, 0.2, 0.3)).all());
}

TEST_F(SceneFile, MaterialsHaveAnIndexOfRefraction) {
  const Scene scene = read(std::string(room) + "[[material]]\nname = \"lamp\"\ntransmittance = 0.8\nindex = 1.6\n");
  EXPECT_EQ(scene.materials[0].index, usual_index);
  EXPECT_EQ(scene.materials[1].index, 1.6);
  EXPECT_TRUE((scene.materials[1].transmittance == 0.8).all());
}

TEST_F(SceneFile, MaterialsMayBeTranslucent) {
  const Scene scene = read(std::string(room) +
                           "[[material]]\nname = \"lamp\"\nreflectance = 0.3\ndiffuse_transmittance = [0.5, 0.4, 0]\n");
  EXPECT_EQ(scene.materials[0].diffuse_transmittance.size(), 0);
  EXPECT_TRUE((scene.materials[1].diffuse_transmittance == rgb(0.5, 0.4, 0)).all());
}

// First the model's own unit and up axis, then scale, rotation and translation: (4, 0, 0) in the file.
TEST_F(SceneFile, TransformsInTheStatedOrder) {
  const auto corner = [&](const std::string& keys) { return Point(read(room + keys).vertices[1]); };
  EXPECT_EQ(corner("translate = [1, 2, 3]\n"), Point(5, 2, 3));
  EXPECT_EQ(corner("scale = 2\ntranslate = [1, 2, 3]\n"), Point(9, 2, 3));
  EXPECT_EQ(corner("rotate = {axis = \"z\", degrees = 90}\n"), Point(0, 4, 0));
  EXPECT_EQ(corner("rotate = {axis = \"z\", degrees = 90}\nscale = [2, 3, 1]\n"), Point(0, 8, 0));
  EXPECT_EQ(corner("rotate = [{axis = \"z\", degrees = 90}, {axis = [5, 0, 0], degrees = -270}]\n"), Point(0, 0, 4));
  EXPECT_EQ(corner("matrix = [[0, 1, 0, 7], [1, 0, 0, 8], [0, 0, 1, 9]]\n"), Point(7, 12, 9));
  EXPECT_EQ(corner("unit = \"mm\"\ntranslate = [1, 0, 0]\n"), Point(1.004, 0, 0));
  // Rounding of a cosine and three products: 1e-15 of 4 m.
  const Point turned = corner("rotate = {axis = [1, 1, 1], degrees = 120}\n");
  EXPECT_LT((turned - Point(0, 4, 0)).norm(), 1e-14);
}

TEST_F(SceneFile, TurnsModelsWithAnotherUprightAxis) {
  // (x, y up, z) becomes (x, -z, y): the lamp at z = 2.5 comes to y = -2.5.
  const Scene scene = read(std::string(room) + "up = \"y\"\n");
  EXPECT_EQ(scene.vertices[4], Point(1, -2.5, 1));
  const Scene back = read("up = \"y\"\n" + std::string(room) + "up = \"z\"\n");
  EXPECT_EQ(back.vertices[4], Point(1, 2.5, -1));
}

// If det < 0, the order of corners is reversed. So the lamp still shines against the image of its old normal.
TEST_F(SceneFile, MirroredModelsKeepTheirFronts) {
  const Scene straight = read(room);
  const Scene mirrored = read(std::string(room) + "scale = [-1, 1, 1]\n");
  for (PolygonIndex p = 0; p < 2; ++p) EXPECT_EQ(front_normal(straight, p), front_normal(mirrored, p));
  EXPECT_EQ(mirrored.vertices[1], Point(-4, 0, 0));
}

TEST_F(SceneFile, LengthsHaveTheUnitOfTheFile) {
  const Scene scene = read("unit = \"cm\"\n" + std::string(room) +
                           "translate = [100, 0, 0]\n[[camera]]\neye = [100, 200, 300]\ntarget = [0, 0, 0]\n"
                           "[[sensors]]\npoints = [[100, 0, 50, 0, 0, 2]]\n");
  EXPECT_EQ(scene.vertices[1], Point(5, 0, 0));
  EXPECT_EQ(scene.cameras.at(0).eye, Point(1, 2, 3));
  EXPECT_EQ(scene.sensors.at(0).sensors.at(0).point, Point(1, 0, 0.5));
  EXPECT_EQ(scene.sensors.at(0).sensors.at(0).normal, Vector(0, 0, 1));
  EXPECT_EQ(scene.metres_per_unit, 1);
}

TEST_F(SceneFile, SensorsKnowTheirLines) {
  write("desk.pts", "# Radiance\n1 2 0.8 0 0 1\n\n1.5,2,0.8,0,0,1 # second\n");
  const Scene scene = read(std::string(room) +
                           "[[sensors]]\nname = \"desk\"\nfile = \"desk.pts\"\n[[sensors]]\npoints = [\n"
                           "  [0, 0, 1, 0, 0, 1],\n  [0, 1, 1, 0, 0, 1]]\n");
  ASSERT_EQ(scene.sensors.size(), 2U);
  const std::string folder = folder_.string();
  EXPECT_EQ(place_of(scene.sensors[0], 1), "sensor 2 of 'desk' (" + folder + "/desk.pts:4)");
  EXPECT_EQ(place_of(scene.sensors[1], 1), "sensor 2 of 'sensors 2' (" + folder + "/scene.toml:9)");
}

TEST_F(SceneFile, GridsCoverRectanglesAndFloors) {
  const Scene scene =
      read(std::string(room) +
           "[[sensors]]\nname = \"wall\"\ncorner = [0, 0, 0]\nedges = [[0, 0, 2], [0, 1, 0]]\n"
           "spacing = 0.5\n[[sensors]]\nname = \"floor\"\nfloor = \"fl*r\"\nheight = 0.8\nspacing = 1\n");
  ASSERT_EQ(scene.sensors.size(), 2U);
  ASSERT_EQ(scene.sensors[0].sensors.size(), 8U);  // 2 m / 0.5 m by 1 m / 0.5 m
  EXPECT_EQ(scene.sensors[0].sensors[0].point, Point(0, 0.25, 0.25));
  EXPECT_EQ(scene.sensors[0].sensors[0].normal, Vector(-1, 0, 0));  // z x y
  ASSERT_EQ(scene.sensors[1].sensors.size(), 12U);                  // 4 m x 3 m
  EXPECT_EQ(scene.sensors[1].sensors[0].point, Point(0.5, 0.5, 0.8));
  EXPECT_EQ(scene.sensors[1].sensors[0].normal, Vector(0, 0, 1));
}

TEST_F(SceneFile, UnknownKeysAreRefusedWithLineAndNearMatch) {
  expect_refused("units = \"m\"\n" + std::string(room), {"scene.toml:1: ", "'units'", " 'unit'?"});
  expect_refused(std::string(room) + "[[material]]\nname = \"lamp\"\nrefletance = 0.3\n",
                 {"scene.toml:5: ", "'refletance'", "of material", " 'reflectance'?"});
  expect_refused(std::string(room) + "rotate = {axis = \"z\", angle = 3}\n",
                 {"scene.toml:3: ", "'angle'", "of model.rotate", "axis, degrees"});
  expect_refused(std::string(room) + "[[sensor]]\n", {"scene.toml:3: ", " 'sensors'?"});
}

TEST_F(SceneFile, WrongValuesAreRefusedWithLineAndKey) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"unit = \"feet\"\n", {"scene.toml:3: model.unit: found 'feet'", "'ft'"}},
      {"scale = 0\n", {"scene.toml:3: model.scale: found 0", "above 0"}},
      {"scale = [1, 0, 1]\n", {"scene.toml:3: model.scale"}},
      {"translate = [1, 2]\n", {"scene.toml:3: model.translate: found a list of 2 values", "[x, y, z]"}},
      {"translate = [1, \"a\", 2]\n", {"scene.toml:3: model.translate: found 'a'"}},
      {"translate = [1, inf, 2]\n", {"scene.toml:3: model.translate: found inf"}},
      {"matrix = [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]\n", {"scene.toml:3: model.matrix", "inverted"}},
      {"matrix = [[1,0,0,0],[0,1,0,0],[0,0,1,0]]\nscale = 2\n", {"scene.toml:3: ", "exclude each other"}},
      {"rotate = {axis = \"w\", degrees = 1}\n", {"scene.toml:3: model.rotate.axis: found 'w'"}},
      {"rotate = {axis = \"x\"}\n", {"scene.toml:3: model.rotate: found no key 'degrees'"}},
      {"[[material]]\nname = \"lamp\"\nreflectance = 1.5\n",
       {"scene.toml:5: material.reflectance: found 1.5", "0 to 1"}},
      {"[[material]]\nname = \"lamp\"\nreflectance = [1, 2]\n", {"scene.toml:5: ", "a list of 2 values"}},
      {"[[material]]\nname = \"lamp\"\nexitance = -1\n", {"scene.toml:5: material.exitance: found -1"}},
      {"[[material]]\nname = \"lamp\"\nindex = 0.9\n", {"scene.toml:5: material.index: found 0.9", "1 or more"}},
      {"[[material]]\nname = \"lamp\"\nindex = [1.5, 1.5, 1.6]\n", {"scene.toml:5: material.index: ", "one number"}},
      {"[[material]]\nname = \"lump\"\nexitance = 1\n", {"scene.toml:4: ", "'lump'", "did you mean 'lamp'?"}},
      {"[[material]]\nname = \"lamp\"\n", {"scene.toml:3: ", "changes nothing"}},
      {"[[material]]\nname = \"lamp\"\nexitance = 1\nradiance = 1\n", {"scene.toml:3: ", "exitance, radiance"}},
      {"[[sensors]]\n", {"scene.toml:3: sensors: found none of them", "points, file, corner, floor"}},
      {"[[sensors]]\npoints = []\n", {"scene.toml:4: sensors.points: found a list of 0 values"}},
      {"[[sensors]]\npoints = [[0, 0, 0, 0, 0, 0]]\n", {"scene.toml:4: sensors.points", "not 0, 0, 0"}},
      {"[[sensors]]\nfile = \"no.pts\"\n", {"no.pts: the file of points does not exist"}},
      {"[[sensors]]\nfloor = \"flor\"\nheight = 1\nspacing = 1\n", {"scene.toml:4: ", "did you mean 'floor'?"}},
      {"[[sensors]]\nfloor = \"floor\"\nheight = 1\nspacing = 1e-6\n", {"scene.toml:4: sensors.spacing", "1000000"}},
      {"[[sensors]]\nfloor = \"floor\"\nspacing = 1\n", {"scene.toml:3: sensors: found no key 'height'"}},
      {"[[sensors]]\nfile = \"a\"\nspacing = 1\n", {"scene.toml:5: sensors.spacing", "'file'"}},
      {"[[sensors]]\ncorner = [0,0,0]\nedges = [[1,0,0],[2,0,0]]\nspacing = 1\n", {"scene.toml:5: sensors.edges"}},
      {"[[sensors]]\nname=\"a\"\npoints=[[0,0,0,0,0,1]]\n[[sensors]]\nname=\"a\"\npoints=[[0,0,0,0,0,1]]\n",
       {"scene.toml:7: sensors.name: found 'a'"}},
      {"[[camera]]\neye = [0, 0, 0]\ntarget = [0, 0, 0]\n", {"scene.toml:5: camera.target"}},
      {"[[camera]]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nfield_of_view = 180\n",
       {"scene.toml:6: camera.field_of_view"}},
      {"[camera]\neye = [0, 0, 0]\n", {"scene.toml:3: camera: found a table", "[[camera]]"}},
      {"[[model]]\nfile = \"none.obj\"\n", {"scene.toml:4: ", "none.obj", "does not exist"}},
      {"[[model]]\nfile = \"scene.toml\"\n", {"scene.toml:4: ", "cannot name another"}},
      {"[[model]]\nfile = 3\n", {"scene.toml:4: model.file: found 3", "name of a file"}},
      {"[[model]]\n", {"scene.toml:3: model: found no key 'file'"}},
      {"file = \"twice\"\n", {"scene.toml:3: is not TOML"}},
      {"unit = \"\"\"a\nb\"\"\"\n", {"scene.toml:3: model.unit: found 'a b'"}},
  };
  for (const auto& [keys, parts] : cases) {
    SCOPED_TRACE(keys);
    expect_refused(room + keys, parts);
  }
}

// The same where the parser quotes the faulty text.
TEST_F(SceneFile, IsRefusedOnOneLine) {
  const std::string message = refused(std::string(room) + "truth = t\n\"m\"\n");
  EXPECT_NE(message.find("is not TOML"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST_F(SceneFile, WithoutModelIsRefused) {
  expect_refused("unit = \"m\"\n", {"scene.toml: ", "[[model]]"});
  EXPECT_NE(refusal(write("empty.toml", "")).find("is empty"), std::string::npos);
}

TEST_F(SceneFile, UnitOptionIsRefused) {
  ReadOptions options;
  options.metres_per_unit = 0.01;
  EXPECT_NE(refused(room, options).find("read.metres_per_unit"), std::string::npos);
}

}  // namespace
}  // namespace patchlight::scene_file_test
