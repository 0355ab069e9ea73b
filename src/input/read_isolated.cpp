#include "input/read_isolated.h"

#include "patchlight/base/error.h"

#include "files/message.h"

#include <exception>
#include <tuple>

namespace patchlight {

// The members that are sent, in order.
auto members_of(Is<Polygon> auto& polygon) {
  return std::tie(polygon.corners, polygon.material, polygon.group, polygon.line, polygon.texture_map,
                  polygon.back_material, polygon.back_texture_map);
}
auto members_of(Is<StatedSurface> auto& stated) {
  return std::tie(stated.by, stated.matt_reflectance, stated.matt_exitance);
}
auto members_of(Is<TexturedReflectance> auto& textured) {
  return std::tie(textured.texture, textured.of_primaries, textured.wrap);
}
auto members_of(Is<Material> auto& material) {
  return std::tie(material.name, material.reflectance, material.exitance, material.transmittance, material.index,
                  material.specular_reflectance, material.diffuse_transmittance, material.stated_pane,
                  material.stated_mirror, material.texture);
}
auto members_of(Is<TextureMap> auto& map) { return std::tie(map.linear, map.offset); }
auto members_of(Is<UnsimulatedMaterials> auto& found) { return std::tie(found.property, found.materials); }
auto members_of(Is<Diagnostic> auto& found) { return std::tie(found.code, found.count, found.text, found.area); }
auto members_of(Is<NamedRoom> auto& room) { return std::tie(room.name, room.storey, room.faces); }
auto members_of(Is<Scene> auto& scene) {
  return std::tie(scene.vertices, scene.polygons, scene.materials, scene.texture_maps, scene.groups, scene.inputs,
                  scene.unsimulated, scene.diagnostics, scene.rooms, scene.file, scene.sha256, scene.metres_per_unit,
                  scene.up, scene.up_stated);
}

Scene read_isolated(const std::string& file, const std::function<Scene()>& make, const ChildLimits& limits) {
  const std::string bytes = bytes_isolated(
      file, [&] { return message_of(make()); }, limits);
  try {
    return value_in<Scene>(bytes);
  } catch (const std::exception& error) {
    throw InputError(file, std::string("the reader of this format was damaged: ") + error.what());
  }
}

}  // namespace patchlight
