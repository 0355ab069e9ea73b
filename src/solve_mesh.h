#pragma once

#include "patchlight/mesh/nested_mesh.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "stage_clock.h"
#include "visibility/tracing.h"

#include <memory>
#include <optional>

namespace patchlight {

/// What a scene is solved with, on one mesh after the other.
struct Setting {
  const Scene& scene;
  std::shared_ptr<const Tracing> tracing;
  const Steps& with;
  const Observer& observer;
};

/// A mesh whose solution is wanted. Without parents there are no error bars.
struct MeshToSolve {
  NestedMesh mesh;
  std::vector<PatchIndex> place;  ///< per patch: the same one in the mesh whose exchange areas are known, or no_patch
  std::optional<Assembly> known;  ///< exchange areas of that mesh, before closure; none: all are new
  std::optional<LostShare> lost;  ///< its lost shares; none: all are new
};

/// A solved mesh.
struct SolvedMesh {
  Simulation simulation;  ///< without costs
  NestedMesh mesh;
  std::optional<Assembly> raw;  ///< with parents: exchange areas before closure
  Eigen::VectorXd interest;     ///< with parents: 1 for each patch whose error counts, else 0
  Eigen::VectorXd effects;      ///< with parents: effects_of_parents(), and of what light_bar is of
  Eigen::VectorXd noise;        ///< with parents: noise_of_parents()
  double noise_bar = 0;         ///< with parents: what shadow rays between patches err, as relative_bar()
  double light_bar = 0;         ///< with parents: and those towards luminaires, sun and sky
};

/// Form factors, closure, solution and, with parents, error bars, as the plan says. \throws Cancelled, and what the
/// steps throw.
SolvedMesh solve_mesh(const Setting& setting, const Plan& plan, MeshToSolve to_solve, StageClock& clock);

/// The mesh that the plan says, nested when error bars are wanted.
NestedMesh first_mesh(const Scene& scene, const Plan& plan);

/// Solves on first_mesh(), or on Steps::mesh.
SolvedMesh solve_mesh(const Setting& setting, const Request& request, const Plan& plan, StageClock& clock);

/// One row of what accuracy has cost. Seconds and new patches are left open.
AccuracyStep accuracy_of(const SolvedMesh& solved);

}  // namespace patchlight
