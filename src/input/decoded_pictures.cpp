#include "input/decoded_pictures.h"

#include "files/sha256.h"
#include "input/materials.h"
#include "input/picture_colours.h"

#include <memory>
#include <set>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A pane has the mean of its picture.
Material painted(Material material, const Spectrum& mean, const std::shared_ptr<const Texture>& texture) {
  material.reflectance = mean;
  if (material.stated_pane) material.stated_pane->matt_reflectance = mean;
  if (material.texture) material.texture->texture = texture;
  if (!texture) material.texture.reset();
  return material;
}

// Without maps into pictures that are none or have one colour.
Scene with_used_maps(Scene scene) {
  std::vector<TextureMap> maps;
  for (Polygon& polygon : scene.polygons) {
    if (polygon.texture_map == no_texture_map) continue;
    const TextureMap& map = scene.texture_maps[polygon.texture_map];
    polygon.texture_map = no_texture_map;
    if (!scene.materials[polygon.material].texture) continue;
    polygon.texture_map = static_cast<std::uint32_t>(maps.size());
    maps.push_back(map);
  }
  scene.texture_maps = std::move(maps);
  return scene;
}

}  // namespace

Scene with_decoded_pictures(Scene scene, const std::string& bytes, const std::filesystem::path& confine) {
  const std::vector<std::filesystem::path> names = std::exchange(scene.inputs, {});
  std::set<std::filesystem::path> files(names.begin(), names.end());
  files.erase(std::filesystem::path());
  scene.inputs.assign(files.begin(), files.end());
  const PictureColours colours = picture_colours(scene.inputs, confine, scene.file);
  std::vector<std::string> panes;
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (names[m].empty()) continue;
    Material& material = scene.materials[m];
    const std::string file = names[m].string();
    const auto mean = colours.by_file.find(file);
    if (mean == colours.by_file.end()) {
      material.texture.reset();
      scene.notes.push_back("the picture " + file + " of material '" + material.name + "' " + colours.faults.at(file) +
                            "; it is grey instead, reflectance 0.5");
      continue;
    }
    const auto texture = colours.textures.find(file);
    material =
        painted(std::move(material), mean->second, texture == colours.textures.end() ? nullptr : texture->second);
    if (material.stated_pane) panes.push_back(material.name);
  }
  for (std::string& note : note_on("textures of panes are replaced by their mean colour", panes))
    scene.notes.push_back(std::move(note));
  std::vector<std::string> contents = {bytes};
  contents.insert(contents.end(), colours.digests.begin(), colours.digests.end());
  scene.sha256 = sha256(contents);
  return with_used_materials(with_used_maps(std::move(scene)));
}

}  // namespace patchlight
