#include "render/camera.h"

#include "patchlight/base/error.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <string>

namespace patchlight {
namespace {

constexpr std::uint32_t log2_points = 12;
constexpr std::uint32_t point_count = 1U << log2_points;

// A scrambled sequence that is scrambled again is a scrambled sequence.
const std::vector<std::array<std::uint32_t, 4>>& base_points() {
  static const auto all = [] {
    std::vector<std::array<std::uint32_t, 4>> bits(point_count);
    const auto sequence = scrambled_sobol(point_count, stream::pixel_sequence);
    for (std::uint32_t k = 0; k < point_count; ++k) {
      for (std::size_t d = 0; d < 4; ++d) bits[k][d] = static_cast<std::uint32_t>(sequence[k][d] * 0x1p32);
    }
    return bits;
  }();
  return all;
}

template <std::size_t count>
std::array<double, count> coordinates(std::uint32_t index, std::uint32_t seed) {
  const std::uint32_t unused = 32 - log2_points;
  const std::uint32_t place = owen_scramble((index % point_count) << unused, hash(seed)) >> unused;
  const std::array<std::uint32_t, 4>& bits = base_points()[place];
  std::array<double, count> sample{};
  for (std::uint32_t d = 0; d < count; ++d)
    sample[d] = (owen_scramble(bits[d], hash(seed + 0x9e3779b9U * (d + 1))) + 0.5) * 0x1p-32;
  return sample;
}

void require_view(const Camera& camera) {
  const std::string projection = name_of(camera.projection);
  if (!has_extent(camera) && camera.projection == Projection::orthographic)
    throw InputError("camera", "an orthographic picture of height " + std::to_string(camera.height) +
                                   " m; expected a height above 0");
  if (!has_extent(camera)) {
    throw InputError("camera", "the field of view is " + std::to_string(camera.vertical_field_of_view) +
                                   " degrees; expected more than 0 and, for the projection " + projection +
                                   (camera.projection == Projection::perspective ? ", less than " : ", at most ") +
                                   std::to_string(std::lround(largest_field_of_view(camera.projection))));
  }
  const Vector sight = camera.target - camera.eye;
  if (!(sight.norm() > 0) || !sight.allFinite())
    throw InputError("camera", "there is no direction from eye to target; expected two different points");
}

// The width of a pixel: in the plane at distance 1, in the unit disc, radians, or meters.
double pixel_scale(const Camera& camera, int height) {
  const double half_angle = camera.vertical_field_of_view * std::numbers::pi / 360;
  switch (camera.projection) {
    case Projection::perspective:
      return 2 * std::tan(half_angle) / height;
    case Projection::orthographic:
      return camera.height / height;
    case Projection::hemispherical:
      return 2 * std::sin(half_angle) / height;
    case Projection::angular:
    case Projection::panorama:
      break;
  }
  return 2 * half_angle / height;
}

constexpr int preview_edge = 32;  // rays across and down

constexpr double outside_field_of_view = 42;  // degrees, both ways: pictures are taken as square
constexpr double inside_field_of_view = 72;
constexpr double margin = 1.04;  // of the picture's edge to the edge of an open side

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
  double place(const Box& box) const { return (upper ? box.max() : box.min())[axis]; }
};

Camera view_before(const Surroundings& around, const UprightSide& side) {
  const Eigen::Index across = 3 - side.axis - around.up_axis;
  const Vector size = around.box.sizes();
  const double half_angle = outside_field_of_view * std::numbers::pi / 360;
  const double distance = 0.5 * margin * std::max(size[across], size[around.up_axis]) / std::tan(half_angle);
  Camera camera{around.box.center(), around.box.center(), outside_field_of_view};
  camera.eye[side.axis] = side.place(around.box) + (side.upper ? distance : -distance);
  return camera;
}

Camera view_from_corner(const Surroundings& around, Eigen::Vector2d corner) {
  Camera camera{around.box.center(), around.box.center(), inside_field_of_view};
  const Vector size = around.box.sizes();
  int k = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis == around.up_axis) continue;
    camera.eye[axis] = around.box.center()[axis] + corner[k++] * (0.5 - 0.08) * size[axis];
  }
  // From 1.6 m in a room of 2.7 m slightly down
  camera.eye[around.up_axis] = around.height_at(0.6);
  camera.target[around.up_axis] = around.height_at(0.4);
  return camera;
}

