#include "patchlight/input/read_scene.h"

#include "model_files.h"

#include <numbers>

namespace patchlight::hbjson_test {
namespace {

// A quadrilateral in honeybee's format, followed by more keys.
std::string face(const std::string& type, const std::string& name, const std::string& corners,
                 const std::string& more) {
  return R"({"type": ")" + type + R"(", "identifier": ")" + name + R"(", "geometry": {"type": "Face3D", "boundary": )" +
         corners + "}" + more + "}";
}

std::string modifier(const std::string& name) {
  return R"(, "properties": {"radiance": {"modifier": ")" + name + R"("}})";
}

const std::string outdoors = R"(, "boundary_condition": {"type": "Outdoors"})";

// A room of 4 m x 3 m x 3 m in cm, with one wall only. The wall at y = 0 has a window of 2 m x 1 m.
std::string room(const std::string& floor_modifier) {
  const std::string window =
      face("Aperture", "window", "[[100,0,100],[300,0,100],[300,0,200],[100,0,200]]", outdoors + modifier("clear"));
  return R"({"type": "Model", "units": "Centimeters", "rooms": [{"type": "Room", "identifier": "office_1",
    "display_name": "Office", "story": "Ground", "faces": [)" +
         face("Face", "floor", "[[0,0,0],[400,0,0],[400,300,0],[0,300,0]]",
              R"(, "face_type": "Floor")" + outdoors + floor_modifier) +
         "," +
         face("Face", "wall", "[[0,0,0],[0,0,300],[400,0,300],[400,0,0]]",
              R"(, "face_type": "Wall", "apertures": [)" + window + "]" + outdoors) +
         "," +
         face("Face", "open", "[[0,300,0],[400,300,0],[400,300,300],[0,300,300]]",
              R"(, "face_type": "AirBoundary")" + outdoors) +
         R"(], "indoor_shades": [)" + face("Shade", "desk", "[[0,0,70],[100,0,70],[100,60,70],[0,60,70]]", "") +
         R"(]}], "properties": {"radiance": {"modifiers": [
    {"type": "Glass", "identifier": "clear", "r_transmissivity": 0.9, "g_transmissivity": 0.8, "b_transmissivity": 0.7},
    {"type": "Mirror", "identifier": "mirror", "r_reflectance": 0.9, "g_reflectance": 0.9, "b_reflectance": 0.9},
    {"type": "Glow", "identifier": "glow", "r_emittance": 3, "g_emittance": 2, "b_emittance": 1},
    {"type": "Trans", "identifier": "paper", "r_reflectance": 0.8, "g_reflectance": 0.8, "b_reflectance": 0.8,
     "transmitted_diff": 0.25},
    {"type": "BSDF", "identifier": "blind"}],
    "sensor_grids": [{"identifier": "desks", "sensors": [{"pos": [50, 30, 80], "dir": [0, 0, 2]}]}],
    "views": [{"identifier": "door", "position": [200, 290, 160], "direction": [0, -1, 0], "v_size": 70}]}}})";
}

class Honeybee : public ModelFiles {
 protected:
  Scene with(const std::string& floor_modifier) const {
    return read_scene(write("room.hbjson", room(floor_modifier)),
                      {.settings = {parse_material_setting("*.exitance=1")}});
  }
};

double area_of(const Scene& scene, PolygonIndex p) { return area_vector(corner_points(scene, p)).norm(); }

const Material& material_of(const Scene& scene, const std::string& object) {
  for (const Polygon& polygon : scene.polygons) {
    if (scene.groups[polygon.group] == object) return scene.materials[polygon.material];
  }
  throw std::runtime_error("no " + object);
}

TEST_F(Honeybee, RoomsHaveFacesOpeningsAndShadesInMetres) {
  const Scene scene = with("");
  ASSERT_EQ(scene.polygons.size(), 4U);  // an air boundary is a hole
  EXPECT_NEAR(area_of(scene, 0), 0.6, 1e-12);
  EXPECT_NEAR(area_of(scene, 1), 12, 1e-12);
  EXPECT_NEAR(area_of(scene, 2), 12 - 2, 1e-12);
  EXPECT_NEAR(area_of(scene, 3), 2, 1e-12);
  ASSERT_EQ(scene.rooms.size(), 1U);
  EXPECT_EQ(scene.rooms[0].name, "Office");
  EXPECT_EQ(scene.rooms[0].storey, "Ground");
  EXPECT_TRUE(scene.up_stated);
}

