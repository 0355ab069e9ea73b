#include "input/stated_mirrors.h"

#include "input/materials.h"
#include "input/text.h"

#include <utility>

namespace patchlight {
namespace {

std::string note_on_mirrors(const std::vector<std::string>& mirrors, const std::string& first) {
  return "materials read as mirrors, which reflect light without scattering it: " + listed(mirrors) +
         "; read.settings " + first + ".specular_reflectance=0 makes " +
         (mirrors.size() == 1 ? "it" : "the first one") + " matt";
}

}  // namespace

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
  if (!mirrors.empty()) scene.diagnostics.push_back({DiagnosticCode::read_as_mirror, note_on_mirrors(mirrors, first)});
  scene.diagnostics =
      merged({std::move(scene.diagnostics),
              note_on(DiagnosticCode::lowered_reflectance,
                      "the specular reflectance of mirrors is lowered to what they do not reflect diffusely", darker)});
  return scene;
}

}  // namespace patchlight
