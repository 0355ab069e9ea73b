#include "scene/window_areas.h"

#include "scene/room_body.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

namespace patchlight {
namespace {

// Metres.
constexpr std::array<double, 6> distances = {0.01, 0.1, 0.2, 0.3, 0.4, 0.5};

// The room that is nearest to the point along a direction.
std::optional<std::size_t> room_along(const std::vector<RoomBody>& rooms, const Point& from, const Vector& direction) {
  for (const double distance : distances) {
    const auto holds = [&](const RoomBody& room) { return room.holds(from + distance * direction); };
    const auto found = std::find_if(rooms.begin(), rooms.end(), holds);
    if (found != rooms.end()) return static_cast<std::size_t>(found - rooms.begin());
  }
  return std::nullopt;
}

}  // namespace

std::vector<double> window_areas(const Scene& scene) {
  std::vector<RoomBody> rooms;
  for (const NamedRoom& room : scene.rooms) rooms.emplace_back(room.faces);
  std::vector<double> areas(rooms.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_opening(scene, p)) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    const Vector across = area_vector(corners);
    const double area = across.norm();
    if (!(area > 0)) continue;
    const Point middle = area_centroid(corners);
    const std::optional<std::size_t> before = room_along(rooms, middle, across / area);
    const std::optional<std::size_t> behind = room_along(rooms, middle, -across / area);
    if (before.has_value() != behind.has_value()) areas[before ? *before : *behind] += area;
  }
  return areas;
}

}  // namespace patchlight
