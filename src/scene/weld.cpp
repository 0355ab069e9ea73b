#include "scene/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// A cell of a grid that is coarse against the distance: few points have to look into a second cell.
using Cell = std::array<std::int64_t, 3>;
constexpr double cells_per_distance = 0.125;

// Points farther away share the outermost cells.
constexpr double last_cell = 1e15;

std::size_t hash_of(const Cell& cell) {
  // FNV-1a (Fowler, Noll, Vo) by words
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::int64_t index : cell) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x100000001b3U;
  return static_cast<std::size_t>(hash ^ (hash >> 32U));
}

std::int64_t cell_at(double coordinate) {
  return static_cast<std::int64_t>(std::floor(std::clamp(coordinate, -last_cell, last_cell)));
}

Cell cell_at(const Vector& at) { return {cell_at(at.x()), cell_at(at.y()), cell_at(at.z())}; }

constexpr std::uint32_t no_point = ~std::uint32_t{0};

// The points that stand for themselves by their cells, those of one cell in a list. A table with open addresses (Knuth,
// volume 3, section 6.4, algorithm L) of the lists' heads alone: a cell is that of its head.
class PointsByCell {
 public:
  PointsByCell(std::span<const Point> points, double scale)
      : points_(points),
        scale_(scale),
        heads_(std::bit_ceil(2 * points.size()), no_point),
        previous_(points.size(), no_point) {}

  Vector place(std::uint32_t point) const { return scale_ * (points_[point] - points_[0]); }
  std::uint32_t last_in(const Cell& cell) const { return heads_[slot_of(cell)]; }
  std::uint32_t before(std::uint32_t point) const { return previous_[point]; }
  void add(std::uint32_t point) {
    std::uint32_t& head = heads_[slot_of(cell_at(place(point)))];
    previous_[point] = std::exchange(head, point);
  }

 private:
  // Of the cell, or the free one where it belongs.
  std::size_t slot_of(const Cell& cell) const {
    std::size_t slot = hash_of(cell) & (heads_.size() - 1);
    while (heads_[slot] != no_point && cell_at(place(heads_[slot])) != cell) slot = (slot + 1) & (heads_.size() - 1);
    return slot;
  }

  std::span<const Point> points_;
  double scale_;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> previous_;
};

}  // namespace

double weld_distance(const Box& bounds) {
  if (bounds.isEmpty()) return 0;
  const double farthest = bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).maxCoeff();
  return std::max(weld_tolerance * bounds.sizes().maxCoeff(), 4 * std::numeric_limits<double>::epsilon() * farthest);
}

std::vector<std::uint32_t> welded(std::span<const Point> points, double distance) {
  std::vector<std::uint32_t> stands_for(points.size());
  if (points.empty()) return stands_for;
  // Of a model whose size is near the smallest double the quotient would be infinite.
  const double scale = distance > 0 ? std::min(cells_per_distance / distance, std::numeric_limits<double>::max()) : 0;
  const Vector reach = Vector::Constant(cells_per_distance);
  PointsByCell by_cell(points, scale);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    // The first of those in reach that stand for themselves.
    const Vector at = by_cell.place(v);
    const Cell low = cell_at(Vector(at - reach));
    const Cell high = cell_at(Vector(at + reach));
    std::uint32_t first = v;
    const auto look_into = [&](const Cell& cell) {
      for (std::uint32_t k = by_cell.last_in(cell); k != no_point; k = by_cell.before(k)) {
        if (k < first && (points[k] - points[v]).norm() <= distance) first = k;
      }
    };
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) look_into({x, y, z});
      }
    }
    stands_for[v] = first;
    if (first == v) by_cell.add(v);
  }
  return stands_for;
}

}  // namespace patchlight
