#include "transport/group_exchange.h"

#include "transport/tile_edge.h"

#include <algorithm>
#include <cassert>

namespace patchlight {
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups) {
  assert(group_of.size() == S.size());
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(groups, groups);
  for (PatchIndex I = 0; I < S.blocks(); ++I) {
    for (PatchIndex i = I * tile_edge; i < std::min(S.size(), (I + 1) * tile_edge); ++i) {
      for (PatchIndex J = I; J < S.blocks(); ++J) {
        const auto row = S.tile(I, J).subspan(static_cast<std::size_t>(i % tile_edge) * tile_edge, tile_edge);
        for (PatchIndex j = std::max(i, J * tile_edge); j < std::min(S.size(), (J + 1) * tile_edge); ++j) {
          upper(group_of[i], group_of[j]) += static_cast<double>(row[j % tile_edge]);
        }
      }
    }
  }
  // Each pair was met once; the diagonal of S is zero.
  return upper + upper.transpose();
}

}  // namespace patchlight
