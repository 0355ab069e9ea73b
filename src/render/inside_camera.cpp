#include "render/inside_camera.h"

#include "render/render.h"
#include "scene/triangulate.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace patchlight {
namespace {

constexpr int preview_edge = 32;  // rays across and down

constexpr double outside_field_of_view = 42;  // degrees, both ways: pictures are taken as square
constexpr double inside_field_of_view = 72;
constexpr double margin = 1.04;           // of the picture's edge to the edge of an open side
constexpr double eye_height = 0.6;        // of the bounds' height: 1.6 m in a room of 2.7 m
constexpr double target_height = 0.4;     // looking slightly down
constexpr double corner_distance = 0.08;  // from the corner, in lengths of the bounds
constexpr double open_depth = 0.1;        // a ray enters when it gets so far into the bounds, in lengths of the bounds
constexpr double open_share = 0.5;        // a side is open when so many of the rays that cross it enter

// The bounds, and which of the three axes is upright.
struct Surroundings {
  Box box;
  Eigen::Index up_axis;
  bool up_is_negative;
  double height_at(double share) const {
    const double from_floor = up_is_negative ? 1 - share : share;
    return box.min()[up_axis] + from_floor * box.sizes()[up_axis];
  }
};

Surroundings surroundings(const Scene& scene) {
  Surroundings around{bounds(scene), 2, false};
  scene.up.cwiseAbs().maxCoeff(&around.up_axis);
  around.up_is_negative = scene.up[around.up_axis] < 0;
  return around;
}

// One of the four upright sides of the bounds: across `axis`, at its lower or upper end.
struct UprightSide {
  Eigen::Index axis;
  bool upper;
};

Camera view_before(const Surroundings& around, const UprightSide& side) {
  const Eigen::Index across = 3 - side.axis - around.up_axis;
  const Vector size = around.box.sizes();
  const double half_angle = outside_field_of_view * std::numbers::pi / 360;
  const double distance = 0.5 * margin * std::max(size[across], size[around.up_axis]) / std::tan(half_angle);
  Camera camera{around.box.center(), around.box.center(), outside_field_of_view};
  camera.eye[side.axis] = side.upper ? around.box.max()[side.axis] + distance : around.box.min()[side.axis] - distance;
  return camera;
}

Camera view_from_corner(const Surroundings& around, Eigen::Vector2d corner) {
  Camera camera{around.box.center(), around.box.center(), inside_field_of_view};
  const Vector size = around.box.sizes();
  int k = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis == around.up_axis) continue;
    camera.eye[axis] = around.box.center()[axis] + corner[k++] * (0.5 - corner_distance) * size[axis];
  }
  camera.eye[around.up_axis] = around.height_at(eye_height);
  camera.target[around.up_axis] = around.height_at(target_height);
  return camera;
}

// For what is flat and seen edge-on from its sides: from above one corner, and so far that everything is in the
// picture.
Camera view_from_above(const Surroundings& around) {
  const double half_angle = outside_field_of_view * std::numbers::pi / 360;
  Vector direction = Vector::Ones();
  if (around.up_is_negative) direction[around.up_axis] = -1;
  const double distance = 0.5 * margin * around.box.diagonal().norm() / std::sin(half_angle);
  return {around.box.center() + distance * direction.normalized(), around.box.center(), outside_field_of_view};
}

bool is_kept(const KeptSides& sides, const Hit& hit) {
  return (hit.side == Side::front ? sides.front : sides.back)[hit.polygon] != 0;
}

