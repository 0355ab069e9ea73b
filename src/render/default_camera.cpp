#include "render/render.h"
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

}  // namespace patchlight
