#pragma once

#include "patchlight/base/field.h"
#include "patchlight/transport/half_differences.h"

#include <cstdint>

namespace patchlight {

/// Random sampling errors of a product with the exchange areas: D X for each of `draws` random symmetric matrices with
/// the differences D_ij, with new random signs. Columns: those of x for the first draw, then for the second, ...;
/// m^2 times the unit of x. O(size^2). The same bits for any number of threads.
Field random_errors(const HalfDifferences& differences, const FieldView& x, int draws, std::uint64_t seed);

/// Their variances: sum_j D_ij^2 x_j, m^4 times the unit of x. O(size^2). The same bits for any number of threads.
Field by_variances(const HalfDifferences& differences, const FieldView& x);

}  // namespace patchlight