// Is most of this side of the bounds a hole through which one sees into the depth? The dark outsides of other rooms are
// no depth.
bool is_open(const Surroundings& around, const UprightSide& side, const KeptSides& sides, const Occluder& occluder) {
  const Eigen::Index across = 3 - side.axis - around.up_axis;
  const Point eye = view_before(around, side).eye;
  const Vector size = around.box.sizes();
  std::vector<Ray> rays;
  for (int row = 0; row < preview_edge; ++row) {
    for (int column = 0; column < preview_edge; ++column) {
      Point on_side = around.box.min();
      on_side[side.axis] = side.upper ? around.box.max()[side.axis] : around.box.min()[side.axis];
      on_side[across] += (column + 0.5) / preview_edge * size[across];
      on_side[around.up_axis] += (row + 0.5) / preview_edge * size[around.up_axis];
      rays.push_back({eye, (on_side - eye).normalized()});
    }
  }
  const double plane = side.upper ? around.box.max()[side.axis] : around.box.min()[side.axis];
  int entered = 0;
  for (const std::optional<Hit>& hit : occluder.first_hits(rays)) {
    if (!hit || (is_kept(sides, *hit) && std::abs(hit->point[side.axis] - plane) > open_depth * size[side.axis]))
      ++entered;
  }
  return entered >= open_share * static_cast<double>(rays.size());
}

std::vector<UprightSide> open_sides(const Surroundings& around, const KeptSides& sides, const Occluder& occluder) {
  std::vector<UprightSide> open;
  for (const Eigen::Index axis : {Eigen::Index{2}, Eigen::Index{1}, Eigen::Index{0}}) {
    for (const bool upper : {false, true}) {
      if (axis != around.up_axis && is_open(around, {axis, upper}, sides, occluder)) open.push_back({axis, upper});
    }
  }
  return open;
}

// The number of different polygons seen times the share of the picture they fill.
double score(const Camera& camera, const Vector& up, const KeptSides& sides, const Occluder& occluder) {
  const Vector forward = (camera.target - camera.eye).normalized();
  const Vector right = forward.cross(up).normalized();
  const double half_height = std::tan(camera.vertical_field_of_view * std::numbers::pi / 360);
  std::vector<Ray> rays;
  for (int row = 0; row < preview_edge; ++row) {
    for (int column = 0; column < preview_edge; ++column) {
      const double u = half_height * (2 * (column + 0.5) / preview_edge - 1);
      const double v = half_height * (2 * (row + 0.5) / preview_edge - 1);
      rays.push_back({camera.eye, (forward + u * right + v * right.cross(forward)).normalized()});
    }
  }
  // A side without patches before the eye would be transparent: a view through a wall, which does not count.
  std::set<PolygonIndex> polygons;
  int filled = 0;
  for (const std::optional<Hit>& hit : occluder.first_hits(rays)) {
    if (!hit || !is_kept(sides, *hit)) continue;
    polygons.insert(hit->polygon);
    ++filled;
  }
  return static_cast<double>(polygons.size()) * filled / static_cast<double>(rays.size());
}

}  // namespace

Camera default_camera(const Scene& scene, const KeptSides& sides, const Occluder& occluder) {
  const Surroundings around = surroundings(scene);
  // Views through open sides, if there are any; otherwise from the corners inside.
  std::vector<Camera> candidates;
  for (const UprightSide& side : open_sides(around, sides, occluder)) candidates.push_back(view_before(around, side));
  if (candidates.empty()) {
    for (const double first : {-1.0, 1.0}) {
      for (const double second : {-1.0, 1.0}) candidates.push_back(view_from_corner(around, {first, second}));
    }
  }
  Camera best = view_from_above(around);
  double best_score = 0;
  for (const Camera& candidate : candidates) {
    const double candidate_score = score(candidate, scene.up, sides, occluder);
    if (candidate_score <= best_score) continue;
    best = candidate;
    best_score = candidate_score;
  }
  return best;
}

bool has_open_side(const Scene& scene, const KeptSides& sides, const Occluder& occluder) {
  return !open_sides(surroundings(scene), sides, occluder).empty();
}

