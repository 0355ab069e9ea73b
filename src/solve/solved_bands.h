#pragma once

#include "patchlight/solve/solve.h"

#include <vector>

namespace patchlight {

/// Which bands have to be solved: those without light have the solution 0, and of those with the same reflectances
/// whose lamps differ by a factor one is enough.
struct SolvedBands {
  /// Where a band of the problem comes from: `factor` times the solved band `from`.
  struct Source {
    Eigen::Index from = 0;
    double factor = 0;
  };
  std::vector<Eigen::Index> solved;  ///< bands of the problem; at least one
  std::vector<Source> sources;       ///< one for each band of the problem
};

SolvedBands solved_bands(const RadiosityProblem& problem);

/// Each band as it is.
SolvedBands all_bands(const RadiosityProblem& problem);

/// The columns of the solved bands; nothing of nothing.
Field reduced(const FieldView& field, const SolvedBands& bands);

/// All bands from the solved ones.
Field expanded(const FieldView& field, const SolvedBands& bands);

/// An observer of the solved bands that tells the one of all bands. `more_irradiance`, of all bands and in none of the
/// solved ones, is added where it is given and not empty. Refers to all arguments.
Observer telling_all_bands(const Observer& observer, const SolvedBands& bands, const Field* more_irradiance = nullptr);

}  // namespace patchlight
