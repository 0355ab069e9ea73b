#include "lighting/shades.h"

#include "patchlight/scene/triangulate.h"

#include "lighting/lit_area.h"
#include "scene/extent.h"

#include <algorithm>
#include <numeric>

namespace patchlight {
namespace {

// What nowhere rises higher over the plane of a patch, as a share of the scene's extent, throws no shadow on it:
// rounding.
constexpr double shade_in_plane = 1e-9;

// Triangles towards the light that are looked at for one patch.
constexpr std::size_t most_triangles = 1500;

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

// The part of a triangle over a frame's plane; nothing of one that does not rise higher than `least`.
std::vector<Point> part_above(const std::array<Point, 3>& triangle, const Frame& frame, double least) {
  std::vector<Point> above;
  const auto height = [&](const Point& point) { return frame.normal.dot(point - frame.origin); };
  if (std::none_of(triangle.begin(), triangle.end(), [&](const Point& point) { return height(point) > least; }))
    return above;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& a = triangle[k];
    const Point& b = triangle[(k + 1) % 3];
    const double at_a = height(a);
    const double at_b = height(b);
    if (at_a > 0) above.push_back(a);
    if ((at_a > 0) != (at_b > 0)) above.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return above;
}

// What lies outside one of these half spaces cannot stand between the patch and the light.
std::vector<HalfSpace> shaft_of(const Receiver& patch, const Frame& frame, const Vector& toward_light) {
  std::vector<HalfSpace> outside{{frame.normal, frame.normal.dot(frame.origin)}};
  std::vector<Point> corners = patch.corners;
  if (area_vector(corners).dot(frame.normal) < 0) std::reverse(corners.begin(), corners.end());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector inward = toward_light.cross(corners[(k + 1) % corners.size()] - corners[k]);
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
      bands_(scene.materials.front().reflectance.size()),
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

const Spectrum* Shades::transmittance_of(const Triangle& triangle, const Vector& toward_light) const {
  const bool from_front = triangle.normal.dot(toward_light) < 0;
  const Spectrum& share = transmittances_[triangle.polygon][from_front ? 0 : 1];
  return share.size() > 0 ? &share : nullptr;
}

std::optional<Spectrum> Shades::transmittance(const Receiver& patch, const Vector& toward_light) const {
  const Frame frame = frame_of(patch);
  const PolygonIndex own = patch.place(0.5, 0.5).polygon;
  const Outline region = outline_of(patch.corners, frame);
  const double cosine = frame.normal.dot(toward_light);
  if (!(cosine > least_cosine)) return Spectrum(Spectrum::Zero(bands_));

  // 1. What lies on the patch takes its place.
  std::vector<Shade> shades;
  for (const PolygonIndex p : coverings_.over_side(own, patch.side)) {
    for (std::size_t t = first_triangle_[p]; t < first_triangle_[p + 1]; ++t)
      shades.push_back({outline_of(triangles_[t].corners, frame), nullptr});
  }
  const auto exposed = lit_area(region, shades, 1);
  if (!exposed) return std::nullopt;
  if (!((*exposed)[0] > 0)) return Spectrum(Spectrum::Zero(bands_));

  // 2. Shadows along the rays, in the patch's plane.
  const Indices before = triangles_over(shaft_of(patch, frame, toward_light));
  if (before.size() > most_triangles) return std::nullopt;
  for (const std::uint32_t t : before) {
    const Triangle& triangle = triangles_[t];
    if (triangle.polygon == own || lies_under(triangle.polygon, own)) continue;
    std::vector<Point> shadow = part_above(triangle.corners, frame, tolerance_);
    if (shadow.size() < 3) continue;
    for (Point& point : shadow) point -= frame.normal.dot(point - frame.origin) / cosine * toward_light;
    shades.push_back({outline_of(shadow, frame), transmittance_of(triangle, toward_light)});
  }
  const auto lit = lit_area(region, shades, bands_);
  if (!lit) return std::nullopt;
  return Spectrum(*lit / (*exposed)[0]);
}

}  // namespace patchlight
