#pragma once

#include "patchlight/light/material.h"

#include "input/mitsuba_file.h"

#include <string>
#include <vector>

namespace patchlight {

/// What stands for a BSDF of Mitsuba.
struct MitsubaMaterial {
  Material material;
  bool is_nothing = false;              ///< light passes as if the surface were not there
  std::vector<std::string> simplified;  ///< what is not carried, for notes
};

/// The material of a BSDF: diffuse ones and the diffuse part of others as they are, dielectrics as panes, smooth
/// conductors as mirrors, other glossy surfaces matt. Nested ones count through their wrappers. An empty node stands
/// for a surface without a BSDF. \throws InputError naming the line.
MitsubaMaterial mitsuba_material(const MitsubaFile& file, const pugi::xml_node& bsdf, const std::string& name);

}  // namespace patchlight
