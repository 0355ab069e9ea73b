#pragma once

#include "patchlight/light/material.h"

#include "input/radiance/radiance_text.h"

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// Radiance's plastic as a matt surface: its colorless gloss is added to the diffuse reflectance.
Material plastic(std::string name, const Spectrum& reflectance, double specularity);

/// Radiance's metal: its specular part is a mirror if the roughness is 0, else matt.
Material metal(std::string name, const Spectrum& reflectance, double specularity, double roughness);

/// Radiance's glass: a pane. Its transmittance T at normal incidence follows from its transmissivity t, with r = ((n -
/// 1) / (n + 1))^2 at each surface: T = t (1 - r)^2 / (1 - r^2 t^2).
Material glass(std::string name, const Spectrum& transmissivity, double index);

/// Radiance's trans: the fraction `transmitted` of the light that is not reflected as gloss passes through, and the
/// fraction `straight` of that is not scattered. Becomes a pane if `straight` is above one half, else a translucent
/// sheet. The smaller part of the transmitted light is lost.
Material translucent(std::string name, const Spectrum& colour, double specularity, double transmitted, double straight);

/// A surface that emits this radiance, W/(m^2 sr), and reflects nothing.
Material emitter(std::string name, const Spectrum& radiance);

/// A material of a Radiance scene file.
struct RadianceMaterial {
  Material material;
  std::string simplified;    ///< simplification for a note, e.g. "gloss becomes matt"; empty if exact
  bool loses_light = false;  ///< a light source that emits nothing
};

/// The material of a Radiance material kind with real arguments; empty for kinds without an equivalent.
std::optional<RadianceMaterial> radiance_material(const std::string& kind, const std::string& name,
                                                  const std::vector<double>& numbers);

/// The least number of real arguments of a material kind; 0 if unknown.
std::size_t least_arguments(const std::string& kind);

/// A modifier of a Radiance surface: a material, or a pattern or texture on top of one.
struct RadianceModifier {
  std::size_t under = 0;  ///< index of its own modifier, defined earlier; its own index for void
  std::string kind;       ///< "plastic"
  std::string name;
  std::vector<double> numbers;
  bool is_under_unknown = false;  ///< its own modifier is not defined: a program that is not executed may write it
};

/// The modifiers of the files, in order.
class RadianceModifiers {
 public:
  /// Adds a modifier or an alias. \throws InputError at `where` for too few numbers, or an undefined reference.
  void define(const RadiancePrimitive& primitive, const std::string& where);

  /// The index of the last one with this name.
  std::optional<std::size_t> place_of(const std::string& name) const;

  const RadianceModifier& at(std::size_t place) const { return all_[place]; }

  /// The index of the material below patterns and textures, or of the last of these.
  std::size_t material_below(std::size_t place) const;

  /// True for a pattern or texture, and for a material below one or below an undefined modifier.
  bool has_pattern(std::size_t place) const;

  /// The same without textures, which turn normals only: the emission varies.
  bool varies_in_strength(std::size_t place) const;

 private:
  std::vector<RadianceModifier> all_;
  std::map<std::string, std::size_t, std::less<>> last_;
};

}  // namespace patchlight
