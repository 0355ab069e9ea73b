#include "archive/scene_file.h"

#include "patchlight/base/error.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/output/write_result.h"

#include "archive/file_names.h"
#include "archive/json_values.h"
#include "base/tolerances.h"
#include "files/reason.h"
#include "output/file/whole_file.h"
#include "plan/survey.h"
#include "scene/luminaire_kinds.h"
#include "scene/photometric_web.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace patchlight {
namespace {

constexpr std::array<const char*, 3> web_types = {"a", "b", "c"};
constexpr std::array<const char*, 5> opening_shapes = {"box", "upright_cylinder", "cylinder_by_length",
                                                       "cylinder_by_width", "ellipsoid"};

template <std::size_t n>
std::size_t place_in(const std::array<const char*, n>& names, const std::string& name) {
  for (std::size_t k = 0; k < n; ++k) {
    if (name == names[k]) return k;
  }
  throw std::out_of_range("found '" + name + "'");
}

Json json_of_web(const PhotometricWeb& web) {
  return {{"file", json_of(web.file)},
          {"type", web_types[static_cast<std::size_t>(web.type)]},
          {"vertical", web.vertical},
          {"horizontal", web.horizontal},
          {"candela", web.candela},
          {"opening", json_of(web.opening)},
          {"opening_shape", opening_shapes[static_cast<std::size_t>(web.shape)]},
          {"lamp_lumens", web.lamp_lumens},
          {"watts", web.watts},
          {"tilt", web.tilt},
          {"tilt_factor", web.tilt_factor}};
}

bool ascends(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
}

PhotometricWeb web_of(const Json& json) {
  PhotometricWeb web;
  web.file = text_of(json.at("file"));
  web.type = static_cast<PhotometricType>(place_in(web_types, json.at("type").get<std::string>()));
  web.vertical = json.at("vertical").get<std::vector<double>>();
  web.horizontal = json.at("horizontal").get<std::vector<double>>();
  web.candela = json.at("candela").get<std::vector<double>>();
  web.opening = vector_of(json.at("opening"));
  web.shape =
      static_cast<OpeningShape>(place_in(opening_shapes, json.value("opening_shape", std::string(opening_shapes[0]))));
  web.lamp_lumens = json.at("lamp_lumens").get<double>();
  web.watts = json.at("watts").get<double>();
  web.tilt = json.at("tilt").get<std::vector<double>>();
  web.tilt_factor = json.at("tilt_factor").get<std::vector<double>>();
  require(!web.candela.empty() && web.candela.size() == web.vertical.size() * web.horizontal.size() &&
              web.tilt.size() == web.tilt_factor.size() && ascends(web.vertical) && ascends(web.horizontal) &&
              ascends(web.tilt),
          "a table of candela does not fit its angles");
  return web;
}

// Adds what a kind of luminaire has to what all have.
struct LightJson {
  Json json;
  void operator()(const PointLight& light) { json["intensity"] = json_of(light.intensity); }
  void operator()(const SpotLight& light) {
    json["intensity"] = json_of(light.intensity);
    json["beam_half_angle"] = light.beam_half_angle;
    json["field_half_angle"] = light.field_half_angle;
  }
  void operator()(const WebLight& light) {
    json["web"] = json_of_web(*light.web);
    json["watts_per_lumen"] = json_of(light.watts_per_lumen);
  }
  void operator()(const SphericalLamp& light) {
    json["radius"] = light.radius;
    json["exitance"] = json_of(light.exitance);
  }
};

Json json_of_luminaire(const Luminaire& luminaire) {
  LightJson part{{{"kind", kind_of(luminaire)},
                  {"name", json_of(luminaire.name)},
                  {"place", json_of(luminaire.place)},
                  {"position", json_of(luminaire.position)},
                  {"aim", json_of(luminaire.aim)},
                  {"zero_plane", json_of(luminaire.zero_plane)}}};
  std::visit([&part](const auto& light) { part(light); }, luminaire.light);
  return std::move(part.json);
}

Spectrum bands_of(const Json& json, Eigen::Index bands) {
  Spectrum spectrum = spectrum_of(json);
  require(spectrum.size() == bands && spectrum.allFinite() && (spectrum >= 0).all(),
          "a light has not the scene's bands");
  return spectrum;
}

Vector unit_of(const Json& json) {
  Vector vector = vector_of(json);
  require(std::abs(vector.norm() - 1) < tolerance_of_coordinates, "a direction is not of length 1");
  return vector;
}

Luminaire luminaire_of(const Json& json, Eigen::Index bands) {
  Luminaire luminaire;
  luminaire.name = text_of(json.at("name"));
  luminaire.place = text_of(json.at("place"));
  luminaire.position = vector_of(json.at("position"));
  luminaire.aim = unit_of(json.at("aim"));
  luminaire.zero_plane = unit_of(json.at("zero_plane"));
  require(luminaire.position.allFinite(), "a luminaire stands nowhere");
  switch (place_in(luminaire_kinds, json.at("kind").get<std::string>())) {
    case 0:
      luminaire.light = PointLight{bands_of(json.at("intensity"), bands)};
      break;
    case 1: {
      const SpotLight spot{bands_of(json.at("intensity"), bands), json.at("beam_half_angle").get<double>(),
                           json.at("field_half_angle").get<double>()};
      require(spot.beam_half_angle > 0 && spot.field_half_angle > spot.beam_half_angle && spot.field_half_angle <= 90,
              "a beam has no angle");
      luminaire.light = spot;
      break;
    }
    case 2:
      luminaire.light = WebLight{std::make_shared<const PhotometricWeb>(web_of(json.at("web"))),
                                 bands_of(json.at("watts_per_lumen"), bands)};
      break;
    default: {
      const SphericalLamp sphere{json.at("radius").get<double>(), bands_of(json.at("exitance"), bands)};
      require(sphere.radius > 0 && std::isfinite(sphere.radius), "a sphere has no radius");
      luminaire.light = sphere;
    }
  }
  return luminaire;
}

SkyKind sky_kind_named(const std::string& name) {
  for (const SkyKind kind : {SkyKind::uniform, SkyKind::cie_overcast, SkyKind::cie_clear, SkyKind::perez}) {
    if (name == name_of(kind)) return kind;
  }
  throw std::out_of_range("found a sky '" + name + "'");
}

Json json_of_sky(const Sky& sky) {
  return {{"kind", name_of(sky.kind)},
          {"horizontal_irradiance", json_of(sky.horizontal_irradiance)},
          {"zenith_radiance", json_of(sky.zenith_radiance)},
          {"sun_direction", json_of(sky.sun_direction)},
          {"clearness", sky.clearness},
          {"brightness", sky.brightness},
          {"ground_radiance", json_of(sky.ground_radiance)}};
}

Sky sky_of(const Json& json, Eigen::Index bands) {
  Sky sky;
  sky.kind = sky_kind_named(json.at("kind").get<std::string>());
  const auto none_or_all = [&](const char* key) {
    const Json& values = json.at(key);
    return values.empty() ? Spectrum() : bands_of(values, bands);
  };
  sky.horizontal_irradiance = none_or_all("horizontal_irradiance");
  sky.zenith_radiance = none_or_all("zenith_radiance");
  sky.ground_radiance = none_or_all("ground_radiance");
  sky.sun_direction = unit_of(json.at("sun_direction"));
  sky.clearness = json.at("clearness").get<double>();
  sky.brightness = json.at("brightness").get<double>();
  require((sky.horizontal_irradiance.size() > 0) != (sky.zenith_radiance.size() > 0), "the sky has not one strength");
  require(sky.clearness >= 1 && sky.brightness > 0, "the sky is none of Perez's");
  return sky;
}

Json json_of_points(const std::vector<Sensor>& sensors) {
  Json list = Json::array();
  for (const Sensor& sensor : sensors) list.push_back({json_of(sensor.point), json_of(sensor.normal)});
  return list;
}

Json json_of_sensors(const SensorGroup& group) {
  Json cells = Json::array();
  for (const std::array<Point, 4>& cell : group.cells)
    cells.push_back({json_of(cell[0]), json_of(cell[1]), json_of(cell[2]), json_of(cell[3])});
  return {{"name", json_of(group.name)}, {"sensors", json_of_points(group.sensors)},
          {"cells", std::move(cells)},   {"columns", json_of(group.columns)},
          {"file", json_of(group.file)}, {"lines", group.lines}};
}

SensorGroup sensors_of(const Json& json) {
  SensorGroup group;
  group.name = text_of(json.at("name"));
  for (const Json& sensor : json.at("sensors"))
    group.sensors.push_back({vector_of(sensor.at(0)), unit_of(sensor.at(1))});
  for (const Json& cell : json.at("cells"))
    group.cells.push_back({vector_of(cell.at(0)), vector_of(cell.at(1)), vector_of(cell.at(2)), vector_of(cell.at(3))});
  group.columns = texts_of(json.at("columns"));
  group.file = text_of(json.at("file"));
  group.lines = json.at("lines").get<std::vector<std::uint32_t>>();
  const std::size_t count = group.sensors.size();
  require(count > 0 && (group.cells.empty() || group.cells.size() == count) &&
              (group.columns.empty() || group.columns.size() == count) &&
              (group.lines.size() <= 1 || group.lines.size() == count),
          "a group of sensors is not whole");
  return group;
}

// The luminaires, sun and sky of a scene, and which way is north.
Json lights_part(const Scene& scene) {
  Json luminaires = Json::array();
  for (const Luminaire& luminaire : scene.luminaires) luminaires.push_back(json_of_luminaire(luminaire));
  Json part = {
      {"north", json_of(scene.north)}, {"photometric", scene.photometric}, {"luminaires", std::move(luminaires)}};
  if (scene.sun)
    part["sun"] = {{"direction", json_of(scene.sun->direction)},
                   {"normal_irradiance", json_of(scene.sun->normal_irradiance)}};
  if (scene.sky) part["sky"] = json_of_sky(*scene.sky);
  return part;
}

// The scene with the lights of such a part. Throws what nlohmann::json throws, or std::out_of_range, where it is
// damaged.
Scene with_lights_of(Scene scene, const Json& json) {
  const Eigen::Index bands = number_of_bands(scene);
  scene.north = unit_of(json.at("north"));
  scene.photometric = json.at("photometric").get<bool>();
  for (const Json& luminaire : json.at("luminaires")) scene.luminaires.push_back(luminaire_of(luminaire, bands));
  if (json.contains("sun"))
    scene.sun = Sun{unit_of(json.at("sun").at("direction")), bands_of(json.at("sun").at("normal_irradiance"), bands)};
  if (json.contains("sky")) scene.sky = sky_of(json.at("sky"), bands);
  return scene;
}

// The sensors and cameras of a scene.
Json views_part(const Scene& scene) {
  Json sensors = Json::array();
  for (const SensorGroup& group : scene.sensors) sensors.push_back(json_of_sensors(group));
  Json cameras = Json::array();
  for (const Camera& camera : scene.cameras) {
    cameras.push_back({{"name", json_of(camera.name)},
                       {"eye", json_of(camera.eye)},
                       {"target", json_of(camera.target)},
                       {"vertical_field_of_view", camera.vertical_field_of_view},
                       {"projection", name_of(camera.projection)},
                       {"height", camera.height}});
  }
  return {{"sensors", std::move(sensors)}, {"cameras", std::move(cameras)}};
}

// The scene with the sensors and cameras of such a part. Throws as with_lights_of().
Scene with_views_of(Scene scene, const Json& json) {
  for (const Json& group : json.at("sensors")) scene.sensors.push_back(sensors_of(group));
  for (const Json& camera : json.at("cameras")) {
    scene.cameras.push_back({vector_of(camera.at("eye")), vector_of(camera.at("target")),
                             camera.at("vertical_field_of_view").get<double>(), text_of(camera.at("name"))});
    Camera& read = scene.cameras.back();
    const std::optional<Projection> projection = projection_named(camera.value("projection", "perspective"));
    require(projection.has_value(), "a camera has no projection");
    read.projection = *projection;
    read.height = camera.value("height", 0.0);
    require(scene.cameras.back().eye.allFinite() && scene.cameras.back().target.allFinite(), "a camera stands nowhere");
  }
  return scene;
}

// The bands of a scene, one entry per band.
nlohmann::ordered_json json_of_bands(const Bands& bands) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Band& band : bands)
    list.push_back({{"name", band.name},
                    {"luminous_weight", band.luminous_weight},
                    {"rgb", band.rgb},
                    {"edges_nm", band.edges_nm}});
  return list;
}

