#pragma once

#include "patchlight/base/geometry.h"

#include <bit>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Boxes in a row, as those of a polygon's corners or edges along its outline, under a binary tree of the boxes around
/// neighbours: what holds for none of a whole stretch of the outline is found out at once.
class BoxRow {
 public:
  explicit BoxRow(std::span<const Box> boxes);

  /// The first place from `begin` on at which `is_sought(place)` holds. Stretches whose box `is_out(box)` are passed
  /// over; it has to be true of a box only when it is so of all within.
  template <class IsOut, class IsSought>
  std::optional<std::size_t> first(std::size_t begin, const IsOut& is_out, const IsSought& is_sought) const {
    return first_below(1, 0, leaves_, begin, is_out, is_sought);
  }

  /// Takes one out, so that it is never found again. O(log n).
  void remove(std::size_t place);

 private:
  template <class IsOut, class IsSought>
  std::optional<std::size_t> first_below(std::size_t node, std::size_t low, std::size_t width, std::size_t begin,
                                         const IsOut& is_out, const IsSought& is_sought) const {
    if (low + width <= begin || nodes_[node].isEmpty() || is_out(nodes_[node])) return std::nullopt;
    if (width == 1) return is_sought(low) ? std::optional(low) : std::nullopt;
    const auto left = first_below(2 * node, low, width / 2, begin, is_out, is_sought);
    return left ? left : first_below(2 * node + 1, low + width / 2, width / 2, begin, is_out, is_sought);
  }

  std::size_t leaves_;      // a power of two
  std::vector<Box> nodes_;  // the parts of node k are nodes 2 k and 2 k + 1; the whole is node 1
};

inline BoxRow::BoxRow(std::span<const Box> boxes) : leaves_(std::bit_ceil(boxes.size())), nodes_(2 * leaves_) {
  for (std::size_t k = 0; k < boxes.size(); ++k) nodes_[leaves_ + k] = boxes[k];
  for (std::size_t k = leaves_; k-- > 1;) nodes_[k] = nodes_[2 * k].merged(nodes_[2 * k + 1]);
}

inline void BoxRow::remove(std::size_t place) {
  nodes_[leaves_ + place].setEmpty();
  for (std::size_t k = (leaves_ + place) / 2; k > 0; k /= 2) nodes_[k] = nodes_[2 * k].merged(nodes_[2 * k + 1]);
}

}  // namespace patchlight
