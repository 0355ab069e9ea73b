#include "patchlight/scene/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

namespace patchlight {
namespace {

// A cell of a grid that is coarse against the distance: few points have to look into a second cell.
using Cell = std::array<std::int64_t, 3>;
constexpr double cells_per_distance = 0.125;

// Points farther away share the outermost cells.
constexpr double last_cell = 1e15;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    // FNV-1a (Fowler, Noll, Vo) by words
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const std::int64_t index : cell) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x100000001b3U;
    return static_cast<std::size_t>(hash ^ (hash >> 32U));
  }
};

std::int64_t cell_at(double coordinate) {
  return static_cast<std::int64_t>(std::floor(std::clamp(coordinate, -last_cell, last_cell)));
}

Cell cell_at(const Vector& at) { return {cell_at(at.x()), cell_at(at.y()), cell_at(at.z())}; }

}  // namespace

double weld_distance(const Box& bounds) {
  if (bounds.isEmpty()) return 0;
  const double farthest = bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).maxCoeff();
  return std::max(weld_tolerance * bounds.sizes().maxCoeff(), 4 * std::numeric_limits<double>::epsilon() * farthest);
}

std::vector<std::uint32_t> welded(std::span<const Point> points, double distance) {
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> stands_for(points.size());
  if (points.empty()) return stands_for;
  // Of a model whose size is near the smallest double the quotient would be infinite.
  const double scale = distance > 0 ? std::min(cells_per_distance / distance, std::numeric_limits<double>::max()) : 0;
  const Vector reach = Vector::Constant(cells_per_distance);

  std::unordered_map<Cell, std::uint32_t, CellHash> last_in_cell;  // the head of a list, linked by `previous`
  std::vector<std::uint32_t> previous(points.size(), none);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    // The first of those in reach that stand for themselves.
    const Vector at = scale * (points[v] - points[0]);
    const Cell low = cell_at(Vector(at - reach));
    const Cell high = cell_at(Vector(at + reach));
    std::uint32_t first = v;
    const auto look_into = [&](const Cell& cell) {
      const auto found = last_in_cell.find(cell);
      for (std::uint32_t k = found == last_in_cell.end() ? none : found->second; k != none; k = previous[k]) {
        if (k < first && (points[k] - points[v]).norm() <= distance) first = k;
      }
    };
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) look_into({x, y, z});
      }
    }
    stands_for[v] = first;
    if (first != v) continue;
    const auto [head, is_new] = last_in_cell.emplace(cell_at(at), v);
    if (!is_new) previous[v] = std::exchange(head->second, v);
  }
  return stands_for;
}

}  // namespace patchlight