// The view of a flat model whose sides show nothing: from above one corner, at a distance where the picture holds the
// model.
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

// True when half of the rays through this side of the bounds get a tenth of the bounds deep. The dark outsides of other
// rooms are no depth.
bool is_open(const Surroundings& around, const UprightSide& side, const KeptSides& sides, const Occluder& occluder) {
  const Eigen::Index across = 3 - side.axis - around.up_axis;
  const Point eye = view_before(around, side).eye;
  const Vector size = around.box.sizes();
  const double plane = side.place(around.box);
  std::vector<Ray> rays;
  for (int row = 0; row < preview_edge; ++row) {
    for (int column = 0; column < preview_edge; ++column) {
      Point on_side = around.box.min();
      on_side[side.axis] = plane;
      on_side[across] += (column + 0.5) / preview_edge * size[across];
      on_side[around.up_axis] += (row + 0.5) / preview_edge * size[around.up_axis];
      rays.push_back({eye, (on_side - eye).normalized()});
    }
  }
  int entered = 0;
  for (const std::optional<Hit>& hit : occluder.first_hits(rays)) {
    if (!hit || (is_kept(sides, *hit) && std::abs(hit->point[side.axis] - plane) > 0.1 * size[side.axis])) ++entered;
  }
  return entered >= 0.5 * static_cast<double>(rays.size());
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

// Rays through the middles of `edge` x `edge` pixels.
std::vector<Ray> rays_of_view(const Camera& camera, const Vector& up, int edge) {
  const Vector forward = (camera.target - camera.eye).normalized();
  const Vector right = forward.cross(up).normalized();
  const double half = std::tan(camera.vertical_field_of_view * std::numbers::pi / 360);
  std::vector<Ray> rays;
  for (int row = 0; row < edge; ++row) {
    for (int column = 0; column < edge; ++column) {
      const double u = half * (2 * (column + 0.5) / edge - 1);
      const double v = half * (2 * (row + 0.5) / edge - 1);
      rays.push_back({camera.eye, (forward + u * right + v * right.cross(forward)).normalized()});
    }
  }
  return rays;
}

// The number of different polygons seen times the share of the picture they fill.
double score(const Camera& camera, const Vector& up, const KeptSides& sides, const Occluder& occluder) {
  const std::vector<Ray> rays = rays_of_view(camera, up, preview_edge);
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

constexpr double cosine_of_floors = 0.95;  // between a floor's normal and upwards
constexpr int directions_around = 512;     // over the sphere
constexpr int azimuths = 16;               // of views
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
  double light = 0;     // on the surfaces seen
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
    // Surfaces at flatter angles count as if at this one.
    seen.light += here * hit->distance * hit->distance * each / std::max(0.1, cosine);
    seen.enclosed += 1.0 / static_cast<double>(rays.size());
  }
  return seen;
}

// At most 64 places spread evenly over the light of the floors.
std::vector<FloorPiece> places_on(const std::vector<FloorPiece>& floors) {
  const std::size_t most_places = 64;
  double sum = 0;
  for (const FloorPiece& piece : floors) sum += piece.light;
  std::vector<FloorPiece> places;
  double passed = 0;
  for (const FloorPiece& piece : floors) {
    const auto next = static_cast<double>(places.size());
    passed += piece.light;
    if (sum > 0 && passed > (next + 0.5) / static_cast<double>(most_places) * sum && places.size() < most_places)
      places.push_back(piece);
  }
  return places;
}

// At 0.6 of the way from a piece of floor to the ceiling, but at most 1.65 m, or a quarter of the way to a high
// ceiling. Nothing without a ceiling.
std::optional<Point> eye_above(const FloorPiece& piece, const Vector& up, const Occluder& occluder) {
  const std::optional<Hit> ceiling = occluder.first_hits(std::vector<Ray>{{piece.middle, up, piece.polygon}})[0];
  if (!ceiling) return std::nullopt;
  const double free = ceiling->distance;
  return piece.middle + std::min(0.6 * free, std::max(1.65, 0.25 * free)) * up;
}

