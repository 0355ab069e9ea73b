#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/sampling_error.h"

#include <Eigen/Core>
#include <cstdint>

namespace patchlight {

/// The known errors of a mesh's exchange areas.
struct ErrorsOfEntries {
  const PatchMesh& mesh;
  const Eigen::VectorXd& area;  ///< m^2, exposed
  const EntryErrors& errors;
  const SamplingError& sampling;
};

/// Random sampling errors of a product with the exchange areas: D X for each of `draws` random symmetric matrices D_ij
/// = +-sigma_ij with independent signs. sigma is the standard error of an estimated entry. For an entry whose rays
/// agreed it is the pooled error of such entries, as a share of the unoccluded exchange area between the patches'
/// centroids. Columns: those of x for the first draw, then for the second, ...; m^2 times the unit of x. O(size^2). The
/// same bits for any number of threads.
Field random_errors(const ErrorsOfEntries& of, const FieldView& x, int draws, std::uint64_t seed);

/// Their variances as a matrix: sum_j sigma_ij^2 x_j, m^4 times the unit of x. O(size^2). The same bits for any number
/// of threads.
Field by_variances(const ErrorsOfEntries& of, const FieldView& x);

}  // namespace patchlight
