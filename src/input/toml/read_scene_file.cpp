#include "patchlight/scene/scene.h"

#include "files/sha256.h"
#include "input/text.h"
#include "input/toml/scene_file.h"
#include "input/toml/toml_sensors.h"
#include "input/toml/toml_tables.h"
#include "input/toml/toml_value.h"

#include <cmath>
#include <utility>

namespace patchlight {
namespace {

void require_no(const TomlValue& table, const char* key, Projection projection) {
  const TomlValue* const value = find(table, key);
  if (value == nullptr) return;
  refuse(*value, std::string("none with the projection '") + name_of(projection) + "'\nhint: leave it out");
}

// Adds the extent of the image: an angle, or a height.
Camera with_projection(Camera camera, const TomlValue& table, double metres_per_unit) {
  using enum Projection;
  if (const TomlValue* const projection = find(table, "projection")) {
    camera.projection = choice<Projection>(*projection, {{name_of(perspective), perspective},
                                                         {name_of(orthographic), orthographic},
                                                         {name_of(angular), angular},
                                                         {name_of(hemispherical), hemispherical},
                                                         {name_of(panorama), panorama}});
  }
  if (camera.projection == orthographic) {
    require_no(table, "field_of_view", camera.projection);
    camera.height = metres_per_unit * positive(required(table, "height", "the height of what the picture shows"));
    return camera;
  }
  require_no(table, "height", camera.projection);
  camera.vertical_field_of_view = usual_field_of_view(camera.projection);
  if (const TomlValue* const angle = find(table, "field_of_view")) {
    camera.vertical_field_of_view = number(*angle);
    const std::string largest = std::to_string(std::lround(largest_field_of_view(camera.projection))) + " degrees";
    const std::string most = camera.projection == perspective ? "below " + largest : "up to " + largest;
    if (!has_extent(camera)) refuse(*angle, "an angle above 0 and " + most);
  }
  return camera;
}

// The cameras [[camera]] of a scene file, in meters. Throws InputError.
std::vector<Camera> cameras_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<Camera> cameras;
  for (const TomlValue& table : tables(find(root, "camera"))) {
    allow_keys(table, {"name", "eye", "target", "field_of_view", "projection", "height"});
    const TomlValue* const name = find(table, "name");
    const TomlValue& target = required(table, "target", "the point [x, y, z] that is looked at");
    Camera camera;
    camera.name = name ? text(*name) : "camera " + std::to_string(cameras.size() + 1);
    camera.eye = frame.metres_per_unit * vector(required(table, "eye", "the point [x, y, z] that is looked from"));
    camera.target = frame.metres_per_unit * vector(target);
    if (camera.eye == camera.target) refuse(target, "a point other than the eye");
    camera = with_projection(std::move(camera), table, frame.metres_per_unit);
    for (const Camera& other : cameras) {
      if (other.name == camera.name) refuse(name ? *name : table, "a name that no other camera has");
    }
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace

SceneFile read_scene_file(const std::filesystem::path& file, const std::filesystem::path& confine) {
  const std::string text = read_text(file, file.string(), "the scene file");
  const TomlValue root = parse_toml(text, file.string());
  allow_keys(root, {"unit", "up", "model", "material", "sensors", "camera", "luminaire", "north", "site", "sun", "sky",
                    "weather", "ground", "detail", "keep_faces", "spectra", "maintenance_factor"});

  SceneFile scene;
  scene.file = file.string();
  TomlFrame frame{.file = file, .confine = confine};
  if (const TomlValue* const unit = find(root, "unit")) frame.metres_per_unit = unit_length(*unit);
  if (const TomlValue* const up = find(root, "up")) scene.up = upright(*up);
  frame.up = scene.up.value_or(frame.up);
  scene.models = models_of(root, frame);
  scene.settings = settings_of(root, frame);
  scene.sensors = sensors_of(root, frame);
  scene.cameras = cameras_of(root, frame);
  scene.lights = lights_of(root, frame);
  if (const TomlValue* const detail = find(root, "detail")) scene.detail = frame.metres_per_unit * positive(*detail);
  if (const TomlValue* const keep = find(root, "keep_faces")) {
    if (keep->kind != TomlValue::Kind::truth) refuse(*keep, "true or false");
    scene.keep_faces = keep->truth;
  }
  if (const TomlValue* const factor = find(root, "maintenance_factor")) {
    scene.maintenance_factor = positive(*factor);
    if (*scene.maintenance_factor > 1) refuse(*factor, "a number above 0 and up to 1, e.g. 0.8");
  }
  scene.bands = bands_asked(root);
  std::vector<std::string> texts = {text};
  scene.inputs = sensor_files(root, frame);
  if (file != "-") scene.inputs.push_back(file);
  std::vector<std::filesystem::path> others = light_files(root, frame);
  for (const std::filesystem::path& other : spectrum_files(root, frame)) others.push_back(other);
  for (const std::filesystem::path& other : others) {
    scene.inputs.push_back(other);
    texts.push_back(read_text(other, other.string(), "the file"));
  }
  scene.sha256 = sha256(texts);
  return scene;
}

}  // namespace patchlight
