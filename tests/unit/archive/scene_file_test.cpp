#include "archive/scene_file.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include "scene/photometric_web.h"
#include "support/meshes.h"
#include "support/scenes.h"
#include "unit/output/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tuple>

namespace patchlight::scene_file_test {
namespace {

namespace fs = std::filesystem;
using namespace test;

bool same(const Spectrum& a, const Spectrum& b) { return a.size() == b.size() && (a == b).all(); }

// The properties of a light as numbers.
struct Numbers {
  std::vector<double> operator()(const PointLight& light) const { return {light.intensity[0]}; }
  std::vector<double> operator()(const SpotLight& light) const {
    return {light.intensity[0], light.beam_half_angle, light.field_half_angle};
  }
  std::vector<double> operator()(const SphericalLamp& light) const { return {light.radius, light.exitance[0]}; }
  std::vector<double> operator()(const WebLight& light) const {
    const PhotometricWeb& web = *light.web;
    std::vector<double> all = {light.watts_per_lumen[0], static_cast<double>(web.type), web.lamp_lumens, web.watts};
    for (const auto* part : {&web.vertical, &web.horizontal, &web.candela, &web.tilt, &web.tilt_factor})
      all.insert(all.end(), part->begin(), part->end());
    all.insert(all.end(), web.opening.begin(), web.opening.end());
    return all;
  }
};

void expect_same_lights(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.north, b.north);
  EXPECT_EQ(a.photometric, b.photometric);
  ASSERT_EQ(a.luminaires.size(), b.luminaires.size());
  for (std::size_t k = 0; k < a.luminaires.size(); ++k) {
    const Luminaire& one = a.luminaires[k];
    const Luminaire& other = b.luminaires[k];
    EXPECT_EQ(std::tie(one.name, one.place, one.position, one.aim, one.zero_plane),
              std::tie(other.name, other.place, other.position, other.aim, other.zero_plane));
    ASSERT_EQ(one.light.index(), other.light.index());
    EXPECT_EQ(std::visit(Numbers(), one.light), std::visit(Numbers(), other.light));
  }
  ASSERT_EQ(a.sun.has_value(), b.sun.has_value());
  if (a.sun) {
    EXPECT_EQ(a.sun->direction, b.sun->direction);
    EXPECT_TRUE(same(a.sun->normal_irradiance, b.sun->normal_irradiance));
  }
  ASSERT_EQ(a.sky.has_value(), b.sky.has_value());
  if (a.sky) {
    EXPECT_EQ(std::tie(a.sky->kind, a.sky->sun_direction, a.sky->clearness, a.sky->brightness),
              std::tie(b.sky->kind, b.sky->sun_direction, b.sky->clearness, b.sky->brightness));
    EXPECT_TRUE(same(a.sky->horizontal_irradiance, b.sky->horizontal_irradiance));
    EXPECT_TRUE(same(a.sky->zenith_radiance, b.sky->zenith_radiance));
    EXPECT_TRUE(same(a.sky->ground_radiance, b.sky->ground_radiance));
  }
  ASSERT_EQ(a.sensors.size(), b.sensors.size());
  for (std::size_t g = 0; g < a.sensors.size(); ++g) {
    EXPECT_EQ(std::tie(a.sensors[g].name, a.sensors[g].cells, a.sensors[g].columns, a.sensors[g].lines),
              std::tie(b.sensors[g].name, b.sensors[g].cells, b.sensors[g].columns, b.sensors[g].lines));
    ASSERT_EQ(a.sensors[g].sensors.size(), b.sensors[g].sensors.size());
    for (std::size_t k = 0; k < a.sensors[g].sensors.size(); ++k)
      EXPECT_EQ(a.sensors[g].sensors[k].point, b.sensors[g].sensors[k].point);
  }
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (std::size_t k = 0; k < a.cameras.size(); ++k)
    EXPECT_EQ(std::tie(a.cameras[k].eye, a.cameras[k].target, a.cameras[k].name),
              std::tie(b.cameras[k].eye, b.cameras[k].target, b.cameras[k].name));
}

void expect_same(const Diagnostics& a, const Diagnostics& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_EQ(std::tie(a[k].code, a[k].text, a[k].count, a[k].area),
              std::tie(b[k].code, b[k].text, b[k].count, b[k].area));
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  ASSERT_EQ(a.polygons.size(), b.polygons.size());
  for (std::size_t p = 0; p < a.polygons.size(); ++p) {
    const auto& [corners, material, group, line, file, face, back_material, texture_map, back_texture_map] =
        a.polygons[p];
    const Polygon& other = b.polygons[p];
    EXPECT_EQ(corners, other.corners);
    EXPECT_EQ(std::tie(material, group, line), std::tie(other.material, other.group, other.line));
    EXPECT_EQ(std::tie(file, face, back_material), std::tie(other.file, other.face, other.back_material));
    EXPECT_EQ(std::tie(texture_map, back_texture_map), std::tie(other.texture_map, other.back_texture_map));
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t m = 0; m < a.materials.size(); ++m) {
    EXPECT_EQ(a.materials[m].name, b.materials[m].name);
    EXPECT_TRUE(same(a.materials[m].reflectance, b.materials[m].reflectance));
    EXPECT_TRUE(same(a.materials[m].exitance, b.materials[m].exitance));
    EXPECT_TRUE(same(a.materials[m].transmittance, b.materials[m].transmittance));
    EXPECT_TRUE(same(a.materials[m].specular_reflectance, b.materials[m].specular_reflectance));
    EXPECT_TRUE(same(a.materials[m].diffuse_transmittance, b.materials[m].diffuse_transmittance));
    EXPECT_EQ(a.materials[m].index, b.materials[m].index);
    EXPECT_EQ(a.materials[m].second_face, b.materials[m].second_face);
  }
  ASSERT_EQ(a.bands.size(), b.bands.size());
  for (std::size_t k = 0; k < a.bands.size(); ++k) {
    EXPECT_EQ(std::tie(a.bands[k].name, a.bands[k].luminous_weight, a.bands[k].rgb),
              std::tie(b.bands[k].name, b.bands[k].luminous_weight, b.bands[k].rgb));
  }
  ASSERT_EQ(a.lamp_hints.size(), b.lamp_hints.size());
  for (std::size_t h = 0; h < a.lamp_hints.size(); ++h) {
    EXPECT_EQ(a.lamp_hints[h].material, b.lamp_hints[h].material);
    EXPECT_EQ(a.lamp_hints[h].reason, b.lamp_hints[h].reason);
    EXPECT_TRUE(same(a.lamp_hints[h].radiance, b.lamp_hints[h].radiance));
  }
  expect_same_lights(a, b);
  EXPECT_EQ(std::tie(a.groups, a.file, a.files, a.sha256), std::tie(b.groups, b.file, b.files, b.sha256));
  EXPECT_EQ(std::tie(a.metres_per_unit, a.up, a.up_stated), std::tie(b.metres_per_unit, b.up, b.up_stated));
  expect_same(a.diagnostics, b.diagnostics);
}

void expect_same(const KeptSides& a, const KeptSides& b) {
  EXPECT_EQ(std::tie(a.front, a.back, a.emit_from_back), std::tie(b.front, b.back, b.emit_from_back));
  expect_same(a.notes, b.notes);
}

StoredScene through_a_file(const Scene& scene, const KeptSides& sides) {
  const TemporaryFolder folder;
  write_stored_scene(folder.path() / "scene.json", scene, sides);
  return read_stored_scene(folder.path());
}

class ShippedModel : public testing::TestWithParam<const char*> {};

TEST_P(ShippedModel, IsReadAsItWasWritten) {
  const Scene scene = read_scene(mesh_folder() / (std::string(GetParam()) + ".obj"), {.metres_per_unit = 0.3048});
  for (const Sides choice : {Sides::automatic, Sides::front, Sides::both}) {
    const KeptSides sides = kept_sides(scene, choice);
    const StoredScene stored = through_a_file(scene, sides);
    expect_same(stored.scene, scene);
    expect_same(stored.sides, sides);
  }
}

INSTANTIATE_TEST_SUITE_P(AllOfThem, ShippedModel,
                         testing::Values("cornell_box", "furnace_cube", "parallel_squares", "perpendicular_squares",
                                         "two_rooms"));

// Cases that no shipped model has: gaps in the numbering, backs, bytes that are not UTF-8, extreme numbers.
Scene odd_scene() {
  Scene scene = furnished_room(std::nextafter(1.0, 0.0), 1e300);
  scene.vertices.push_back({-0.0, 5e-324, 1e15 / 3});
  scene.materials[0].name =
      "stra\xdf"
      "e";
  scene.materials[1].name = "\xff\x00\"\n";
  scene.materials[1].transmittance = Spectrum::Constant(1, 1.0 / 3);
  scene.materials[1].index = 4.0 / 3;
  scene.materials[1].second_face = true;
  scene.materials.push_back({"paper", Spectrum::Constant(1, 0.3), Spectrum::Zero(1)});
  scene.materials.back().diffuse_transmittance = Spectrum::Constant(1, 1.0 / 7);
  scene.bands = {{"650 nm", 1.0 / 3, {1, 0, 0}}};
  scene.groups = {"", "gro\xc3\x9f", "\x80"};
  scene.file = "mod\xe8le.obj";
  scene.files = {scene.file, "b.obj"};
  scene.diagnostics = {{DiagnosticCode::zero_area, "on \xfe", 7, {}, 1.0 / 3}};
  scene.sha256 = "0123";
  scene.metres_per_unit = 0.1;
  scene.up = Vector(1, -2, 1.0 / 3);
  scene.up_stated = true;
  scene.polygons[3].back_material = 1;
  scene.polygons[4].group = 77;
  scene.polygons[5].line = ~std::uint32_t{0};
  scene.polygons[6].file = 1;
  scene.polygons[7].face = 123456;
  scene.lamp_hints = {
      {"stra\xdf"
       "e",
       Spectrum::Constant(1, 1.0 / 3), "its Ka"}};
  return scene;
}

TEST(SceneFile, KeepsEveryBitOfAnOddScene) {
  const Scene scene = odd_scene();
  KeptSides sides = kept_sides(scene, Sides::front);
  sides.front[2] = 0;
  sides.emit_from_back = true;
  sides.notes = {{DiagnosticCode::unlit_sides, "a note"}, {DiagnosticCode::both_sides, "\xff"}};
  const StoredScene stored = through_a_file(scene, sides);
  expect_same(stored.scene, scene);
  expect_same(stored.sides, sides);
  EXPECT_TRUE(std::signbit(stored.scene.vertices.back().x()));
}

// One light of each kind, sun and sky, and sensors and views.
Scene lit_scene() {
  Scene scene = odd_scene();
  const Spectrum one = Spectrum::Constant(1, 1.0 / 3);
  PhotometricWeb web{.file = "a.ies", .type = PhotometricType::b, .vertical = {0, 45, 90}, .horizontal = {0, 90}};
  web.candela = {1, 2, 3, 4, 5, 1.0 / 7};
  web.opening = Vector(0.1, 0.2, 0);
  web.tilt = {0, 90};
  web.tilt_factor = {1, 0.5};
  const auto at = [](double x, const auto& light) {
    return Luminaire{.name = "lamp", .place = "a.toml:3", .position = Point(x, 1.0 / 3, 2), .light = light};
  };
  scene.luminaires = {at(0, PointLight{one}), at(1, SpotLight{one, 10, 30}), at(2, SphericalLamp{0.1, one}),
                      at(3, WebLight{std::make_shared<const PhotometricWeb>(web), one})};
  scene.north = Vector::UnitX();
  scene.photometric = true;
  scene.sun = Sun{Vector(0.6, 0, 0.8), one};
  scene.sky = Sky{.kind = SkyKind::perez,
                  .zenith_radiance = one,
                  .sun_direction = Vector(0.6, 0, 0.8),
                  .clearness = 2.5,
                  .brightness = 0.2,
                  .ground_radiance = one};
  scene.sensors = {{.name = "desk",
                    .sensors = {{Point(0.5, 0.5, 1.0 / 3), Vector::UnitZ()}},
                    .columns = {"0.5,0.5,.333,0,0,1"},
                    .file = "p.txt",
                    .lines = {7}}};
  scene.cameras = {
      {.eye = Point(1, 2, 3), .target = Point(0, 0, 1.0 / 3), .vertical_field_of_view = 33, .name = "view"}};
  return scene;
}

TEST(SceneFile, KeepsLightsSensorsAndCameras) {
  const Scene scene = lit_scene();
  expect_same(through_a_file(scene, kept_sides(scene, Sides::front)).scene, scene);
}

TEST(SceneFile, RefusesLightsThatAreDamaged) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.json";
  const Scene scene = lit_scene();
  write_stored_scene(file, scene, kept_sides(scene, Sides::front));
  const nlohmann::json good = nlohmann::json::parse(content_of(file));
  using Pointer = nlohmann::json::json_pointer;
  for (const auto& [place, value] :
       std::vector<std::pair<const char*, nlohmann::json>>{{"/lights/north", {0, 0, 0}},
                                                           {"/lights/luminaires/0/kind", "candle"},
                                                           {"/lights/luminaires/0/intensity", {1, 2}},
                                                           {"/lights/luminaires/1/beam_half_angle", -1},
                                                           {"/lights/luminaires/2/radius", 0},
                                                           {"/lights/luminaires/3/web/candela", {1, 2}},
                                                           {"/lights/luminaires/3/web/vertical", {90, 45, 0}},
                                                           {"/lights/sun/normal_irradiance", {-1}},
                                                           {"/lights/sky/kind", "blue"},
                                                           {"/lights/sky/horizontal_irradiance", {1}},
                                                           {"/views/sensors/0/sensors", nlohmann::json::array()},
                                                           {"/views/cameras/0/eye", {1, 2}}}) {
    nlohmann::json damaged = good;
    damaged.at(Pointer(place)) = value;
    put(file, damaged.dump());
    EXPECT_THROW(read_stored_scene(folder.path()), InputError) << place;
  }
}

