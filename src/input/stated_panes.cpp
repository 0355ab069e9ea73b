#include "input/stated_panes.h"

#include "input/materials.h"
#include "input/text.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

bool lets_all_through(const Material& material) { return material.stated_pane && (material.transmittance >= 1).all(); }

std::string note_on_panes(const std::vector<std::string>& panes, const std::string& first) {
  return "materials read as panes, which let light through: " + listed(panes) + "; read.settings " + first +
         ".transmittance=0 makes " + (panes.size() == 1 ? "it" : "the first one") + " opaque";
}

}  // namespace

double plausible_index(double stated, double otherwise) {
  constexpr double of_ice = 1.3;
  constexpr double of_diamond = 2.5;
  return stated >= of_ice && stated <= of_diamond ? stated : otherwise;
}

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
                               "most materials would let all light through, so these are taken for opaque: " +
                                   listed(names) + "; read.settings " + names[0] + ".transmittance=1 makes one clear"});
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
    constexpr double rounding = 1e-12;
    if ((material.reflectance > most + rounding).any()) darker.push_back(material.name);
    material.reflectance = material.reflectance.min(most);
  }
  if (!panes.empty()) scene.diagnostics.push_back({DiagnosticCode::read_as_pane, note_on_panes(panes, first)});
  scene.diagnostics = merged({std::move(scene.diagnostics),
                              note_on(DiagnosticCode::lowered_reflectance,
                                      "the reflectance of panes is lowered to what they do not let through", darker)});
  return scene;
}

}  // namespace patchlight
