#include "visibility/shaft.h"

#include "base/target_clones.h"
#include "scene/extent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace patchlight {
namespace {

// Polygons that reach less far into a shaft do not count; share of the scene's extent.
constexpr float slack = 1e-6F;

// The three axes, the directions halfway between them, and a spiral over the hemisphere (Swinbank and Purser 2006).
std::array<Vector, Slabs::count> make_directions() {
  std::array<Vector, Slabs::count> directions{Vector::UnitX(), Vector::UnitY(), Vector::UnitZ()};
  std::size_t count = 3;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const bool is_first_of_pair = std::array{x, y, z} > std::array{0, 0, 0};
        const bool is_axis = x * x + y * y + z * z == 1;
        if (is_first_of_pair && !is_axis) directions[count++] = Vector(x, y, z).normalized();
      }
    }
  }
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const std::size_t spiral = directions.size() - count;
  for (std::size_t k = 0; k < spiral; ++k) {
    const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(spiral);
    const double angle = golden_angle * static_cast<double>(k);
    directions[count++] = Vector(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
  }
  return directions;
}

const std::array<Vector, Slabs::count>& directions() {
  static const std::array<Vector, Slabs::count> all = make_directions();
  return all;
}

Slabs nothing() {
  Slabs slabs;
  slabs.lowest.fill(std::numeric_limits<float>::infinity());
  slabs.highest.fill(-std::numeric_limits<float>::infinity());
  return slabs;
}

PATCHLIGHT_INLINE Slabs both(Slabs slabs, const Slabs& other) {
  for (std::size_t d = 0; d < Slabs::count; ++d) {
    slabs.lowest[d] = std::min(slabs.lowest[d], other.lowest[d]);
    slabs.highest[d] = std::max(slabs.highest[d], other.highest[d]);
  }
  return slabs;
}

PATCHLIGHT_INLINE bool apart(const Slabs& a, const Slabs& b) {
  int separated = 0;
  for (std::size_t d = 0; d < Slabs::count; ++d) {
    separated |=
        static_cast<int>(a.highest[d] - slack <= b.lowest[d]) | static_cast<int>(a.lowest[d] + slack >= b.highest[d]);
  }
  return separated != 0;
}

// A half space in the frame of the slabs.
struct Plane {
  float x, y, z, offset;
};

// Whether the box of the slabs, as given by the axes, lies in a half space.
PATCHLIGHT_INLINE bool inside(const Slabs& slabs, const Plane& plane) {
  const auto farthest = [&](std::size_t axis, float component) {
    return component * (component > 0 ? slabs.highest[axis] : slabs.lowest[axis]);
  };
  return farthest(0, plane.x) + farthest(1, plane.y) + farthest(2, plane.z) <= plane.offset + slack;
}

}  // namespace

ShaftCuller::ShaftCuller(const Scene& scene, const std::vector<std::uint8_t>& left_out) {
  const Box box = main_bounds(scene);
  centre_ = box.center();
  scale_ = 1 / box.diagonal().norm();
  std::vector<Slabs> of_polygon;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!left_out[p]) of_polygon.push_back(slabs(corner_points(scene, p)));
  }
  std::vector<std::uint32_t> order(of_polygon.size());
  std::iota(order.begin(), order.end(), 0U);
  if (!order.empty()) add_nodes(order, of_polygon);
}

void ShaftCuller::add_nodes(std::span<std::uint32_t> polygons, const std::vector<Slabs>& of_polygon) {
  const std::size_t own = nodes_.size();
  nodes_.push_back({nothing(), 0, polygons.size() == 1});
  for (const std::uint32_t polygon : polygons) nodes_[own].slabs = both(nodes_[own].slabs, of_polygon[polygon]);
  if (polygons.size() > 1) {
    // Halved along the direction in which the middles spread most.
    const Slabs& whole = nodes_[own].slabs;
    std::size_t widest = 0;
    for (std::size_t d = 1; d < 3; ++d) {
      if (whole.highest[d] - whole.lowest[d] > whole.highest[widest] - whole.lowest[widest]) widest = d;
    }
    const auto middle = [&](std::uint32_t p) { return of_polygon[p].lowest[widest] + of_polygon[p].highest[widest]; };
    const std::size_t half = polygons.size() / 2;
    std::nth_element(polygons.begin(), polygons.begin() + static_cast<std::ptrdiff_t>(half), polygons.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
    add_nodes(polygons.first(half), of_polygon);
    add_nodes(polygons.subspan(half), of_polygon);
  }
  nodes_[own].next = static_cast<std::uint32_t>(nodes_.size());
}

Slabs ShaftCuller::slabs(std::span<const Point> points) const {
  Slabs result = nothing();
  for (const Point& point : points) {
    const Vector position = scale_ * (point - centre_);
    for (std::size_t d = 0; d < Slabs::count; ++d) {
      const auto height = static_cast<float>(directions()[d].dot(position));
      result.lowest[d] = std::min(result.lowest[d], height);
      result.highest[d] = std::max(result.highest[d], height);
    }
  }
  return result;
}

PATCHLIGHT_TARGET_CLONES
bool ShaftCuller::is_empty(const Slabs& first, const Slabs& second, const std::optional<HalfSpace>& behind_first,
                           const std::optional<HalfSpace>& behind_second) const {
  const Slabs shaft = both(first, second);
  const auto plane_of = [&](const std::optional<HalfSpace>& half) {
    // An empty half space stands for none.
    if (!half) return Plane{0, 0, 0, -1};
    const Vector n = half->normal;
    const double offset = scale_ * (half->offset - n.dot(centre_));
    return Plane{static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z()),
                 static_cast<float>(offset)};
  };
  const Plane one = plane_of(behind_first);
  const Plane other = plane_of(behind_second);
  for (std::size_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    if (apart(node.slabs, shaft) || inside(node.slabs, one) || inside(node.slabs, other)) {
      n = node.next;
    } else if (node.is_leaf) {
      return false;
    } else {
      ++n;
    }
  }
  return true;
}

}  // namespace patchlight
