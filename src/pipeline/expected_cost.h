#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include <cstddef>

namespace patchlight {

/// The estimated cost of a run, before it begins.
struct ExpectedCost {
  std::size_t patches = 0;
  double bytes = 0;                 ///< of memory, at the peak
  double form_factor_seconds = 0;   ///< processor seconds, also the next two
  double direct_light_seconds = 0;  ///< light of luminaires, sun and sky
  double solve_seconds = 0;         ///< with closure
  std::size_t sensors = 0;          ///< of the scene
  double sensor_seconds = 0;  ///< processor seconds of the sensors; not in seconds(), which ends with the solution
  int threads = 1;
  bool of_first_mesh = false;  ///< patches are refined: the cost of the first mesh only

  /// Wall-clock seconds with all threads busy, until the solution.
  double seconds() const { return (form_factor_seconds + direct_light_seconds + solve_seconds) / threads; }
};

/// Estimates the cost for the patches of a mesh and the plan. Form factors are estimated from a sample of pairs of
/// patches, the rest from counts and measured rates. Accurate to about a factor of two.
ExpectedCost expected_cost(const Scene& scene, const Plan& plan, const PatchMesh& mesh);

}  // namespace patchlight
