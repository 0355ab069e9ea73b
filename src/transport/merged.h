#pragma once

#include "patchlight/base/field.h"
#include "patchlight/transport/exchange_areas.h"

#include "mesh/nested_mesh.h"
#include "transport/closure.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace patchlight {

/// Exchange areas between groups of patches in m^2: entry (G, H) is the sum of S_ij over the patches i of G and j of H,
/// so that F_GH = S_GH / A_G. Symmetric. `group_of` has one number below `groups` per patch. O(size^2).
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups);

/// The exchange areas between the parents of a mesh from those between its patches: their sums, S_GH = sum_{i in G, j
/// in H} S_ij. No ray is traced; row sums and closure carry over. O(size^2).
ClosedExchangeAreas merged(const ClosedExchangeAreas& closed, const NestedMesh& mesh);

/// What it changes elsewhere that the patches of a parent differ: for each parent G
/// sum over bands and patches i of weight_i (sum_{c in G} S_ic difference_c)^2, with the difference of each patch from
/// its parent's mean. O(size^2).
Eigen::VectorXd effects_of_parts(const ExchangeAreas& S, const NestedMesh& mesh, const FieldView& difference,
                                 const FieldView& weight);

}  // namespace patchlight