// Reads the bands back. Throws the exceptions of nlohmann::json if a part is missing or has another shape.
Bands bands_from(const nlohmann::ordered_json& json) {
  Bands bands;
  for (const auto& entry : json) {
    bands.push_back({entry.at("name").get<std::string>(), entry.at("luminous_weight").get<double>(),
                     entry.at("rgb").get<std::array<double, 3>>(), entry.value("edges_nm", std::array<double, 2>{})});
  }
  return bands;
}

using Indices = std::vector<std::uint32_t>;

constexpr const char* kind = "patchlight scene";

Json materials_part(const Scene& scene) {
  Json part = Json::array();
  for (const Material& material : scene.materials) {
    part.push_back({{"name", json_of(material.name)},
                    {"reflectance", json_of(material.reflectance)},
                    {"exitance", json_of(material.exitance)},
                    {"transmittance", json_of(material.transmittance)},
                    {"index", material.index},
                    {"specular_reflectance", json_of(material.specular_reflectance)},
                    {"diffuse_transmittance", json_of(material.diffuse_transmittance)},
                    {"second_face", material.second_face}});
  }
  return part;
}

Json lamp_hints_part(const Scene& scene) {
  Json part = Json::array();
  for (const LampHint& hint : scene.lamp_hints) {
    part.push_back(
        {{"material", json_of(hint.material)}, {"radiance", json_of(hint.radiance)}, {"reason", json_of(hint.reason)}});
  }
  return part;
}

