#pragma once

#include "pipeline/run.h"

#include <optional>
#include <vector>

namespace patchlight {

/// The way to an accuracy: finer and finer meshes, with more samples where their noise limits it, until the plan's
/// accuracy is reached or its time is up; by rows of rays where all pairs of the next mesh do not fit into the memory,
/// unless these or a time were asked for. A run that asks for none has one mesh, and a second one where
/// AccuracyOptions::local_cuts pay.
class Search {
 public:
  /// Time counts from here on. `run` has to outlive the search.
  explicit Search(const Run& run);

  /// The mesh to begin with: Steps::mesh, else first_mesh().
  MeshToSolve first() const;

  /// Keeps a solution, where Steps::keeps_unfinished, in case the run is stopped before there is a better one: that of
  /// the first mesh before its errors are known, every later one with them, as long as the memory has room for it.
  void keep(const Simulation& simulation);
  /// The last kept solution.
  const std::optional<Simulation>& kept() const { return kept_; }

  /// The solved mesh with the accuracy of all meshes until now, as Steps::look gets it on the way to an accuracy.
  SolvedMesh noted(SolvedMesh solved);

  /// The next mesh after one that was noted; none when that is good enough, or time is up. Takes from `solved` all that
  /// the next one can use. \throws MemoryError when the accuracy takes more memory than the request allows, with the
  /// accuracy that can be reached.
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
  PatchIndex known_ = 0;  // patches of the last mesh of which something was known from the one before
  MoreRays more_rays_;    // of the last mesh
};

}  // namespace patchlight
