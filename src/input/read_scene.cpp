#include "patchlight/input/read_scene.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/repair.h"

#include "input/merge_scenes.h"
#include "input/read_collada.h"
#include "input/read_gltf.h"
#include "input/read_ifc.h"
#include "input/read_obj.h"
#include "input/read_off.h"
#include "input/read_ply.h"
#include "input/read_stl.h"
#include "input/text.h"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <numbers>
#include <system_error>

namespace patchlight {
namespace {

using Quantity = MaterialSetting::Quantity;

[[noreturn]] void refuse_setting(const std::string& text, const std::string& message) {
  throw InputError("--set", "found '" + text + "': " + message);
}

Quantity quantity_named(const std::string& name, const std::string& text) {
  if (name == "reflectance") return Quantity::reflectance;
  if (name == "exitance") return Quantity::exitance;
  if (name == "radiance") return Quantity::radiance;
  refuse_setting(text, "'" + name + "' cannot be set; expected reflectance, exitance or radiance");
}

Spectrum comma_separated(const std::string& list, const std::string& text) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin <= list.size()) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word(trimmed(std::string_view(list).substr(begin, end - begin)));
    const std::optional<double> value = finite_number(word);
    if (!value) refuse_setting(text, "'" + word + "' is not a finite number");
    values.push_back(*value);
    begin = end + 1;
  }
  if (values.size() != 1 && values.size() != 3) {
    refuse_setting(text, std::to_string(values.size()) + " values; expected one for all bands, or three: R,G,B");
  }
  return Eigen::Map<const Spectrum>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// One value stands for all bands.
Spectrum spread(const MaterialSetting& setting, Eigen::Index bands) {
  if (setting.value.size() == 1) return Spectrum::Constant(bands, setting.value[0]);
  if (setting.value.size() == bands) return setting.value;
  throw InputError("--set", "found " + std::to_string(setting.value.size()) + " values for material '" +
                                setting.material + "'; expected one, or one for each of " + std::to_string(bands) +
                                " bands");
}

Material changed(Material material, const MaterialSetting& setting) {
  const Spectrum value = spread(setting, material.reflectance.size());
  switch (setting.quantity) {
    case Quantity::reflectance:
      material.reflectance = value;
      break;
    case Quantity::exitance:
      material.exitance = value;
      break;
    case Quantity::radiance:
      material.exitance = std::numbers::pi * value;  // E = pi L for a Lambertian emitter
      break;
  }
  return material;
}

Scene with_settings(Scene scene, const std::vector<MaterialSetting>& settings) {
  for (const MaterialSetting& setting : settings) {
    const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                    [&](const Material& material) { return material.name == setting.material; });
    if (found == scene.materials.end()) {
      std::vector<std::string> names;
      for (const Material& material : scene.materials) names.push_back(material.name);
      throw InputError("--set", "no face has a material '" + setting.material + "'; expected one of " + listed(names));
    }
    *found = changed(*found, setting);
  }
  return scene;
}

Scene set_upright(Scene scene, const ReadOptions& options) {
  if (options.up || !scene.up_stated) scene.up = options.up ? *options.up : upright_axis(scene);
  return scene;
}

// Says why the faces were left out, if there were any.
[[noreturn]] void refuse_for_lack_of_faces(const Scene& scene) {
  std::string reasons;
  for (const Problem& problem : scene.problems) {
    if (problem.kind != ProblemKind::zero_area && problem.kind != ProblemKind::self_intersecting) continue;
    reasons += (reasons.empty() ? "" : "; ") + problem.what;
  }
  if (!reasons.empty()) throw InputError(scene.file, "none of its faces can be used: " + reasons);
  std::string others;
  for (const std::string& note : scene.notes) others += "; " + note;
  throw InputError(scene.file, "found no faces; expected at least one polygon" + others);
}

// The extension in lower case, without its dot; the standard input is OBJ.
std::string extension(const std::filesystem::path& file) {
  if (file == "-") return "obj";
  std::string text = file.extension().string();
  if (!text.empty()) text.erase(0, 1);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

// ".obj, .ply, ..."
std::string allowed_extensions() {
  std::string list;
  for (const std::string& format : readable_formats()) list += (list.empty() ? "." : ", .") + format;
  return list;
}

// One file as it stands, before any setting or check.
Scene read_model(const std::filesystem::path& file, const ReadOptions& options) {
  std::error_code error;
  const bool is_standard_input = file == "-";
  if (!is_standard_input && !std::filesystem::exists(file, error)) {
    throw InputError(file.string(), "the model file does not exist; check the name and the folder");
  }
  if (!is_standard_input && std::filesystem::is_directory(file, error)) {
    throw InputError(file.string(), "this is a folder; expected a model file (" + allowed_extensions() + ")");
  }
  const std::string format = options.format.empty() ? extension(file) : options.format;
  const double metres = options.metres_per_unit;
  if (format == "obj") return read_obj(file, metres);
  if (format == "ply") return read_ply(file, metres);
  if (format == "stl") return read_stl(file, metres);
  if (format == "off") return read_off(file, metres);
  if (format == "dae") return read_collada(file, metres);
  if (format == "ifc") return read_ifc(file, metres);
  if (format == "gltf" || format == "glb") return read_gltf(file, metres);
  throw InputError(file.string(),
                   "the extension '." + format + "' is not known; expected one of " + allowed_extensions());
}

}  // namespace

MaterialSetting parse_material_setting(const std::string& text) {
  // Names may hold dots and equal signs; the value holds no equal sign and the quantity no dot.
  const std::size_t equals = text.rfind('=');
  const std::size_t dot = equals == std::string::npos ? equals : text.rfind('.', equals);
  if (dot == std::string::npos || dot == 0) {
    refuse_setting(text, "expected MATERIAL.reflectance=R,G,B, MATERIAL.exitance=R,G,B or MATERIAL.radiance=R,G,B");
  }
  MaterialSetting setting;
  setting.material = text.substr(0, dot);
  setting.quantity = quantity_named(text.substr(dot + 1, equals - dot - 1), text);
  setting.value = comma_separated(text.substr(equals + 1), text);
  if ((setting.value < 0).any()) refuse_setting(text, "a value is negative; expected 0 or more");
  if (setting.quantity == Quantity::reflectance && (setting.value > 1).any()) {
    refuse_setting(text, "a reflectance is above 1; expected 0 to 1");
  }
  return setting;
}

std::vector<std::string> readable_formats() { return {"obj", "ply", "stl", "off", "dae", "ifc", "gltf", "glb"}; }

Scene read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  return read_scene(std::span(&file, 1), options);
}

Scene read_scene(std::span<const std::filesystem::path> files, const ReadOptions& options) {
  assert(options.metres_per_unit > 0 && !files.empty());
  std::vector<Scene> scenes;
  for (const std::filesystem::path& file : files) scenes.push_back(read_model(file, options));
  Scene scene = with_settings(merge_scenes(std::move(scenes)), options.settings);
  scene = repair(std::move(scene));
  if (scene.polygons.empty()) refuse_for_lack_of_faces(scene);
  check(scene);
  scene = set_upright(std::move(scene), options);
  std::vector<std::string> notes;
  for (const Problem& problem : scene.problems) notes.push_back(problem.what);
  scene.notes.insert(scene.notes.begin(), notes.begin(), notes.end());
  return scene;
}

Scene with_options(Scene scene, const ReadOptions& options) {
  return set_upright(with_settings(std::move(scene), options.settings), options);
}

}  // namespace patchlight
