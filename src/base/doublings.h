#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace patchlight {

/// 2^d for each of `size` doublings d; 1 for all where there are none.
inline Eigen::ArrayXd multiples(std::span<const std::uint8_t> doublings, Eigen::Index size) {
  assert(doublings.empty() || doublings.size() == static_cast<std::size_t>(size));
  Eigen::ArrayXd times = Eigen::ArrayXd::Ones(size);
  for (std::size_t i = 0; i < doublings.size(); ++i) times[static_cast<Eigen::Index>(i)] = std::exp2(doublings[i]);
  return times;
}

}  // namespace patchlight