Json vertices_part(const Scene& scene) {
  std::vector<double> coordinates;
  for (const Point& vertex : scene.vertices) coordinates.insert(coordinates.end(), vertex.begin(), vertex.end());
  return coordinates;
}

// One array per property, with an entry for each polygon; their corners one after the other.
Json polygons_part(const Scene& scene) {
  Indices corners, corner_counts, material, group, line, file, face;
  Json back_material = Json::array();
  for (const Polygon& polygon : scene.polygons) {
    corners.insert(corners.end(), polygon.corners.begin(), polygon.corners.end());
    corner_counts.push_back(static_cast<std::uint32_t>(polygon.corners.size()));
    material.push_back(polygon.material);
    back_material.push_back(polygon.back_material ? Json(*polygon.back_material) : Json());
    group.push_back(polygon.group);
    line.push_back(polygon.line);
    file.push_back(polygon.file);
    face.push_back(polygon.face);
  }
  return {{"corners", corners},
          {"corner_counts", corner_counts},
          {"material", material},
          {"group", group},
          {"back_material", back_material},
          {"line", line},
          {"file", file},
          {"face", face}};
}

// Without the faces.
Json diagnostics_part(const Diagnostics& diagnostics) {
  Json part = Json::array();
  for (const Diagnostic& found : diagnostics)
    part.push_back({{"code", name_of(found.code)},
                    {"count", found.count},
                    {"text", json_of(found.text)},
                    {"area_m2", found.area}});
  return part;
}

