#pragma once

#include "input/radiance/radiance_text.h"

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// What can modify a Radiance surface: a material, or a pattern or texture that stands over one.
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
