#include "transport/group_exchange.h"

#include <cassert>

namespace patchlight {
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups) {
  assert(group_of.size() == S.size());
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(groups, groups);
  for (PatchIndex i = 0; i < S.size(); ++i) {
    for (PatchIndex j = i; j < S.size(); ++j) upper(group_of[i], group_of[j]) += static_cast<double>(S.at(i, j));
  }
  // Each pair was met once; the diagonal of S is zero.
  return upper + upper.transpose();
}

}  // namespace patchlight