Diagnostics diagnostics_of(const Json& json) {
  Diagnostics diagnostics;
  for (const Json& part : json) {
    const std::string name = text_of(part.at("code"));
    const std::optional<DiagnosticCode> known = diagnostic_code(name);
    require(known.has_value(), "the code '" + name + "' is not known");
    diagnostics.push_back(
        {*known, text_of(part.at("text")), part.at("count").get<std::size_t>(), {}, part.at("area_m2").get<double>()});
  }
  return diagnostics;
}

Json sides_part(const KeptSides& sides) {
  return {{"front", sides.front},
          {"back", sides.back},
          {"emit_from_back", sides.emit_from_back},
          {"notes", diagnostics_part(sides.notes)}};
}

// `count` whole numbers from 0 up to, but without, `end`.
Indices indices_of(const Json& json, std::size_t count, std::uint64_t end = std::uint64_t{1} << 32) {
  require(json.is_array() && json.size() == count,
          "an array has " + std::to_string(json.size()) + " entries; expected " + std::to_string(count));
  Indices indices;
  for (const Json& entry : json) {
    require(entry.is_number_unsigned() && entry.get<std::uint64_t>() < end,
            "found " + entry.dump() + "; expected a whole number below " + std::to_string(end));
    indices.push_back(entry.get<std::uint32_t>());
  }
  return indices;
}

