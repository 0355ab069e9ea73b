#include "pipeline/textured_patches.h"

#include "base/parallel.h"
#include "light/texture.h"

#include <vector>

namespace patchlight {
namespace {

// The patches of each material that lie in its picture.
std::vector<std::vector<PatchIndex>> textured_patches(const Scene& scene, const PatchMesh& mesh) {
  std::vector<std::vector<PatchIndex>> patches(scene.materials.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (texture_map_on(scene, scene.polygons[mesh.polygon[i]], mesh.side[i])) patches[mesh.material[i]].push_back(i);
  }
  return patches;
}

}  // namespace

Field with_textures(Field reflectance, const Scene& scene, const PatchMesh& mesh) {
  const std::vector<std::vector<PatchIndex>> textured = textured_patches(scene, mesh);
  for (std::size_t m = 0; m < textured.size(); ++m) {
    if (textured[m].empty()) continue;
    const TexturedReflectance& surface = *scene.materials[m].texture;
    const TextureMeans means(surface);
    parallel_for(textured[m].size(), [&](std::size_t k) {
      const PatchIndex i = textured[m][k];
      const TextureMap& map = *texture_map_on(scene, scene.polygons[mesh.polygon[i]], mesh.side[i]);
      const PatchCorners corners = mesh.corner_points(i);
      std::array<Eigen::Vector2d, 4> places;
      for (std::size_t c = 0; c < 4; ++c) places[c] = map.linear * corners.points[c] + map.offset;
      const auto count = static_cast<std::size_t>(corners.count);
      reflectance.row(i) = reflectance_of(surface, means.over(std::span(places).first(count)));
    });
  }
  return reflectance;
}

}  // namespace patchlight
