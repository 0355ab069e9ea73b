#include "scene/coincident.h"

#include <algorithm>
#include <numeric>

namespace patchlight {
namespace {

using Loop = std::vector<std::uint32_t>;

// A polygon's corners in an order that does not depend on where its outline begins and which way it goes.
struct Key {
  Loop loop;
  bool reversed = false;
};

// Of all rotations the one that comes first.
Loop first_rotation(const Loop& loop) {
  const std::uint32_t least = *std::min_element(loop.begin(), loop.end());
  Loop best;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (loop[k] != least) continue;
    Loop rotated(loop.begin() + static_cast<std::ptrdiff_t>(k), loop.end());
    rotated.insert(rotated.end(), loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(k));
    if (best.empty() || rotated < best) best = std::move(rotated);
  }
  return best;
}

Key key_of(const Loop& corners) {
  Loop forward = first_rotation(corners);
  Loop backward = first_rotation(Loop(corners.rbegin(), corners.rend()));
  if (backward < forward) return {std::move(backward), true};
  return {std::move(forward), false};
}

}  // namespace

Coincidence find_coincident(const Scene& scene) {
  std::vector<Key> keys;
  keys.reserve(scene.polygons.size());
  for (const Polygon& polygon : scene.polygons) keys.push_back(key_of(polygon.corners));
  std::vector<PolygonIndex> order(keys.size());
  std::iota(order.begin(), order.end(), PolygonIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](PolygonIndex a, PolygonIndex b) { return keys[a].loop < keys[b].loop; });

  Coincidence found{{}, std::vector<std::uint8_t>(keys.size(), 0)};
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && keys[order[end]].loop == keys[order[begin]].loop) ++end;
    for (std::size_t k = begin + 1; k < end; ++k) {
      found.pairs.push_back({order[begin], order[k], keys[order[begin]].reversed == keys[order[k]].reversed});
      found.is_second[order[k]] = 1;
    }
  }
  std::sort(found.pairs.begin(), found.pairs.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return found;
}

}  // namespace patchlight
