#include "files/sha256.h"
#include "input/scene_file.h"
#include "input/text.h"
#include "input/toml_cameras.h"
#include "input/toml_lights.h"
#include "input/toml_models.h"
#include "input/toml_sensors.h"
#include "input/toml_spectrum.h"
#include "input/toml_value.h"

namespace patchlight {

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
