#include "archive/lights_json.h"

#include "plan/survey.h"
#include "scene/photometric_web.h"
#include "scene/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
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

constexpr std::array<const char*, 4> luminaire_kinds = {"point", "spot", "ies", "sphere"};  // as in the variant

Json json_of_luminaire(const Luminaire& luminaire) {
  LightJson part{{{"kind", luminaire_kinds[luminaire.light.index()]},
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
  constexpr double off_unit = 1e-6;
  require(std::abs(vector.norm() - 1) < off_unit, "a direction is not of length 1");
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

}  // namespace

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

}  // namespace patchlight