// To the first face, or `open` where there is none.
double free_way(const Point& from, const Vector& direction, const Occluder& occluder, double open) {
  const std::optional<Hit> hit = occluder.first_hits(std::vector<Ray>{{from, direction}})[0];
  return hit ? hit->distance : open;
}

}  // namespace

std::array<double, 4> pixel_sample(std::uint32_t index, std::uint32_t seed) { return coordinates<4>(index, seed); }

std::array<double, 2> pixel_sample_2d(std::uint32_t index, std::uint32_t seed) { return coordinates<2>(index, seed); }

double tent(double u) { return u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u); }

Vector picture_up(const Camera& camera, const Vector& up, const Vector& north) {
  const Vector sight = (camera.target - camera.eye).normalized();
  return sight.cross(up).norm() > tolerance_of_shapes ? up : north;
}

Lens::Lens(const Camera& camera, const Vector& up, int width, int height)
    : projection_(camera.projection),
      width_(width),
      height_(height),
      eye_(camera.eye),
      scale_(pixel_scale(camera, height)),
      half_angle_(camera.vertical_field_of_view * std::numbers::pi / 360) {
  require_view(camera);
  forward_ = (camera.target - camera.eye).normalized();
  // Where the camera looks along `up`, any direction may be upward in the picture.
  right_ = forward_.cross(up.normalized());
  if (!(right_.norm() > tolerance_of_shapes)) right_ = forward_.unitOrthogonal();
  right_.normalize();
  up_ = right_.cross(forward_);
}

double Lens::pixel_width(double distance) const {
  return projection_ == Projection::orthographic ? scale_ : scale_ * distance;
}

Vector Lens::direction_of(double across, double above) const {
  if (projection_ == Projection::perspective) return forward_ + across * right_ + above * up_;
  if (projection_ == Projection::panorama) {
    // Azimuth by altitude, about the picture's upright axis.
    return std::cos(above) * (std::cos(across) * forward_ + std::sin(across) * right_) + std::sin(above) * up_;
  }
  // Fisheye: at the distance r from the middle the angle is r, or its sine is r.
  const double r = std::hypot(across, above);
  if (!(r > 0)) return forward_;
  const double angle = projection_ == Projection::angular ? r : std::asin(std::min(1.0, r));
  return std::cos(angle) * forward_ + std::sin(angle) / r * (across * right_ + above * up_);
}

std::optional<Ray> Lens::ray(double x, double y) const {
  const double across = (x - 0.5 * width_) * scale_;
  const double above = (0.5 * height_ - y) * scale_;
  if (projection_ == Projection::orthographic) return Ray{eye_ + across * right_ + above * up_, forward_};
  const double r = std::hypot(across, above);
  if (projection_ == Projection::angular && r > half_angle_) return std::nullopt;
  if (projection_ == Projection::hemispherical && r > std::sin(half_angle_)) return std::nullopt;
  const bool is_all_around = projection_ == Projection::panorama;
  if (is_all_around && (std::abs(across) > std::numbers::pi || std::abs(above) > std::numbers::pi / 2))
    return std::nullopt;
  return Ray{eye_, direction_of(across, above).normalized()};
}

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
    if (around.enclosed < 0.85 || around.light <= most) continue;
    most = around.light;
    place = eye;
  }
  if (!place) return std::nullopt;

  // 2. From there back along 0.92 of the free way, but not out through an open end, and 8.5 degrees down; of all
  // directions the one that shows most
  const double extent = bounds(scene).diagonal().norm();
  const Vector east = scene.north.cross(scene.up);
  std::optional<Camera> best;
  most = 0;
  for (int k = 0; k < azimuths; ++k) {
    const double azimuth = 2 * std::numbers::pi * (k + 0.5) / azimuths;
    const Vector ahead = std::cos(azimuth) * scene.north + std::sin(azimuth) * east;
    const Point eye = *place - 0.92 * free_way(*place, -ahead, occluder, 0) * ahead;
    const double way = free_way(eye, ahead, occluder, extent);
    const Camera camera{eye, eye + way * (ahead - 0.15 * scene.up), inside_field_of_view};
    const double solid_angle = std::pow(inside_field_of_view * std::numbers::pi / 180 / view_edge, 2);
    const Around view = seen_along(rays_of_view(camera, scene.up, view_edge), solid_angle, light, scene, occluder);
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