TEST_F(Honeybee, SensorsAndViewsComeAlong) {
  const Scene scene = with("");
  ASSERT_EQ(scene.sensors.size(), 1U);
  EXPECT_TRUE(scene.sensors[0].sensors[0].point.isApprox(Point(0.5, 0.3, 0.8)));
  EXPECT_EQ(scene.sensors[0].sensors[0].normal, Vector(0, 0, 1));
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_TRUE(scene.cameras[0].eye.isApprox(Point(2, 2.9, 1.6)));
  EXPECT_EQ(scene.cameras[0].vertical_field_of_view, 70);
}

// Glass of transmissivity t transmits t (1 - r)^2 / (1 - r^2 t^2), with r = (0.52 / 2.52)^2.
TEST_F(Honeybee, ModifiersBecomeMaterials) {
  const Scene glass = with("");
  const double r = std::pow(0.52 / 2.52, 2);
  EXPECT_NEAR(material_of(glass, "window").transmittance[1], 0.8 * std::pow(1 - r, 2) / (1 - std::pow(0.8 * r, 2)),
              1e-12);
  EXPECT_EQ(material_of(glass, "floor").reflectance[0], 0.2);
  EXPECT_EQ(material_of(with(modifier("mirror")), "floor").specular_reflectance[0], 0.9);
  const Material paper = material_of(with(modifier("paper")), "floor");
  EXPECT_NEAR(paper.reflectance[0], 0.6, 1e-12);
  EXPECT_NEAR(paper.diffuse_transmittance[0], 0.2, 1e-12);
  const Scene glow = read_scene(write("glow.hbjson", room(modifier("glow"))));
  EXPECT_NEAR(material_of(glow, "floor").exitance[1], 2 * std::numbers::pi, 1e-12);
}

// Faces outdoors have the exterior modifier of their room's set. Null counts as absent.
TEST_F(Honeybee, ModifierSetsAreThoseOfRooms) {
  std::string text = room("");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace(R"("display_name": "Office")",
          R"("display_name": null, "properties": {"radiance": {"modifier_set": "dark"}})");
  replace(R"("modifiers": [)", R"("modifier_sets": [{"identifier": "dark", "wall_set": {"exterior_modifier": "outer",
    "interior_modifier": "inner"}, "floor_set": {"exterior_modifier": null, "interior_modifier": "inner"}}],
    "modifiers": [{"type": "Plastic", "identifier": "outer", "r_reflectance": 0.1},
    {"type": "Plastic", "identifier": "inner", "r_reflectance": 0.3},)");
  const auto at_wall = [](const Scene& scene) { return material_of(scene, "wall").reflectance[0]; };
  const Scene outside = read_scene(write("set.hbjson", text));
  EXPECT_EQ(outside.rooms[0].name, "office_1");
  EXPECT_EQ(at_wall(outside), 0.1);
  EXPECT_EQ(material_of(outside, "floor").reflectance[0], 0.2);
  replace(R"("face_type": "Wall", "apertures": [)", R"("face_type": "Wall", "apertures": [)");
  const std::size_t wall = text.rfind(outdoors, text.find("AirBoundary"));
  text.replace(text.rfind(outdoors, wall), outdoors.size(), R"(, "boundary_condition": {"type": "Ground"})");
  EXPECT_EQ(at_wall(read_scene(write("set.hbjson", text))), 0.3);
}

TEST_F(Honeybee, WhatCannotBeCarriedIsNamed) {
  const Scene scene = with(modifier("blind"));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material, {"blind"}));
  EXPECT_EQ(material_of(scene, "floor").reflectance[0], 0.2);
}

TEST_F(Honeybee, DamagedFilesAreRefused) {
  const std::string good = room("");
  for (std::size_t size = 0; size < good.size() - 1; size += 97) {
    const auto file = write("cut.hbjson", size == 0 ? "{" : good.substr(0, size));
    EXPECT_THROW(read_scene(file), InputError) << size;
  }
  for (const char* const text : {"[]", "3", "{\"units\": \"Miles\"}", "{\"units\": 3}", "{\"rooms\": [{}]}",
                                 "{\"rooms\": [{\"identifier\": \"a\", \"faces\": [{}]}]}"}) {
    EXPECT_THROW(read_scene(write("bad.hbjson", text)), InputError) << text;
  }
}

}  // namespace
}  // namespace patchlight::hbjson_test
