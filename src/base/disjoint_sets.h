#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace patchlight {

/// Sets of the numbers 0 to count - 1, each in a set of its own at first (union-find with path halving; Tarjan and van
/// Leeuwen 1984). The root of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : link_(count) { std::iota(link_.begin(), link_.end(), std::uint32_t{0}); }

  std::uint32_t root(std::uint32_t i) {
    while (link_[i] != i) i = link_[i] = link_[link_[i]];
    return i;
  }

  /// Joins the sets of two numbers. Returns false when both are in one set already.
  bool join(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = root(i);
    const std::uint32_t b = root(j);
    link_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> link_;
};

}  // namespace patchlight
