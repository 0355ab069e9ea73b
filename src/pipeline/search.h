#pragma once

#include "pipeline/run.h"

#include <optional>
#include <vector>

namespace patchlight {

/// The refinement loop: finer meshes, with more samples where noise dominates, until the plan's accuracy is reached or
/// its time is up. It switches to rows of rays if the pairs of the next mesh do not fit into memory, unless the request
/// sets pairs or a time. Without a requested accuracy there is one mesh, and a second one if
/// AccuracyOptions::local_cuts reduce the error enough.
class Search {
 public:
  /// Starts the clock. `run` must outlive the search.
  explicit Search(const Run& run);

  /// The first mesh: Steps::mesh if given, else first_mesh().
  MeshToSolve first() const;

  /// Keeps a solution, with Steps::keeps_unfinished, in case the run stops before a better one exists. The first mesh
  /// is kept before its errors are known, later ones with their errors, as long as memory permits.
  void keep(const Simulation& simulation);
  /// The last kept solution.
  const std::optional<Simulation>& kept() const { return kept_; }

  /// Adds the accuracy of all meshes so far to a solved mesh, for Steps::look during refinement.
  SolvedMesh noted(SolvedMesh solved);

  /// The next mesh after one passed to noted(); empty when its accuracy is sufficient or time is up. Moves everything
  /// that the next mesh can reuse out of `solved`. \throws MemoryError, with the reachable accuracy, when the requested
  /// accuracy needs more memory than allowed.
  std::optional<MeshToSolve> next(SolvedMesh& solved);

 private:
  struct Refinement;
  struct Finer;
  AccuracyStep step_of(const SolvedMesh& solved) const;
  bool may_go_by_rays(const Plan& plan) const;
  Plan gone_by_rays(const Plan& plan);
  std::optional<MeshToSolve> next_by_pairs(SolvedMesh& solved, double accuracy);
  std::optional<MeshToSolve> next_by_rays(SolvedMesh& solved, double accuracy);
  std::optional<MeshToSolve> second(SolvedMesh& solved);
  MeshToSolve remembered(MeshToSolve next, bool keeps_known);
  Plan stored_for(const SolvedMesh& solved, double accuracy);
  Finer finer(const SolvedMesh& solved, double accuracy, const Plan& plan) const;
  Refinement refinement(const SolvedMesh& solved, double accuracy, const Plan& plan) const;
  double times_in_time() const;

  const Run& run_;
  double start_;      // wall-clock seconds
  double cpu_start_;  // processor seconds
  std::vector<AccuracyStep> steps_;
  Diagnostics notes_;
  std::optional<Simulation> kept_;
  PatchIndex known_ = 0;  // patches of the last mesh with quantities known from the previous one
  MoreRays more_rays_;    // of the last mesh
};

}  // namespace patchlight
