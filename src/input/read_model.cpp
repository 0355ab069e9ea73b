#include "input/read_model.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/materials.h"
#include "input/text.h"
#include "input/xml_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <system_error>
#include <utility>

namespace patchlight {
namespace {

// Reads an XML file by its first element: <scene> is a Mitsuba scene, <gbXML> a building. Throws InputError with file
// and line.
Scene read_xml(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  const XmlFile xml = read_xml_file(file, file.string());
  const std::string root = xml.document.document_element().name();
  if (root == "scene") return read_mitsuba(file, metres_per_unit, confine);
  if (root == "gbXML") return read_gbxml(xml, metres_per_unit);
  throw InputError(file.string(), "the first element is <" + root +
                                      ">; expected <scene>, of a Mitsuba scene, or <gbXML>, of a building");
}

// ".obj, .ply, ..."
std::string allowed_extensions() { return "." + listed(readable_formats(), ", ."); }

Scene read_format(const std::filesystem::path& file, const std::string& format, double metres_per_unit,
                  const std::filesystem::path& confine) {
  if (format == "obj") return read_obj(file, metres_per_unit, confine);
  if (format == "ply") return read_ply(file, metres_per_unit);
  if (format == "stl") return read_stl(file, metres_per_unit);
  if (format == "off") return read_off(file, metres_per_unit);
  if (format == "dae") return read_collada(file, metres_per_unit, confine);
  if (format == "gltf" || format == "glb") return read_gltf(file, metres_per_unit, confine);
  if (format == "hbjson") return read_hbjson(file, metres_per_unit);
  if (format == "xml") return read_xml(file, metres_per_unit, confine);
  throw InputError(file.string(),
                   "the extension '." + format + "' is not known; expected one of " + allowed_extensions());
}

// Reads the file in the given unit. Without one, the file's unit holds, except for Mitsuba XML, which has none.
Scene read_in_unit(const std::filesystem::path& file, const std::string& format, std::optional<double> metres_per_unit,
                   const std::filesystem::path& confine) {
  if (format == "ifc") return read_ifc(file, metres_per_unit);
  constexpr std::array<const char*, 5> stating = {"dae", "gltf", "glb", "hbjson", "xml"};
  const bool states_unit = std::find(stating.begin(), stating.end(), format) != stating.end();
  if (!states_unit) return read_format(file, format, metres_per_unit.value_or(1), confine);
  Scene scene = read_format(file, format, 1, confine);
  // Mitsuba states neither unit nor vertical axis; the other formats state both.
  scene.unit_stated = scene.up_stated && !metres_per_unit;
  if (!metres_per_unit) return scene;
  double stated = scene.metres_per_unit;
  if (format == "dae") stated = collada_unit(read_text(file, file.string(), "the model file"));
  if (*metres_per_unit != stated) scene = read_format(file, format, *metres_per_unit / stated, confine);
  scene.metres_per_unit = *metres_per_unit;
  return scene;
}

// "; did you mean 'room.obj'?" when the folder has a similar file; empty when the folder cannot be read.
std::string near_file(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end && names.size() < 10'000;
       entry.increment(error)) {
    std::error_code unknown;
    if (!entry->is_directory(unknown)) names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string nearest = near_match(file.filename().string(), names);
  return nearest.empty() ? "" : "; did you mean '" + (file.parent_path() / nearest).string() + "'?";
}

bool same_values(const Spectrum& a, const Spectrum& b) { return a.size() == b.size() && (a == b).all(); }

bool same_values(const std::optional<TexturedReflectance>& a, const std::optional<TexturedReflectance>& b) {
  if (!a || !b) return !a && !b;
  for (std::size_t k = 0; k < 3; ++k)
    if (!same_values(a->of_primaries[k], b->of_primaries[k])) return false;
  return a->wrap == b->wrap && a->texture->width == b->texture->width && a->texture->texels == b->texture->texels;
}

bool same_values(const Material& a, const Material& b) {
  return same_values(a.texture, b.texture) && same_values(a.reflectance, b.reflectance) &&
         same_values(a.exitance, b.exitance) && same_values(a.transmittance, b.transmittance) && a.index == b.index &&
         same_values(a.specular_reflectance, b.specular_reflectance) &&
         same_values(a.diffuse_transmittance, b.diffuse_transmittance);
}

// A scene with the materials of another one added; `index` maps those to indices in the scene.
struct MergedPalette {
  std::vector<Material> materials;
  Diagnostics notes;
  std::vector<MaterialIndex> index;
};

MergedPalette with_materials(std::vector<Material> materials, const Scene& added) {
  MergedPalette palette;
  UniqueNames names;
  std::map<std::string, MaterialIndex> index;
  for (std::size_t m = 0; m < materials.size(); ++m)
    index.emplace(names.unique(materials[m].name), static_cast<MaterialIndex>(m));
  const std::string file = std::filesystem::path(added.file).filename().string();
  for (Material material : added.materials) {
    const auto known = index.find(material.name);
    if (known != index.end() && same_values(materials[known->second], material)) {
      palette.index.push_back(known->second);
      continue;
    }
    if (known != index.end()) {
      const std::string name = names.unique(material.name + " (" + file + ")");
      palette.notes.push_back(
          {DiagnosticCode::renamed_material, "material '" + material.name + "' of " + added.file +
                                                 " differs from that of an earlier file and is called '" + name + "'"});
      material.name = name;
    } else {
      names.unique(material.name);
    }
    const auto number = static_cast<MaterialIndex>(materials.size());
    index.emplace(material.name, number);
    palette.index.push_back(number);
    materials.push_back(std::move(material));
  }
  palette.materials = std::move(materials);
  return palette;
}

// Appends the second scene to the first; the new polygons come from file number `file`.
Scene joined(Scene scene, Scene added, std::uint32_t file) {
  const auto vertices = static_cast<std::uint32_t>(scene.vertices.size());
  const auto maps = static_cast<std::uint32_t>(scene.texture_maps.size());
  const auto groups = static_cast<std::uint32_t>(scene.groups.size());
  MergedPalette palette = with_materials(std::move(scene.materials), added);
  scene.materials = std::move(palette.materials);
  scene.vertices.insert(scene.vertices.end(), added.vertices.begin(), added.vertices.end());
  for (Polygon& polygon : added.polygons) {
    for (std::uint32_t& corner : polygon.corners) corner += vertices;
    polygon.material = palette.index[polygon.material];
    if (polygon.back_material) polygon.back_material = palette.index[*polygon.back_material];
    for (std::uint32_t* map : {&polygon.texture_map, &polygon.back_texture_map})
      if (*map != no_texture_map) *map += maps;
    polygon.group += groups;
    polygon.file = file;
    scene.polygons.push_back(std::move(polygon));
  }
  scene.texture_maps.insert(scene.texture_maps.end(), added.texture_maps.begin(), added.texture_maps.end());
  scene.groups.insert(scene.groups.end(), added.groups.begin(), added.groups.end());
  for (Diagnostic& found : added.diagnostics) {
    for (ModelFace& face : found.faces) face.file = file;
    if (is_note(found.code)) found.text.insert(0, added.file + ": ");
  }
  scene.diagnostics = merged({std::move(scene.diagnostics), std::move(added.diagnostics), std::move(palette.notes)});
  scene.unsimulated.insert(scene.unsimulated.end(), added.unsimulated.begin(), added.unsimulated.end());
  scene.lamp_hints.insert(scene.lamp_hints.end(), added.lamp_hints.begin(), added.lamp_hints.end());
  scene.sensors.insert(scene.sensors.end(), added.sensors.begin(), added.sensors.end());
  scene.cameras.insert(scene.cameras.end(), added.cameras.begin(), added.cameras.end());
  scene.rooms.insert(scene.rooms.end(), added.rooms.begin(), added.rooms.end());
  scene.luminaires.insert(scene.luminaires.end(), added.luminaires.begin(), added.luminaires.end());
  if ((scene.sun && added.sun) || (scene.sky && added.sky))
    scene.diagnostics.push_back(
        {DiagnosticCode::left_out, added.file + ": its sun or sky is left out, as an earlier file has one"});
  if (!scene.sun) scene.sun = added.sun;
  if (!scene.sky) scene.sky = added.sky;
  scene.files.push_back(added.file);
  scene.inputs.insert(scene.inputs.end(), added.inputs.begin(), added.inputs.end());
  return scene;
}

}  // namespace

std::string format_of(const std::filesystem::path& file) {
  if (file == "-") return "obj";
  std::string text = file.extension().string();
  if (!text.empty()) text.erase(0, 1);
  text = in_lower_case(std::move(text));
  if (text == "mat") return "rad";
  return text == "gbxml" ? "xml" : text;
}

void require_file(const std::filesystem::path& file, const std::string& where, bool near_names) {
  if (file == "-") return;
  std::error_code error;
  const std::string name = where == file ? "" : file.string() + ": ";
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() != std::filesystem::file_type::not_found && error) {
    throw InputError(where, name + "the model file cannot be opened: " + error.message());
  }
  if (!std::filesystem::exists(status)) {
    const std::string hint = near_names ? near_file(file) : "";
    throw InputError(where, name + "the model file does not exist; check the name and the folder" + hint);
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(where, name + "this is a folder; expected a model file (" + allowed_extensions() + ")");
  }
}

