#pragma once

#include "patchlight/light/material.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace patchlight {

/// The modifiers of a honeybee model as materials.
class HoneybeeModifiers {
 public:
  /// Of a model's "properties"."radiance"; may be null.
  explicit HoneybeeModifiers(const nlohmann::json& radiance);

  /// The material of a face, opening or shade: its own modifier, that of the modifier set of its room, or honeybee's
  /// generic one. `kind` is one of "floor", "wall", "ceiling", "door", "glass_door", "window", "operable_window",
  /// "skylight", "exterior_shade", "interior_shade", "context"; whether it stands outdoors its boundary condition says.
  Material material(const nlohmann::json& item, const std::string& set, const std::string& kind);

  /// Names of modifiers that cannot be carried and are taken for honeybee's generic ones.
  const std::vector<std::string>& unknown() const { return unknown_; }

 private:
  const nlohmann::json* modifier(const std::string& identifier) const;
  std::string of_set(const std::string& set, const std::string& kind, bool outdoors) const;

  const nlohmann::json& radiance_;
  std::vector<std::string> unknown_;
};

}  // namespace patchlight