std::vector<Material> materials_of(const Json& json) {
  std::vector<Material> materials;
  for (const Json& entry : json) {
    Material material{text_of(entry.at("name")), spectrum_of(entry.at("reflectance")),
                      spectrum_of(entry.at("exitance")), spectrum_of(entry.at("transmittance")),
                      entry.value("index", usual_index)};
    if (entry.contains("specular_reflectance"))
      material.specular_reflectance = spectrum_of(entry.at("specular_reflectance"));
    if (entry.contains("diffuse_transmittance"))
      material.diffuse_transmittance = spectrum_of(entry.at("diffuse_transmittance"));
    material.second_face = entry.value("second_face", false);
    const Eigen::Index bands = materials.empty() ? material.reflectance.size() : materials[0].reflectance.size();
    const auto none_or_all = [bands](const Spectrum& spectrum) {
      return spectrum.size() == 0 || spectrum.size() == bands;
    };
    require(bands > 0 && material.reflectance.size() == bands && material.exitance.size() == bands &&
                none_or_all(material.transmittance) && none_or_all(material.specular_reflectance) &&
                none_or_all(material.diffuse_transmittance),
            "the materials do not all have the same bands");
    materials.push_back(std::move(material));
  }
  return materials;
}

std::vector<LampHint> lamp_hints_of(const Json& json) {
  std::vector<LampHint> hints;
  for (const Json& entry : json) {
    hints.push_back({text_of(entry.at("material")), spectrum_of(entry.at("radiance")), text_of(entry.at("reason"))});
  }
  return hints;
}

std::vector<Point> vertices_of(const Json& json) {
  const auto coordinates = json.get<std::vector<double>>();
  require(coordinates.size() % 3 == 0,
          "found " + std::to_string(coordinates.size()) + " coordinates; expected triples");
  std::vector<Point> vertices;
  for (std::size_t k = 0; k < coordinates.size(); k += 3) vertices.emplace_back(&coordinates[k]);
  return vertices;
}

std::vector<std::optional<MaterialIndex>> back_materials_of(const Json& json, std::size_t count, std::size_t end) {
  std::vector<std::optional<MaterialIndex>> materials;
  for (const Json& entry : json) {
    materials.push_back(entry.is_null() ? std::nullopt : std::optional(indices_of(Json::array({entry}), 1, end)[0]));
  }
  require(materials.size() == count, "found " + std::to_string(materials.size()) + " materials of backs");
  return materials;
}

std::vector<Polygon> polygons_of(const Json& json, std::size_t materials) {
  const std::size_t count = json.at("material").size();
  const Indices corner_counts = indices_of(json.at("corner_counts"), count);
  const Indices corners =
      indices_of(json.at("corners"), std::accumulate(corner_counts.begin(), corner_counts.end(), std::size_t{0}));
  const Indices material = indices_of(json.at("material"), count, materials);
  const auto back_material = back_materials_of(json.at("back_material"), count, materials);
  const Indices group = indices_of(json.at("group"), count);
  const Indices line = indices_of(json.at("line"), count);
  const Indices file = indices_of(json.at("file"), count);
  const Indices face = indices_of(json.at("face"), count);
  std::vector<Polygon> polygons;
  auto corner = corners.begin();
  for (std::size_t p = 0; p < count; ++p) {
    const auto end = corner + corner_counts[p];
    polygons.push_back({{corner, end}, material[p], group[p], line[p], file[p], face[p], back_material[p]});
    corner = end;
  }
  return polygons;
}

