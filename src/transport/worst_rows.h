#pragma once

#include "patchlight/base/field.h"
#include "patchlight/transport/lost_share.h"

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace patchlight {

/// A row of form factors whose sum is off.
struct RowDefect {
  PatchIndex patch = 0;
  double row_sum = 0;   ///< sum_j F_ij
  double expected = 0;  ///< what is seen of other patches: 1 - lost
};

/// The `count` rows with the largest defect |row_sum - expected| times the patch's area, worst first; of equals the
/// first. Fewer where there are fewer rows, none without row sums. `area` in m^2. O(size log count).
std::vector<RowDefect> worst_rows(const Eigen::VectorXd& row_sum, const LostShare& lost, const Eigen::VectorXd& area,
                                  std::size_t count);

}  // namespace patchlight
