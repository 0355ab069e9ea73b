#pragma once

#include "patchlight/scene/scene.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace patchlight {

/// The material of faces for which the file gives none: "default", reflectance 0.5 in all bands.
Material default_material();

/// An empty scene for a format without materials: its only material is the default one, and a note says so.
Scene scene_without_materials(const std::string& file, double metres_per_unit);

/// The scene with only those materials that polygons use, in their order, names that are empty or come twice made
/// unique: "material 3", "wall (2)".
Scene with_used_materials(Scene scene);

/// How many materials have properties that are not simulated, those that none has left out.
std::vector<UnsimulatedMaterials> counted(std::size_t mirrors, std::size_t glass);

/// A spectrum of shares for messages: "0.7", or "0.9, 0.5, 0.2" where bands differ.
std::string listed_shares(const Spectrum& shares);

/// "sentence: a, b", or nothing when there are no names.
Diagnostics note_on(DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names);

/// Groups of a scene by their names.
class GroupIndex {
 public:
  /// The index of the group of that name, which is added to `groups` where it is new.
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
  /// The name, with a number if it was returned before. O(log n), expected.
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

/// The index of refraction that a file states where a clear material may have it, from ice to diamond; else another
/// one: programs write 1 for what they do not know.
double plausible_index(double stated, double otherwise = usual_index);

/// The transmittance at normal incidence of a pane of an index of refraction that absorbs nothing.
double highest_transmittance(double index);

/// The material as the pane that a model file makes of it by this statement. Of the transmittance what is not in [0, 1]
/// becomes the nearest number there.
Material as_pane(Material material, const Spectrum& transmittance, double index, std::string statement);

/// The material without the pane that a model file makes of it: opaque.
Material without_stated_pane(Material material);

/// The scene of one model file, of which panes that let all light through are opaque where more than half of the
/// materials are such: programs write that who mean the contrary. A note says so.
Scene without_doubtful_panes(Scene scene);

/// The scene with all settings, of which the panes that files state reflect no more than what they do not let through.
/// One note names them and the setting that makes them opaque, another one those that reflect less by that.
Scene with_stated_panes(Scene scene);

/// The roughness, of glTF and of MTL files with PBR, up to which a surface is taken for smooth.
inline constexpr double most_roughness = 0.05;

/// The metalness, of the same, from which it is taken for metal.
inline constexpr double least_metallic = 0.9;

/// The material as the mirror that a model file makes of it by this statement; what is left of its reflectance is
/// reflected diffusely besides. Of the shares that are reflected as by a mirror negative ones become 0.
Material as_mirror(Material material, const Spectrum& specular_reflectance, const Spectrum& left,
                   std::string statement);

/// The material without the mirror that a model file makes of it: matt.
Material without_stated_mirror(Material material);

/// The scene with all settings, of which the mirrors that files state reflect as mirrors no more than what they do not
/// reflect diffusely. One note names them and the setting that makes them matt, another one those that reflect less by
/// that.
Scene with_stated_mirrors(Scene scene);

}  // namespace patchlight