KeptSides sides_of(const Json& json, std::size_t polygons) {
  const Indices front = indices_of(json.at("front"), polygons, 2);
  const Indices back = indices_of(json.at("back"), polygons, 2);
  return {{front.begin(), front.end()},
          {back.begin(), back.end()},
          json.at("emit_from_back").get<bool>(),
          diagnostics_of(json.at("notes"))};
}

[[noreturn]] void refuse_lights(const std::filesystem::path& folder) {
  throw InputError(
      folder.string(),
      "its scene has luminaires, sun or sky, which earlier versions did not keep with form factors; compute "
      "them again: patchlight form-factors MODEL -o FOLDER");
}

StoredScene stored_scene_of(const Json& json) {
  require(json.at("kind") == kind, "its kind is " + json.at("kind").dump());
  Scene scene;
  scene.file = text_of(json.at("model"));
  scene.files = texts_of(json.at("files"));
  scene.sha256 = text_of(json.at("sha256"));
  scene.metres_per_unit = json.at("metres_per_unit").get<double>();
  scene.up = vector_of(json.at("up"));
  scene.up_stated = json.at("up_stated").get<bool>();
  scene.diagnostics = diagnostics_of(json.at("diagnostics"));
  scene.materials = materials_of(json.at("materials"));
  if (json.contains("bands")) scene.bands = bands_from(json.at("bands"));
  scene.lamp_hints = lamp_hints_of(json.at("lamp_hints"));
  scene.groups = texts_of(json.at("groups"));
  scene.vertices = vertices_of(json.at("vertices"));
  scene.polygons = polygons_of(json.at("polygons"), scene.materials.size());
  require(scene.metres_per_unit > 0 && std::isfinite(scene.metres_per_unit), "the unit has no length");
  require(scene.up.allFinite() && scene.up.norm() > 0, "no direction is up");
  if (json.contains("lights"))
    scene = with_views_of(with_lights_of(std::move(scene), json.at("lights")), json.at("views"));
  check(scene);
  KeptSides sides = sides_of(json.at("kept_sides"), scene.polygons.size());
  return {std::move(scene), std::move(sides)};
}

}  // namespace

void write_stored_scene(const std::filesystem::path& file, const Scene& scene, const KeptSides& sides) {
  Json json;
  json["kind"] = kind;
  json["version"] = version();
  json["model"] = json_of(scene.file);
  json["files"] = json_of(scene.files);
  json["sha256"] = json_of(scene.sha256);
  json["metres_per_unit"] = scene.metres_per_unit;
  json["up"] = json_of(scene.up);
  json["up_stated"] = scene.up_stated;
  Diagnostics diagnostics = scene.diagnostics;
  if (std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.texture; }))
    diagnostics.push_back({DiagnosticCode::simplified_picture, "pictures are not stored: their means count"});
  json["diagnostics"] = diagnostics_part(diagnostics);
  json["materials"] = materials_part(scene);
  if (!scene.bands.empty()) json["bands"] = json_of_bands(scene.bands);
  json["lamp_hints"] = lamp_hints_part(scene);
  json["lights"] = lights_part(scene);
  json["views"] = views_part(scene);
  json["groups"] = json_of(scene.groups);
  json["vertices"] = vertices_part(scene);
  json["polygons"] = polygons_part(scene);
  json["kept_sides"] = sides_part(sides);
  write_bytes(file, json.dump() + "\n");
}

StoredScene read_stored_scene(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / file_name::scene;
  require_regular_file(file);
  std::ifstream stream(file);
  if (!stream) {
    throw InputError(folder.string(), std::string("there is no ") + file_name::scene +
                                          " in it, as form factors of earlier versions have none; compute them again: "
                                          "patchlight form-factors MODEL -o FOLDER");
  }
  StoredScene stored;
  bool lights_left_out = false;
  try {
    const Json json = Json::parse(stream);
    lights_left_out = !json.contains("lights") && json.at("has_point_or_daylight").get<bool>();
    stored = stored_scene_of(json);
  } catch (const std::exception& error) {
    throw InputError(file.string(), "is not as patchlight form-factors writes it (" + reason_of(error) +
                                        "); compute the form factors again");
  }
  if (lights_left_out) refuse_lights(folder);
  return stored;
}

}  // namespace patchlight
