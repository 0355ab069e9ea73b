#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "transport/lamp_factors.h"
#include "transport/ray_rows.h"

#include <array>
#include <vector>

namespace patchlight {

/// What passes between the patches of a mesh, by rows of rays. Geometry alone decides the form factors; which lamps are
/// found apart from the rows, and towards which bright patches rays are sent on purpose, follows from the light that
/// there was when they were traced, so that other light scatters more.
struct RayExchange {
  TracedRows rows;
  std::vector<PatchRange> lamps;  ///< what is found apart: the patches of a side each, which emit alike
  LampFactors lamp_factors;       ///< per patch and lamp
  std::vector<std::array<double, 2>> specular_kinds = {};  ///< SpecularFaces::kinds() of the polygons by which rows
                                                           ///< were traced; empty where none is specular
};

}  // namespace patchlight
