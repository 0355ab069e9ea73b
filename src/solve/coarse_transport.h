#pragma once

#include "patchlight/solve/problem.h"

#include <Eigen/Core>

namespace patchlight {

/// What the rows of F that have been taken so far tell about all of it: where the light of groups of patches arrives.
/// Patches that follow each other make a group, as they mostly lie side by side; there are at most 64, so that memory
/// stays in proportion to the patches. For display and for the order of shots: nothing here changes a solution.
class CoarseTransport {
 public:
  explicit CoarseTransport(const RadiosityProblem& problem);

  /// The irradiance everywhere, `arriving`, by the radiosity `shot_radiosity` of one patch; one row per patch, and one
  /// row.
  void learn(Eigen::Index source, const Field& shot_radiosity, const Field& arriving);

  /// The patch that shoots next when `waiting` is to be shot, W/m^2: the one with the most flux, summed over the bands.
  /// Before that, each group that has any shoots once, the one with the most flux first.
  Eigen::Index next_source(const Field& waiting) const;

  /// The irradiance that unshot radiosity and all its reflections are going to add, one row per patch. A group's light
  /// is taken to arrive where that of its known rows does, and evenly everywhere to the weight of one more row; as much
  /// of that gets lost as of all light so far. 0 in bands where by this light is never lost.
  Field ambient(const Field& unshot) const;

 private:
  Eigen::Index group_of(Eigen::Index patch) const { return patch * groups_ / patches_; }

  const RadiosityProblem& problem_;
  Eigen::Index patches_;
  Eigen::Index groups_;
  Eigen::MatrixXf arriving_;  // at each patch (row) from each group (column), by unit radiosity of its known patches
  Eigen::VectorXd arrived_;   // its flux, m^2
  Eigen::VectorXd area_;      // of the known patches, m^2
};

}  // namespace patchlight
