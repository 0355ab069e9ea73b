#include "lighting/shades.h"

#include "lighting/lit_area.h"
#include "scene/extent.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <numeric>

namespace patchlight {
namespace {

// What nowhere rises higher over the plane of a patch, as a share of the scene's extent, throws no shadow on it:
// rounding.
constexpr double shade_in_plane = 1e-9;

// Triangles towards the light that are looked at for one patch.
constexpr std::size_t most_triangles = 1500;

// What is nearer to a point of light than this share of its height throws no shadow but at grazing angles.
constexpr double beside_light = 1 - 1e-9;

// Light that comes flatter than this is none.
constexpr double least_cosine = 1e-9;

// A plane with two axes.
struct Frame {
  Point origin;
  Vector u, v, normal;

  Eigen::Vector2d in_plane(const Point& point) const { return {u.dot(point - origin), v.dot(point - origin)}; }
};

Frame frame_of(const Receiver& patch) {
  const SurfacePoint middle = patch.place(0.5, 0.5);
  const Vector u = middle.normal.unitOrthogonal();
  return {middle.point, u, middle.normal.cross(u), middle.normal};
}

// Counter-clockwise in the frame.
Outline outline_of(std::span<const Point> corners, const Frame& frame) {
  Outline outline;
  for (const Point& corner : corners) outline.push_back(frame.in_plane(corner));
  if (area_of(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

// True when all of a region lies within an outline.
bool holds(const Outline& outline, const Outline& region) {
  if (outline.size() < 3) return false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d& a = outline[k];
    const Eigen::Vector2d along = outline[(k + 1) % outline.size()] - a;
    const auto is_right = [&](const Eigen::Vector2d& p) {
      return along.x() * (p.y() - a.y()) - along.y() * (p.x() - a.x()) < 0;
    };
    if (std::any_of(region.begin(), region.end(), is_right)) return false;
  }
  return true;
}

// The part of an outline where `signed_distance` is positive.
template <typename Distance>
std::vector<Point> part_before(const std::vector<Point>& outline, Distance signed_distance) {
  std::vector<Point> before;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = outline[(k + 1) % outline.size()];
    const double at_a = signed_distance(a);
    const double at_b = signed_distance(b);
    if (at_a > 0) before.push_back(a);
    if ((at_a > 0) != (at_b > 0)) before.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return before;
}

// The part of a triangle between a frame's plane and the light; nothing of one that does not rise higher than `least`.
std::vector<Point> part_above(const std::array<Point, 3>& triangle, const Frame& frame, double least,
                              const LightPlace& light) {
  const auto height = [&](const Point& point) { return frame.normal.dot(point - frame.origin); };
  if (std::none_of(triangle.begin(), triangle.end(), [&](const Point& point) { return height(point) > least; }))
    return {};
  const auto above = part_before({triangle.begin(), triangle.end()}, height);
  if (light.weight == 0) return above;
  const double highest = beside_light * height(light.at);
  return part_before(above, [&](const Point& point) { return highest - height(point); });
}

// What lies outside one of these half spaces cannot stand between the patch and the light.
std::vector<HalfSpace> shaft_of(const Receiver& patch, const Frame& frame, const LightPlace& light) {
  std::vector<HalfSpace> outside{{frame.normal, frame.normal.dot(frame.origin)}};
  if (light.weight > 0) outside.push_back({-frame.normal, -frame.normal.dot(light.at)});
  std::vector<Point> corners = patch.corners;
  if (area_vector(corners).dot(frame.normal) < 0) std::reverse(corners.begin(), corners.end());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector inward = light.way_from(corners[k]).cross(corners[(k + 1) % corners.size()] - corners[k]);
    outside.push_back({inward, inward.dot(corners[k])});
  }
  return outside;
}

bool lies_in(const Box& box, const HalfSpace& below) {
  const Vector highest = (below.normal.array() > 0).select(box.max(), box.min());
  return below.normal.dot(highest) <= below.offset;
}

}  // namespace

Shades::Shades(const Scene& scene, const Coverings& coverings)
    : tolerance_(shade_in_plane * extent_of(scene)),
      bands_(number_of_bands(scene)),
      coverings_(coverings),
      transmittances_(scene.polygons.size()) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    first_triangle_.push_back(triangles_.size());
    const std::vector<Point> points = corner_points(scene, p);
    const Vector normal = front_normal(scene, p);
    for (const auto& [a, b, c] : triangulate(points))
      triangles_.push_back({{points[a], points[b], points[c]}, normal, p});
    if (!is_opening(scene, p)) continue;
    for (const Side side : {Side::front, Side::back}) {
      const Material& material = scene.materials[material_on(scene.polygons[p], side)];
      const bool clear = material.transmittance.size() > 0;
      transmittances_[p][side == Side::front ? 0 : 1] =
          clear ? material.transmittance : Spectrum(Spectrum::Zero(bands_));
    }
  }
  first_triangle_.push_back(triangles_.size());
  Indices order(triangles_.size());
  std::iota(order.begin(), order.end(), 0U);
  if (!order.empty()) add_nodes(order);
}

