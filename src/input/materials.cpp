#include "input/materials.h"

#include "base/rounded.h"
#include "input/text.h"
#include "input/unique_names.h"

namespace patchlight {

Material default_material() { return {"default", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}; }

Scene scene_without_materials(const std::string& file, double metres_per_unit) {
  Scene scene;
  scene.file = file;
  scene.metres_per_unit = metres_per_unit;
  scene.materials.push_back(default_material());
  scene.diagnostics.push_back({DiagnosticCode::assumed_material,
                               "this format has no materials: all faces get the material 'default', reflectance 0.5; "
                               "read.settings changes it"});
  return scene;
}

Scene with_used_materials(Scene scene) {
  constexpr MaterialIndex unused = ~MaterialIndex{0};
  std::vector<MaterialIndex> number(scene.materials.size(), unused);
  for (const Polygon& polygon : scene.polygons) {
    number[polygon.material] = 0;
    if (polygon.back_material) number[*polygon.back_material] = 0;
  }
  std::vector<Material> materials;
  UniqueNames names;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (number[m] == unused) continue;
    number[m] = static_cast<MaterialIndex>(materials.size());
    Material material = scene.materials[m];
    material.name = names.unique(material.name.empty() ? "material " + std::to_string(m) : material.name);
    materials.push_back(std::move(material));
  }
  for (Polygon& polygon : scene.polygons) {
    polygon.material = number[polygon.material];
    if (polygon.back_material) polygon.back_material = number[*polygon.back_material];
  }
  scene.materials = std::move(materials);
  return scene;
}

std::vector<UnsimulatedMaterials> counted(std::size_t mirrors, std::size_t glass) {
  std::vector<UnsimulatedMaterials> found;
  if (mirrors > 0) found.push_back({UnsimulatedProperty::mirror, mirrors});
  if (glass > 0) found.push_back({UnsimulatedProperty::glass, glass});
  return found;
}

std::string listed_shares(const Spectrum& shares) {
  constexpr int digits = 4;
  std::string text = rounded(shares[0], digits);
  if ((shares == shares[0]).all()) return text;
  for (Eigen::Index band = 1; band < shares.size(); ++band) text += ", " + rounded(shares[band], digits);
  return text;
}

Diagnostics note_on(DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return {{code, sentence + ": " + listed(names)}};
}

}  // namespace patchlight
