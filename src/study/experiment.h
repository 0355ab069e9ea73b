#pragma once

#include "study/nested_sizes.h"
#include "study/reference.h"
#include "study/study.h"

namespace patchlight {

/// What the settings of a study have in common.
struct Experiment {
  const Scene& scene;
  Request request;  ///< of the finest setting
  NestedSizes meshes;
  Observer observer;

  const SizedMesh& finest() const { return meshes.sizes.back(); }
  /// Solves on one of the meshes.
  Simulation run(const SizedMesh& on, const Request& asked, const SolveWith& solve = patchlight::solve) const;
};

/// \throws MemoryError when the reference would not fit.
Experiment experiment_for(const Scene& scene, const Request& request, int sizes, const Observer& observer);

/// What a solution has cost; its errors are left open.
StudySetting setting_of(const Simulation& simulation);

/// The setting with its errors against the reference. Its own error is that of the patch means, too.
StudySetting judged(const Simulation& simulation, const Reference& reference);

/// The setting with an own error that is due to one quantity alone: against radiosities `own` on the same mesh.
StudySetting judged(const Simulation& simulation, const Reference& reference, const FieldView& own);

}  // namespace patchlight
