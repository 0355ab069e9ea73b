#include "input/merge_scenes.h"

#include "files/sha256.h"
#include "input/unique_names.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <map>

namespace patchlight {
namespace {

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

// The scene with another one's materials added; what becomes of those is their index in the scene.
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

// The first scene with the second added; its polygons come from file number `file`.
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