namespace {

constexpr double cosine_of_floors = 0.95;  // cosine between a floor's normal and upwards
constexpr std::size_t most_places = 64;    // that are looked around from
constexpr int directions_around = 512;     // over the sphere
constexpr double least_enclosed = 0.85;    // of these that meet a side that has a part
constexpr double eye_share = 0.6;          // of the way from floor to ceiling
constexpr double tallest = 1.65;           // m above the floor, but under high ceilings
constexpr double least_of_high = 0.25;     // of the way to those
constexpr double least_cosine = 0.1;       // what is seen at a flatter angle counts as if at this one
constexpr int azimuths = 16;               // of views
constexpr double step_back = 0.92;         // of the free way behind the eye
constexpr double downward = 0.15;          // of views: 8.5 degrees
constexpr double field_of_view = 72;       // degrees, up and across
constexpr int view_edge = 24;              // rays of a view across and down

// Fibonacci's points on the sphere: each stands for the same solid angle.
std::vector<Ray> rays_around(const Point& eye) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Ray> rays;
  for (int k = 0; k < directions_around; ++k) {
    const double z = 1 - (2 * k + 1.0) / directions_around;
    const double across = std::sqrt(1 - z * z);
    rays.push_back({eye, Vector(across * std::cos(golden * k), across * std::sin(golden * k), z)});
  }
  return rays;
}

struct Around {
  double light = 0;     // on what is seen
  double enclosed = 0;  // share of the rays that meet a side with a part
};

// The integral of the light over the surfaces that rays of solid angle `each` see: dA = d^2 d omega / cos.
Around seen_along(const std::vector<Ray>& rays, double each, const SideLight& light, const Scene& scene,
                  const Occluder& occluder) {
  Around seen;
  for (const std::optional<Hit>& hit : occluder.first_hits(rays)) {
    if (!hit) continue;
    const double here = (hit->side == Side::front ? light.front : light.back)[hit->polygon];
    if (here < 0) continue;
    const double cosine = std::abs(hit->direction.dot(front_normal(scene, hit->polygon)));
    seen.light += here * hit->distance * hit->distance * each / std::max(least_cosine, cosine);
    seen.enclosed += 1.0 / static_cast<double>(rays.size());
  }
  return seen;
}

// Places spread evenly over the light of the floors.
std::vector<FloorPiece> places_on(const std::vector<FloorPiece>& floors) {
  double sum = 0;
  for (const FloorPiece& piece : floors) sum += piece.light;
  std::vector<FloorPiece> places;
  double passed = 0;
  for (const FloorPiece& piece : floors) {
    const auto next = static_cast<double>(places.size());
    passed += piece.light;
    if (sum > 0 && passed > (next + 0.5) / most_places * sum && places.size() < most_places) places.push_back(piece);
  }
  return places;
}

// Above a piece of floor; nothing where there is no ceiling.
std::optional<Point> eye_above(const FloorPiece& piece, const Vector& up, const Occluder& occluder) {
  const std::optional<Hit> ceiling = occluder.first_hits(std::vector<Ray>{{piece.middle, up, piece.polygon}})[0];
  if (!ceiling) return std::nullopt;
  const double free = ceiling->distance;
  return piece.middle + std::min(eye_share * free, std::max(tallest, least_of_high * free)) * up;
}

// To the first face, or `open` where there is none.
double free_way(const Point& from, const Vector& direction, const Occluder& occluder, double open) {
  const std::optional<Hit> hit = occluder.first_hits(std::vector<Ray>{{from, direction}})[0];
  return hit ? hit->distance : open;
}

std::vector<Ray> rays_of_view(const Camera& camera, const Vector& up) {
  const Vector forward = (camera.target - camera.eye).normalized();
  const Vector right = forward.cross(up).normalized();
  const double half = std::tan(camera.vertical_field_of_view * std::numbers::pi / 360);
  std::vector<Ray> rays;
  for (int row = 0; row < view_edge; ++row) {
    for (int column = 0; column < view_edge; ++column) {
      const double u = half * (2 * (column + 0.5) / view_edge - 1);
      const double v = half * (2 * (row + 0.5) / view_edge - 1);
      rays.push_back({camera.eye, (forward + u * right + v * right.cross(forward)).normalized()});
    }
  }
  return rays;
}

}  // namespace

