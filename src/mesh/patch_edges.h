#pragma once

#include "patchlight/scene/scene.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace patchlight {

/// The longest edge of the patches of each polygon, metres.
struct PatchEdges {
  double max_edge = 0;
  std::vector<double> coarsest = {};  ///< per polygon: a longer edge that its patches may have; empty: none

  PatchEdges(double edge) : max_edge(edge) {}  // NOLINT(google-explicit-constructor): one edge for all polygons
  PatchEdges(double edge, std::vector<double> of_polygons) : max_edge(edge), coarsest(std::move(of_polygons)) {}

  double on(std::size_t polygon) const { return coarsest.empty() ? max_edge : std::max(max_edge, coarsest[polygon]); }
};

}  // namespace patchlight
