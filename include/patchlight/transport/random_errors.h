#pragma once

#include "patchlight/base/field.h"
#include "patchlight/transport/entry_errors.h"

#include <cstdint>

namespace patchlight {

/// What sampling errors do to a product with the exchange areas: D X for each of `draws` random symmetric matrices
/// D_ij = +-sigma_ij, with the standard errors of the estimated entries and independent signs. Columns: those of x for
/// the first draw, then for the second, ...; m^2 times the unit of x. O(size^2). The same bits for any number of
/// threads.
Field random_errors(const EntryErrors& errors, const FieldView& x, int draws, std::uint64_t seed);

}  // namespace patchlight
