#include "input/materials.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "input/text.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

bool lets_all_through(const Material& material) { return material.stated_pane && (material.transmittance >= 1).all(); }

// "materials read as panes, which ...: a, b; read.settings a.transmittance=0 makes the first one opaque"
std::string note_on_stated(const std::string& kind, const std::vector<std::string>& names, const std::string& setting,
                           const std::string& result) {
  return "materials read as " + kind + ": " + listed(names) + "; read.settings " + setting + "=0 makes " +
         (names.size() == 1 ? "it" : "the first one") + ' ' + result;
}

}  // namespace

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
  if ((shares == shares[0]).all()) return rounded(shares[0], 4);
  return listed_as(shares, [](double share) { return rounded(share, 4); });
}

Diagnostics note_on(DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return {{code, sentence + ": " + listed(names)}};
}

double plausible_index(double stated, double otherwise) { return stated >= 1.3 && stated <= 2.5 ? stated : otherwise; }

// (1 - r) / (1 + r) with r = ((n - 1) / (n + 1))^2
double highest_transmittance(double index) { return 2 * index / (index * index + 1); }

Material as_pane(Material material, const Spectrum& transmittance, double index, std::string statement) {
  material.stated_pane = StatedSurface{std::move(statement), material.reflectance};
  material.texture.reset();
  material.transmittance = transmittance.max(0).min(1);
  material.index = index;
  return material;
}

Material without_stated_pane(Material material) {
  if (!material.stated_pane) return material;
  material.reflectance = material.stated_pane->matt_reflectance;
  if (material.stated_pane->matt_exitance.size() > 0) material.exitance = material.stated_pane->matt_exitance;
  material.transmittance = {};
  material.index = usual_index;
  material.stated_pane.reset();
  return material;
}

Scene without_doubtful_panes(Scene scene) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) {
    if (lets_all_through(material)) names.push_back(material.name);
  }
  if (2 * names.size() <= scene.materials.size()) return scene;
  for (Material& material : scene.materials) {
    if (lets_all_through(material)) material = without_stated_pane(std::move(material));
  }
  scene.diagnostics.push_back({DiagnosticCode::assumed_material,
                               "most materials would transmit all light, so these become opaque: " + listed(names) +
                                   "; read.settings " + names[0] + ".transmittance=1 makes one clear"});
  for (const UnsimulatedMaterials& glass : counted(0, names.size())) scene.unsimulated.push_back(glass);
  return scene;
}

Scene with_stated_panes(Scene scene) {
  std::vector<std::string> panes;
  std::vector<std::string> darker;
  std::string first;
  for (Material& material : scene.materials) {
    if (!material.stated_pane || !(material.transmittance > 0).any()) continue;
    if (panes.empty()) first = material.name;
    panes.push_back(material.name + " (" + material.stated_pane->by + ": transmittance " +
                    listed_shares(material.transmittance) + ")");
    const Spectrum most = 1 - material.transmittance;
    if ((material.reflectance > most + tolerance_of_arithmetic).any()) darker.push_back(material.name);
    material.reflectance = material.reflectance.min(most);
  }
  if (!panes.empty())
    scene.diagnostics.push_back({DiagnosticCode::read_as_pane, note_on_stated("panes, which let light through", panes,
                                                                              first + ".transmittance", "opaque")});
  scene.diagnostics = merged(
      {std::move(scene.diagnostics), note_on(DiagnosticCode::lowered_reflectance,
                                             "the reflectance of panes is lowered to 1 - transmittance", darker)});
  return scene;
}

Material as_mirror(Material material, const Spectrum& specular_reflectance, const Spectrum& left,
                   std::string statement) {
  material.stated_mirror = StatedSurface{std::move(statement), material.reflectance};
  material.texture.reset();
  material.specular_reflectance = specular_reflectance.max(0);
  material.reflectance = left;
  return material;
}

Material without_stated_mirror(Material material) {
  if (!material.stated_mirror) return material;
  material.reflectance = material.stated_mirror->matt_reflectance;
  material.specular_reflectance = {};
  material.stated_mirror.reset();
  return material;
}

Scene with_stated_mirrors(Scene scene) {
  std::vector<std::string> mirrors;
  std::vector<std::string> darker;
  std::string first;
  for (Material& material : scene.materials) {
    if (!material.stated_mirror) continue;
    if ((material.specular_reflectance + material.reflectance > 1).any()) {
      darker.push_back(material.name);
      material.specular_reflectance = material.specular_reflectance.min(1 - material.reflectance).max(0);
    }
    if (!(material.specular_reflectance > 0).any()) continue;
    if (mirrors.empty()) first = material.name;
    mirrors.push_back(material.name + " (" + material.stated_mirror->by + ": specular reflectance " +
                      listed_shares(material.specular_reflectance) + ")");
  }
  if (!mirrors.empty())
    scene.diagnostics.push_back(
        {DiagnosticCode::read_as_mirror, note_on_stated("mirrors, which reflect light without scattering it", mirrors,
                                                        first + ".specular_reflectance", "matt")});
  scene.diagnostics =
      merged({std::move(scene.diagnostics),
              note_on(DiagnosticCode::lowered_reflectance,
                      "the specular reflectance of mirrors is lowered to 1 - diffuse reflectance", darker)});
  return scene;
}

}  // namespace patchlight
