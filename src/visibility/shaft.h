#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A half space: normal . x <= offset.
struct HalfSpace {
  Vector normal;
  double offset = 0;
};

/// Bounds of a group of points along 32 directions, relative to the scene.
struct alignas(64) Slabs {
  static constexpr std::size_t count = 32;
  std::array<float, count> lowest;
  std::array<float, count> highest;
};

/// Tests whether anything can stand between two groups of surfaces: their shaft is the convex hull of both (Haines and
/// Wallace 1994, Shaft Culling for Efficient Ray-Cast Radiosity).
class ShaftCuller {
 public:
  /// `left_out` has one entry per polygon: polygons with 1 cannot block anything.
  ShaftCuller(const Scene& scene, const std::vector<std::uint8_t>& left_out);

  Slabs slabs(std::span<const Point> points) const;

  /// True when no polygon reaches into the shaft of the two groups by more than 1e-6 of the scene's extent.
  /// Conservative: never true when something does, but may be false when nothing does. Polygons inside one of the half
  /// spaces do not count: they lie behind the plane of a group that faces away from them. O(log polygons) in the usual
  /// case.
  bool is_empty(const Slabs& first, const Slabs& second, const std::optional<HalfSpace>& behind_first,
                const std::optional<HalfSpace>& behind_second) const;

 private:
  struct Node {
    Slabs slabs;
    std::uint32_t next = 0;  // the next node if this one is outside the shaft
    bool is_leaf = false;
  };
  void add_nodes(std::span<std::uint32_t> polygons, const std::vector<Slabs>& of_polygon);

  Point centre_ = Point::Zero();
  double scale_ = 1;
  std::vector<Node> nodes_;  // depth first
};

}  // namespace patchlight