std::optional<Camera> inside_camera(const std::vector<FloorPiece>& floors, const SideLight& light, const Scene& scene,
                                    const Occluder& occluder) {
  // 1. The place that sees most light
  std::optional<Point> place;
  double most = 0;
  for (const FloorPiece& piece : places_on(floors)) {
    const std::optional<Point> eye = eye_above(piece, scene.up, occluder);
    if (!eye) continue;
    const Around around =
        seen_along(rays_around(*eye), 4 * std::numbers::pi / directions_around, light, scene, occluder);
    if (around.enclosed < least_enclosed || around.light <= most) continue;
    most = around.light;
    place = eye;
  }
  if (!place) return std::nullopt;

  // 2. From there back as far as one can, but not out through an open end; of all directions in that which shows most
  const double extent = bounds(scene).diagonal().norm();
  const Vector east = scene.north.cross(scene.up);
  std::optional<Camera> best;
  most = 0;
  for (int k = 0; k < azimuths; ++k) {
    const double azimuth = 2 * std::numbers::pi * (k + 0.5) / azimuths;
    const Vector ahead = std::cos(azimuth) * scene.north + std::sin(azimuth) * east;
    const Point eye = *place - step_back * free_way(*place, -ahead, occluder, 0) * ahead;
    const double way = free_way(eye, ahead, occluder, extent);
    const Camera camera{eye, eye + way * (ahead - downward * scene.up), field_of_view};
    const double solid_angle = std::pow(field_of_view * std::numbers::pi / 180 / view_edge, 2);
    const Around view = seen_along(rays_of_view(camera, scene.up), solid_angle, light, scene, occluder);
    if (view.light * view.enclosed <= most) continue;
    most = view.light * view.enclosed;
    best = camera;
  }
  return best;
}

std::vector<FloorPiece> floors_of(const PatchMesh& mesh, const Eigen::VectorXd& light, const Vector& up) {
  std::vector<FloorPiece> floors;
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    if (light[patch] > 0 && mesh.normal[patch].dot(up) > cosine_of_floors)
      floors.push_back({mesh.centroid[patch], mesh.polygon[patch], light[patch] * mesh.area[patch]});
  }
  return floors;
}

std::vector<FloorPiece> floors_of(const Scene& scene, const SideLight& light) {
  std::vector<FloorPiece> floors;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    const double cosine = front_normal(scene, polygon).dot(scene.up);
    const double here = std::abs(cosine) > cosine_of_floors ? (cosine > 0 ? light.front : light.back)[polygon] : 0;
    if (!(here > 0)) continue;
    for (const auto& [a, b, c] : triangles_of(corner_points(scene, polygon)))
      floors.push_back({(a + b + c) / 3, polygon, here * (b - a).cross(c - a).norm() / 2});
  }
  return floors;
}

SideLight reflectance_of_sides(const Scene& scene, const KeptSides& sides) {
  const auto count = static_cast<Eigen::Index>(scene.polygons.size());
  SideLight light{Eigen::VectorXd::Constant(count, -1), Eigen::VectorXd::Constant(count, -1)};
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    const Polygon& at = scene.polygons[polygon];
    const auto reflectance_on = [&](Side side) { return scene.materials[material_on(at, side)].reflectance.mean(); };
    if (sides.front[polygon]) light.front[polygon] = reflectance_on(Side::front);
    if (sides.back[polygon]) light.back[polygon] = reflectance_on(Side::back);
  }
  return light;
}

SideLight light_of_sides(const PatchMesh& mesh, const Eigen::VectorXd& light, std::size_t polygons) {
  const auto count = static_cast<Eigen::Index>(polygons);
  SideLight sides{Eigen::VectorXd::Constant(count, -1), Eigen::VectorXd::Constant(count, -1)};
  for (PolygonIndex polygon = 0; polygon < polygons; ++polygon) {
    for (const Side side : {Side::front, Side::back}) {
      const PatchRange patches = mesh.patches_on(polygon, side);
      double sum = 0, area = 0;
      for (PatchIndex patch = patches.begin; patch < patches.end; ++patch) {
        sum += light[patch] * mesh.area[patch];
        area += mesh.area[patch];
      }
      if (area > 0) (side == Side::front ? sides.front : sides.back)[polygon] = sum / area;
    }
  }
  return sides;
}

}  // namespace patchlight
