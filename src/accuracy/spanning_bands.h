#pragma once

#include "patchlight/base/field.h"

#include "accuracy/errors.h"
#include "solve/solved_bands.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// A few bands of a field of which the others are combinations: the light of one lamp on some paints has far fewer
/// degrees of freedom than bands.
struct SpanningBands {
  std::vector<Eigen::Index> bands;  ///< of the field
  Eigen::MatrixXd weights;          ///< a column for each band of the field, a row for each of `bands`

  /// True when every band is its own.
  bool spans_all() const { return weights.rows() == weights.cols(); }
  /// The columns of `bands`.
  Field of(const FieldView& field) const;
  /// All bands of what depends linearly on the field, from its values in `bands`.
  Field all_bands(const FieldView& in_bands) const;
};

/// Enough bands that every one is a combination of theirs but for `tolerance` of its norm, sqrt(sum_i A_i x_i^2). Up to
/// three bands stay as they are. Bands in which all is 0 take none. The same bits for any number of threads.
SpanningBands spanning_bands(const FieldView& field, const Eigen::VectorXd& area, double tolerance);

/// A solved problem in the bands that solved_bands() names: what is linear in the light is the same for the others, but
/// for a factor.
struct InNeededBands {
  SolvedBands bands;
  RadiosityProblem problem;
  Solution solution;  ///< without directs, ambient and error

  SolvedProblem solved() const { return {problem, solution}; }
};

InNeededBands in_needed_bands(const SolvedProblem& solved);

}  // namespace patchlight
