#pragma once

#include "patchlight/transport/exchange_areas.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace patchlight {

/// Exchange areas between groups of patches in m^2: entry (G, H) is the sum of S_ij over the patches i of G and j of H,
/// so that F_GH = S_GH / A_G. Symmetric. `group_of` has one number below `groups` per patch. O(size^2).
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups);

}  // namespace patchlight