// Earlier versions recorded that there were lights, but did not store them.
TEST(SceneFile, OfBeforeLightsIsReadWhereThereWereNone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.json";
  const Scene scene = furnished_room(0.5);
  write_stored_scene(file, scene, kept_sides(scene, Sides::front));
  nlohmann::json older = nlohmann::json::parse(content_of(file));
  older.erase("lights");
  older.erase("views");
  older["has_point_or_daylight"] = false;
  put(file, older.dump());
  EXPECT_NO_THROW(read_stored_scene(folder.path()));
  older["has_point_or_daylight"] = true;
  put(file, older.dump());
  EXPECT_THROW(read_stored_scene(folder.path()), InputError);
}

TEST(SceneFile, OfBeforeIndicesHasTheUsualOnes) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.json";
  const Scene scene = odd_scene();
  write_stored_scene(file, scene, kept_sides(scene, Sides::front));
  nlohmann::json older = nlohmann::json::parse(content_of(file));
  for (nlohmann::json& material : older.at("materials")) material.erase("index");
  put(file, older.dump());
  for (const Material& material : read_stored_scene(folder.path()).scene.materials)
    EXPECT_EQ(material.index, usual_index);
}

// No program can write the file after any of these changes.
TEST(SceneFile, RefusesWhatIsDamaged) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.json";
  const Scene scene = furnished_room(0.5);
  write_stored_scene(file, scene, kept_sides(scene, Sides::front));
  const nlohmann::json good = nlohmann::json::parse(content_of(file));
  EXPECT_NO_THROW(read_stored_scene(folder.path()));
  const auto expect_refused = [&](const std::string& content) {
    put(file, content);
    try {
      read_stored_scene(folder.path());
      ADD_FAILURE() << "expected an InputError for " << content.substr(0, 2000);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("scene.json"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("again"), std::string::npos);
    }
  };
  const std::pair<const char*, nlohmann::json> changes[] = {{"/kind", "else"},
                                                            {"/metres_per_unit", 0},
                                                            {"/up", {0, 0, 0}},
                                                            {"/up", {0, 1}},
                                                            {"/vertices/0", nullptr},
                                                            {"/vertices/0", 1e16},
                                                            {"/materials", nlohmann::json::array()},
                                                            {"/materials/0/reflectance/0", 1.5},
                                                            {"/materials/0/reflectance", {0.5, 0.5}},
                                                            {"/materials/0/exitance", nlohmann::json::array()},
                                                            {"/materials/0/index", 0.5},
                                                            {"/polygons/corners/0", 1000},
                                                            {"/polygons/corners/0", -1},
                                                            {"/polygons/corners/0", 0.5},
                                                            {"/polygons/corner_counts/0", 5},
                                                            {"/polygons/material/0", 2},
                                                            {"/polygons/material/0", 4294967296},
                                                            {"/polygons/back_material/0", 2},
                                                            {"/polygons/back_material", nlohmann::json::array()},
                                                            {"/polygons/line", nlohmann::json::array()},
                                                            {"/polygons", nullptr},
                                                            {"/kept_sides/front/0", 2},
                                                            {"/kept_sides/back", nlohmann::json::array()},
                                                            {"/kept_sides/emit_from_back", 1}};
  for (const auto& [place, value] : changes) {
    nlohmann::json damaged = good;
    damaged[nlohmann::json::json_pointer(place)] = value;
    expect_refused(damaged.dump());
  }
  const std::string text = good.dump();
  for (const std::size_t length : {std::size_t{0}, text.size() / 2, text.size() - 1}) {
    expect_refused(text.substr(0, length));
  }
  for (const auto& item : good.items()) {
    if (item.key() == "version") continue;
    nlohmann::json damaged = good;
    damaged.erase(item.key());
    expect_refused(damaged.dump());
  }
}

TEST(SceneFile, ThatIsMissingIsExplained) {
  const TemporaryFolder folder;
  try {
    read_stored_scene(folder.path());
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no scene.json"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("patchlight form-factors MODEL -o FOLDER"), std::string::npos);
  }
}

}  // namespace
}  // namespace patchlight::scene_file_test
