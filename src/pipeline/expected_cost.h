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
  double form_factor_seconds = 0;   ///< processor seconds, as the next two
  double direct_light_seconds = 0;  ///< by luminaires, sun and sky
  double solve_seconds = 0;         ///< with closure
  std::size_t sensors = 0;          ///< of the scene
  double sensor_seconds = 0;        ///< of these; not in seconds(), as nothing else that looks at the solution is
  int threads = 1;
  bool of_first_mesh = false;  ///< patches are refined: the mesh to begin with alone

  /// Wall-clock seconds with all threads busy, until the solution.
  double seconds() const { return (form_factor_seconds + direct_light_seconds + solve_seconds) / threads; }
};

/// An estimate for the patches of a mesh and what the plan simulates: form factors by a look at some pairs of patches,
/// the rest by counts and rates that were measured on one machine. Right to a factor of two or so.
ExpectedCost expected_cost(const Scene& scene, const Plan& plan, const PatchMesh& mesh);

}  // namespace patchlight
