#pragma once

#include "patchlight/scene/scene.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace patchlight {

/// The material of faces without one in the file: "default", reflectance 0.5 in all bands.
Material default_material();

/// An empty scene for a format without materials. It has the default material, and a note.
Scene scene_without_materials(const std::string& file, double metres_per_unit);

/// The scene with only the used materials, in order. Empty and repeated names become unique: "material 3", "wall (2)".
Scene with_used_materials(Scene scene);

/// The numbers of materials with properties that are not simulated; kinds with a count of 0 are left out.
std::vector<UnsimulatedMaterials> counted(std::size_t mirrors, std::size_t glass);

/// A spectrum of fractions for messages: "0.7", or "0.9, 0.5, 0.2" where bands differ.
std::string listed_shares(const Spectrum& shares);

/// "sentence: a, b"; empty without names.
Diagnostics note_on(DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names);

/// Groups of a scene by their names.
class GroupIndex {
 public:
  /// The index of the group of that name; a new name is added to `groups`.
  std::uint32_t index_of(const std::string& name, std::vector<std::string>& groups) {
    const auto [found, is_new] = index_.emplace(name, static_cast<std::uint32_t>(groups.size()));
    if (is_new) groups.push_back(name);
    return found->second;
  }

 private:
  std::map<std::string, std::uint32_t> index_;
};

/// Makes the names of objects unique: "wall", "wall (2)", "wall (3)".
class UniqueNames {
 public:
  /// The name, with a number if it was returned before. Expected cost O(log n).
  std::string unique(const std::string& name) {
    std::string found = name;
    int& number = last_.emplace(name, 1).first->second;
    while (!taken_.insert(found).second) found = name + " (" + std::to_string(++number) + ")";
    return found;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  ///< number of a name
};

/// The index of refraction of a file, if it lies between those of ice and diamond; else `otherwise`. Many programs
/// write 1 for an unknown index.
double plausible_index(double stated, double otherwise = usual_index);

/// The transmittance at normal incidence of a pane without absorption.
double highest_transmittance(double index);

/// The material as the pane that a statement of the model file defines. The transmittance is clamped to [0, 1].
Material as_pane(Material material, const Spectrum& transmittance, double index, std::string statement);

/// The material without the pane of the model file: opaque.
Material without_stated_pane(Material material);

/// The scene of one model file. If more than half of its materials transmit all light, these become opaque, with a
/// note: some programs write inverted opacities.
Scene without_doubtful_panes(Scene scene);

/// The scene after all settings. The reflectance of stated panes is at most 1 - transmittance. One note lists the panes
/// and the setting that makes them opaque, another note lists lowered reflectances.
Scene with_stated_panes(Scene scene);

/// The largest roughness of a smooth surface in glTF and in MTL files with PBR.
inline constexpr double most_roughness = 0.05;

/// The smallest metalness of a metal in these formats.
inline constexpr double least_metallic = 0.9;

/// The material as the mirror that a statement of the model file defines. `left` is its diffuse reflectance. Negative
/// specular reflectances become 0.
Material as_mirror(Material material, const Spectrum& specular_reflectance, const Spectrum& left,
                   std::string statement);

/// The material without the mirror of the model file: matt.
Material without_stated_mirror(Material material);

/// The scene after all settings. The specular reflectance of stated mirrors is at most 1 - diffuse reflectance. One
/// note lists the mirrors and the setting that makes them matt, another note lists lowered values.
Scene with_stated_mirrors(Scene scene);

}  // namespace patchlight