void Shades::add_nodes(std::span<std::uint32_t> triangles) {
  const std::size_t own = nodes_.size();
  nodes_.push_back({{}, 0, triangles.front(), triangles.size() == 1});
  for (const std::uint32_t t : triangles) {
    for (const Point& corner : triangles_[t].corners) nodes_[own].box.extend(corner);
  }
  if (triangles.size() > 1) {
    // Halved along the direction in which the middles spread most.
    Eigen::Index widest = 0;
    nodes_[own].box.sizes().maxCoeff(&widest);
    const auto middle = [&](std::uint32_t t) {
      const auto& [a, b, c] = triangles_[t].corners;
      return a[widest] + b[widest] + c[widest];
    };
    const std::size_t half = triangles.size() / 2;
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
    add_nodes(triangles.first(half));
    add_nodes(triangles.subspan(half));
  }
  nodes_[own].next = static_cast<std::uint32_t>(nodes_.size());
}

// Those of which no such half space holds the box.
Shades::Indices Shades::triangles_over(std::span<const HalfSpace> below) const {
  Indices found;
  for (std::size_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    const bool is_outside =
        std::any_of(below.begin(), below.end(), [&](const HalfSpace& half) { return lies_in(node.box, half); });
    if (!is_outside && node.is_leaf) found.push_back(node.triangle);
    n = is_outside ? node.next : n + 1;
  }
  return found;
}

bool Shades::lies_under(PolygonIndex polygon, PolygonIndex other) const {
  for (const Side side : {Side::front, Side::back}) {
    const auto over = coverings_.over_side(polygon, side);
    if (std::find(over.begin(), over.end(), other) != over.end()) return true;
  }
  return false;
}

const Spectrum* Shades::transmittance_of(const Triangle& triangle, const LightPlace& light) const {
  const bool from_front = triangle.normal.dot(light.way_from(triangle.corners[0])) < 0;
  const Spectrum& share = transmittances_[triangle.polygon][from_front ? 0 : 1];
  return share.size() > 0 ? &share : nullptr;
}

// What darkens a patch, in its plane.
struct Shades::Shadows {
  Frame frame;
  std::vector<Shade> covers;  // what lies on the patch
  std::vector<Shade> all;     // with the shadows of what stands before it
};

// No more than the first shadow that holds all of the patch. Nothing where there are too many.
std::optional<Shades::Shadows> Shades::shadows_on(const Receiver& patch, const LightPlace& light) const {
  Shadows shadows{frame_of(patch), {}, {}};
  const Frame& frame = shadows.frame;
  const PolygonIndex own = patch.place(0.5, 0.5).polygon;
  const Outline region = outline_of(patch.corners, frame);

  // 1. What lies on the patch takes its place.
  for (const PolygonIndex p : coverings_.over_side(own, patch.side)) {
    for (std::size_t t = first_triangle_[p]; t < first_triangle_[p + 1]; ++t)
      shadows.covers.push_back({outline_of(triangles_[t].corners, frame), nullptr});
  }
  shadows.all = shadows.covers;

  // 2. Shadows along the rays, in the patch's plane.
  for (const std::uint32_t t : triangles_over(shaft_of(patch, frame, light))) {
    const Triangle& triangle = triangles_[t];
    if (triangle.polygon == own || lies_under(triangle.polygon, own)) continue;
    std::vector<Point> shadow = part_above(triangle.corners, frame, tolerance_, light);
    if (shadow.size() < 3) continue;
    for (Point& point : shadow) {
      const Vector along = light.way_from(point);
      point -= frame.normal.dot(point - frame.origin) / frame.normal.dot(along) * along;
    }
    shadows.all.push_back({outline_of(shadow, frame), transmittance_of(triangle, light)});
    if (shadows.all.back().transmittance == nullptr && holds(shadows.all.back().outline, region)) {
      shadows.all = {shadows.all.back()};
      return shadows;
    }
    if (shadows.all.size() > shadows.covers.size() + most_triangles) return std::nullopt;
  }
  return shadows;
}

std::optional<Spectrum> Shades::transmittance(const Receiver& patch, const LightPlace& light) const {
  const Frame frame = frame_of(patch);
  const Vector way = light.way_from(frame.origin);
  if (!(frame.normal.dot(way) > least_cosine * way.norm())) return Spectrum(Spectrum::Zero(bands_));
  const auto shadows = shadows_on(patch, light);
  if (!shadows) return std::nullopt;
  const Outline region = outline_of(patch.corners, frame);
  const auto exposed = lit_area(region, shadows->covers, 1);
  const auto lit = lit_area(region, shadows->all, bands_);
  if (!exposed || !lit) return std::nullopt;
  if (!((*exposed)[0] > 0)) return Spectrum(Spectrum::Zero(bands_));
  return Spectrum(*lit / (*exposed)[0]);
}

std::optional<std::vector<LitPart>> Shades::lit_parts(const Receiver& patch, const LightPlace& light) const {
  const auto shadows = shadows_on(patch, light);
  if (!shadows) return std::nullopt;
  constexpr int cuts = 4;
  std::array<Point, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = patch.corners[std::min(k, patch.corners.size() - 1)];
  const auto at = [&](int u, int v) -> Point {
    const double s = static_cast<double>(u) / cuts, t = static_cast<double>(v) / cuts;
    return (1 - s) * ((1 - t) * corners[0] + t * corners[3]) + s * ((1 - t) * corners[1] + t * corners[2]);
  };
  std::vector<LitPart> parts;
  for (int k = 0; k < cuts * cuts; ++k) {
    const int u = k % cuts, v = k / cuts;
    const std::array<Point, 4> part{at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)};
    const Outline region = outline_of(part, shadows->frame);
    const auto exposed = lit_area(region, shadows->covers, 1);
    const auto lit = lit_area(region, shadows->all, bands_);
    if (!exposed || !lit) return std::nullopt;
    parts.push_back({part, (*exposed)[0], *lit});
  }
  return parts;
}

}  // namespace patchlight
