#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/material.h"

#include "input/xml_file.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// The materials of the two sides of a surface: the front is the side from which its corners run counter-clockwise.
struct GbxmlSides {
  Material front;
  std::optional<Material> back;  ///< where it is another one
};

/// The materials of a building by the kinds of its surfaces and openings.
class GbxmlMaterials {
 public:
  explicit GbxmlMaterials(const XmlFile& xml);

  /// Of a kind of surface, as InteriorFloor. What lies level has a top, as floors have it, and an underside, as
  /// ceilings; `normal` is that of its front.
  GbxmlSides surface(const std::string& kind, const Vector& normal) const;

  /// Of an opening: a pane where its kind is a window, a skylight or a sliding door, or its windowTypeIdRef names a
  /// type that lets light through; else a door.
  Material opening(const pugi::xml_node& opening);

  /// Names of windows whose type states no visible transmittance.
  const std::vector<std::string>& assumed() const { return assumed_; }

 private:
  std::map<std::string, pugi::xml_node> window_types_;  // by id
  std::vector<std::string> assumed_;
};

/// The reflectances that are taken, as a sentence.
std::string usual_reflectances();

}  // namespace patchlight
