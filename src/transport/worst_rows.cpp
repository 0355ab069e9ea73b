#include "transport/worst_rows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace patchlight {

std::vector<RowDefect> worst_rows(const Eigen::VectorXd& row_sum, const LostShare& lost, const Eigen::VectorXd& area,
                                  std::size_t count) {
  if (row_sum.size() == 0) return {};
  assert(row_sum.size() == area.size() && row_sum.size() == lost.escaped.size());
  const Eigen::ArrayXd expected = expected_row_sum(lost);
  const Eigen::ArrayXd defect = area.array() * (row_sum.array() - expected).abs();

  std::vector<PatchIndex> order(static_cast<std::size_t>(row_sum.size()));
  std::iota(order.begin(), order.end(), PatchIndex{0});
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), end, order.end(),
                    [&](PatchIndex a, PatchIndex b) { return defect[a] != defect[b] ? defect[a] > defect[b] : a < b; });

  std::vector<RowDefect> worst;
  for (auto patch = order.begin(); patch != end; ++patch) {
    worst.push_back({*patch, row_sum[*patch], expected[*patch]});
  }
  return worst;
}

}  // namespace patchlight