FileModel read_model(const std::filesystem::path& file, const std::string& format,
                     std::optional<double> metres_per_unit, const std::filesystem::path& confine,
                     RadianceModifiers known) {
  require_within(confine, file, file.string());
  FileModel model =
      format == "rad"
          ? read_radiance(file, metres_per_unit.value_or(1), confine, std::move(known))
          : FileModel{without_doubtful_panes(read_in_unit(file, format, metres_per_unit, confine)), std::move(known)};
  if (file != "-") model.scene.inputs.push_back(file);
  return model;
}

Scene merge_scenes(std::vector<Scene> scenes) {
  assert(!scenes.empty());
  if (scenes.size() == 1) return std::move(scenes[0]);
  Scene merged;
  std::vector<std::string> checksums;
  std::string names;
  merged.bands = scenes[0].bands;
  merged.metres_per_unit = scenes[0].metres_per_unit;
  merged.up = scenes[0].up;
  merged.up_stated = scenes[0].up_stated;
  merged.north = scenes[0].north;
  merged.north_stated = scenes[0].north_stated;
  merged.unit_stated = std::all_of(scenes.begin(), scenes.end(), [](const Scene& scene) { return scene.unit_stated; });
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    checksums.push_back(scenes[k].sha256);
    names += (k == 0 ? "" : " + ") + scenes[k].file;
    merged = joined(std::move(merged), std::move(scenes[k]), static_cast<std::uint32_t>(k));
  }
  merged.file = names;
  merged.sha256 = sha256(checksums);
  return merged;
}

}  // namespace patchlight
