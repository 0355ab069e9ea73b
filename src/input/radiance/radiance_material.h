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

/// Radiance's plastic as a matt surface: its gloss, which has no color, is reflected diffusely as well.
Material plastic(std::string name, const Spectrum& reflectance, double specularity);

/// Radiance's metal: a mirror as far as it is glossy where it has no roughness, else matt.
Material metal(std::string name, const Spectrum& reflectance, double specularity, double roughness);

/// Radiance's glass: a pane. Its transmittance T square to it follows from its transmissivity t, with
/// r = ((n - 1) / (n + 1))^2 at each of its surfaces: T = t (1 - r)^2 / (1 - r^2 t^2).
Material glass(std::string name, const Spectrum& transmissivity, double index);

/// Radiance's trans: of what is not reflected as gloss the share `transmitted` goes through, of that the share
/// `straight` without being scattered. A translucent sheet, or a pane where more than half of it goes straight; what
/// goes the other way is lost.
Material translucent(std::string name, const Spectrum& colour, double specularity, double transmitted, double straight);

/// A surface that emits this radiance, W/(m^2 sr), and reflects nothing.
Material emitter(std::string name, const Spectrum& radiance);

/// A material of a Radiance scene file.
struct RadianceMaterial {
  Material material;
  std::string simplified;    ///< what is not carried, for a note: "gloss becomes matt"; empty if all is
  bool loses_light = false;  ///< a light source that emits nothing
};

/// The material that a kind of Radiance's with its real arguments stands for; nothing for kinds that have no
/// counterpart here.
std::optional<RadianceMaterial> radiance_material(const std::string& kind, const std::string& name,
                                                  const std::vector<double>& numbers);

/// How many real arguments a kind of material has at least; 0 for one that is not known.
std::size_t least_arguments(const std::string& kind);

/// A modifier of a Radiance surface: a material, or a pattern or texture that stands over one.
struct RadianceModifier {
  std::size_t under = 0;  ///< the place of its own modifier, which was defined before; its own place for void
  std::string kind;       ///< "plastic"
  std::string name;
  std::vector<double> numbers;
};

/// The modifiers of files, in their order.
class RadianceModifiers {
 public:
  /// Adds one, or an alias. \throws InputError at `where`: it has too few numbers, or stands for what is not defined.
  void define(const RadiancePrimitive& primitive, const std::string& where);

  /// The place of the last one that has this name.
  std::optional<std::size_t> place_of(const std::string& name) const;

  const RadianceModifier& at(std::size_t place) const { return all_[place]; }

  /// The place of the material below patterns and textures, or of the last of these.
  std::size_t material_below(std::size_t place) const;

  /// True for a pattern or texture, and for a material that has one.
  bool has_pattern(std::size_t place) const;

 private:
  std::vector<RadianceModifier> all_;
  std::map<std::string, std::size_t, std::less<>> last_;
};

}  // namespace patchlight
