#include "scene/room_body.h"

#include "scene/extent.h"
#include "scene/face_tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// Does the ray from the origin meet the triangle? Moeller and Trumbore 1997.
bool meets(const Vector& direction, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a;
  const Vector across = direction.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return false;
  const double u = -a.dot(across) / determinant;
  const Vector q = (-a).cross(ab);
  const double v = direction.dot(q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && ac.dot(q) / determinant > 0;
}

// Triangles of a fan overlap outside of a polygon that is not convex, an even number of times.
bool is_inside(const std::vector<std::vector<Point>>& faces, const Point& point, const Vector& direction) {
  std::size_t crossings = 0;
  for (const std::vector<Point>& face : faces) {
    for (std::size_t k = 2; k < face.size(); ++k)
      crossings += meets(direction, face[0] - point, face[k - 1] - point, face[k] - point) ? 1 : 0;
  }
  return crossings % 2 == 1;
}

// Meters.
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

constexpr double under_top = 0.1;  // of the room's height

// The number of points to test whether the solid holds them: 1e7 tests of triangles take about half a second.
std::size_t most_points(const Solid& solid) { return std::max<std::size_t>(16, 10'000'000 / solid.triangles.size()); }

// So many of them, spread evenly over all.
std::vector<PolygonIndex> spread_evenly(const std::vector<PolygonIndex>& polygons, std::size_t count) {
  if (polygons.size() <= count) return polygons;
  std::vector<PolygonIndex> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(polygons[k * polygons.size() / count]);
  return chosen;
}

// One polygon of each shell but that of the hull, and but those far from the scene.
std::vector<PolygonIndex> other_shells(const Scene& scene, const Shells& shells, const Solid& hull) {
  const std::vector<PolygonIndex> far = far_polygons(scene);
  const PolygonIndex of_hull = shells.shell[hull.polygons.front()];
  std::vector<PolygonIndex> others;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool is_first = shells.shell[p] == p && p != of_hull;
    if (is_first && !std::binary_search(far.begin(), far.end(), p)) others.push_back(p);
  }
  return others;
}

// Is all else inside? A polygon on the hull has one of its sides inside.
bool holds_all_else(const Scene& scene, const Shells& shells, const Solid& hull, double extent) {
  const std::vector<PolygonIndex> others = spread_evenly(other_shells(scene, shells, hull), most_points(hull));
  return std::all_of(others.begin(), others.end(), [&](PolygonIndex p) {
    return holds(hull, point_before(scene, p, Side::front, extent)) ||
           holds(hull, point_before(scene, p, Side::back, extent));
  });
}

struct CeilingTriangle {
  double area = 0;  // twice its area, m^2
  Point middle;
};

// The triangles of a room that look down into it, by 45 degrees or less, the largest first, at most so many.
std::vector<CeilingTriangle> largest_of_ceiling(const Scene& scene, const Solid& room, std::size_t count) {
  std::vector<CeilingTriangle> ceiling;
  for (const auto& [a, b, c] : room.triangles) {
    const Vector inward = (room.fronts_face_inside ? 1.0 : -1.0) * (b - a).cross(c - a);
    const double area = inward.norm();
    if (area > 0 && -inward.dot(scene.up) >= 0.7 * area) ceiling.push_back({area, (a + b + c) / 3});
  }
  std::stable_sort(ceiling.begin(), ceiling.end(),
                   [](const CeilingTriangle& a, const CeilingTriangle& b) { return a.area > b.area; });
  if (ceiling.size() > count) ceiling.resize(count);
  return ceiling;
}

}  // namespace

RoomBody::RoomBody(const std::vector<std::vector<Point>>& faces) : faces_(faces) {
  for (const std::vector<Point>& face : faces_) {
    for (const Point& corner : face) box_.extend(corner);
  }
}

bool RoomBody::holds(const Point& point) const {
  if (!box_.contains(point)) return false;
  // An edge that one ray just meets is counted twice or not at all: two of three decide.
  const std::array<Vector, 3> directions = {Vector(0.5377, 0.2113, 0.8163), Vector(-0.7071, 0.6433, 0.2937),
                                            Vector(0.1931, -0.8701, 0.4535)};
  const auto votes = std::count_if(directions.begin(), directions.end(),
                                   [&](const Vector& direction) { return is_inside(faces_, point, direction); });
  return votes >= 2;
}

double RoomBody::step() const { return box_.isEmpty() ? 0 : 1e-3 * box_.diagonal().norm(); }

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

std::optional<Solid> sealed_hull(const Scene& scene) {
  const Box all = main_bounds(scene);
  const double extent = extent_of(scene);
  const double touching = weld_distance(scene);
  SceneGeometry geometry = compute_geometry(scene);
  for (Solid& solid : geometry.solids) {
    if (!solid.has_opening && with_margin(solid.box, touching).contains(all) &&
        holds_all_else(scene, geometry.shells, solid, extent))
      return std::move(solid);
  }
  return std::nullopt;
}

bool is_room(const Scene& scene, const Solid& hull) {
  return hull.fronts_face_inside || hull.polygons.size() < scene.polygons.size() || !scene.rooms.empty();
}

std::optional<Point> place_under_ceiling(const Scene& scene, const Solid& room) {
  const double height = room.box.sizes().dot(scene.up.cwiseAbs());
  const Point over_middle = room.box.center() + (0.5 - under_top) * height * scene.up;
  if (holds(room, over_middle)) return over_middle;
  for (const CeilingTriangle& part : largest_of_ceiling(scene, room, most_points(room))) {
    const Point below = part.middle - under_top * height * scene.up;
    if (holds(room, below)) return below;
  }
  return std::nullopt;
}

}  // namespace patchlight
