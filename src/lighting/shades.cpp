#include "lighting/shades.h"

#include "patchlight/base/geometry.h"

#include "lighting/lit_area.h"
#include "lighting/receiver.h"
#include "scene/extent.h"
#include "scene/light_place.h"
#include "scene/triangulate.h"
#include "visibility/shaft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace patchlight {
namespace {

// The plane of a patch with two axes.
struct ShadowFrame {
  Point origin;
  Vector u, v, normal;

  Eigen::Vector2d in_plane(const Point& point) const { return {u.dot(point - origin), v.dot(point - origin)}; }
};

// What is nearer to a point of light than this share of its height throws no shadow but at grazing angles.
constexpr double beside_light = 1 - 1e-9;

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

ShadowFrame shadow_frame_of(const Receiver& patch) {
  const SurfacePoint middle = patch.place(0.5, 0.5);
  const Vector u = middle.normal.unitOrthogonal();
  return {middle.point, u, middle.normal.cross(u), middle.normal};
}

// Of points in the plane, counter-clockwise in the frame.
PlanarOutline outline_of(std::span<const Point> corners, const ShadowFrame& frame) {
  PlanarOutline outline;
  for (const Point& corner : corners) outline.push_back(frame.in_plane(corner));
  if (area_of(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

// True when all of a region lies within an outline.
bool holds(const PlanarOutline& outline, const PlanarOutline& region) {
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

// The part of a triangle between a frame's plane and the light; nothing of one that does not rise higher than `least`.
std::vector<Point> part_above(const std::array<Point, 3>& triangle, const ShadowFrame& frame, double least,
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
std::vector<HalfSpace> shaft_of(const Receiver& patch, const ShadowFrame& frame, const LightPlace& light) {
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

// What nowhere rises higher over the plane of a patch, as a share of the scene's extent, throws no shadow on it:
// rounding.
constexpr double shade_in_plane = 1e-9;

// Triangles towards the light that are looked at for one patch.
constexpr std::size_t most_triangles = 1500;

// Light that comes flatter than this is none.
constexpr double least_cosine = 1e-9;

bool is_power_of_half(double share) {
  constexpr double rounding = 1e-9;
  const double power = std::log2(share);
  return share > 0 && std::abs(power - std::round(power)) < rounding;
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
      panes_(scene) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    first_triangle_.push_back(triangles_.size());
    const std::vector<Point> points = corner_points(scene, p);
    const Vector normal = front_normal(scene, p);
    for (const auto& [a, b, c] : triangulate(points))
      triangles_.push_back({{points[a], points[b], points[c]}, normal, p});
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
  return coverings_.lies_over(other, polygon, Side::front) || coverings_.lies_over(other, polygon, Side::back);
}

// What darkens a patch, in its plane.
struct Shades::Shadows {
  ShadowFrame frame;
  std::vector<Shade> covers;  // what lies on the patch
  std::vector<Shade> all;     // with the shadows of what stands before it

  // Of those the shadows of panes, which are opaque until let_through() says what the panes let through.
  struct OfPane {
    std::size_t shade = 0;
    PolygonIndex polygon = no_polygon;
  };
  std::vector<OfPane> of_panes;
  std::vector<Spectrum> shares = {};

  // Takes what panes let through towards the light from a place.
  void let_through(const PaneSides& panes, const Point& place, const LightPlace& light) {
    const Vector direction = light.way_from(place).normalized();
    shares.resize(of_panes.size());
    for (std::size_t k = 0; k < of_panes.size(); ++k) {
      shares[k] = panes.transmittance(of_panes[k].polygon, direction);
      all[of_panes[k].shade].transmittance = &shares[k];
    }
  }

  // The shadows of panes alone, of which each lets one half through, in a single band: where the same panes are before
  // all of a region what is lit is a power of that.
  std::vector<Shade> half_of_panes() {
    for (Spectrum& share : shares) share = Spectrum::Constant(1, 0.5);
    std::vector<Shade> panes = covers;
    for (const OfPane& pane : of_panes) panes.push_back(all[pane.shade]);
    return panes;
  }
};

// No more than the first shadow that holds all of the patch. Nothing where there are too many.
std::optional<Shades::Shadows> Shades::shadows_on(const Receiver& patch, const LightPlace& light) const {
  Shadows shadows{shadow_frame_of(patch), {}, {}, {}};
  const ShadowFrame& frame = shadows.frame;
  const PolygonIndex own = patch.place(0.5, 0.5).polygon;
  const PlanarOutline region = outline_of(patch.corners, frame);

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
    shadows.all.push_back({outline_of(shadow, frame), nullptr});
    if (panes_.is_clear(triangle.polygon)) {
      shadows.of_panes.push_back({shadows.all.size() - 1, triangle.polygon});
    } else if (holds(shadows.all.back().outline, region)) {
      shadows.all = {shadows.all.back()};
      shadows.of_panes.clear();
      return shadows;
    }
    if (shadows.all.size() > shadows.covers.size() + most_triangles) return std::nullopt;
  }
  return shadows;
}

std::optional<Spectrum> Shades::transmittance(const Receiver& patch, const LightPlace& light) const {
  const ShadowFrame frame = shadow_frame_of(patch);
  const Vector way = light.way_from(frame.origin);
  if (!(frame.normal.dot(way) > least_cosine * way.norm())) return Spectrum(Spectrum::Zero(bands_));
  auto shadows = shadows_on(patch, light);
  if (!shadows) return std::nullopt;
  shadows->let_through(panes_, frame.origin, light);
  const PlanarOutline region = outline_of(patch.corners, frame);
  const auto exposed = lit_area(region, shadows->covers, 1);
  const auto lit = lit_area(region, shadows->all, bands_);
  if (!exposed || !lit) return std::nullopt;
  if (!((*exposed)[0] > 0)) return Spectrum(Spectrum::Zero(bands_));
  return Spectrum(*lit / (*exposed)[0]);
}

// What panes let through varies over the part. Where the same panes are before all of it, its middle and its corners
// tell the mean right up to the third order; else it is as of what is evenly distributed between the extremes.
std::optional<LitPart> Shades::lit_part(Shadows& shadows, const std::array<Point, 4>& corners,
                                        const LightPlace& light) const {
  const PlanarOutline region = outline_of(corners, shadows.frame);
  const auto exposed = lit_area(region, shadows.covers, 1);
  const auto lit_as_from = [&](const Point& place) {
    shadows.let_through(panes_, place, light);
    return lit_area(region, shadows.all, bands_);
  };
  const auto middle = lit_as_from((corners[0] + corners[1] + corners[2] + corners[3]) / 4);
  if (!exposed || !middle) return std::nullopt;
  LitPart part{corners, (*exposed)[0], *middle, middle->min((*exposed)[0] - *middle).max(0.0), 0 * *middle};
  if (shadows.of_panes.empty()) return part;
  Spectrum lowest = *middle, highest = *middle, sum = Spectrum::Zero(bands_);
  for (const Point& corner : corners) {
    const auto lit = lit_as_from(corner);
    if (!lit) return std::nullopt;
    lowest = lowest.min(*lit).eval();
    highest = highest.max(*lit).eval();
    sum += *lit;
  }
  part.lit = (2 * *middle + sum / 4) / 3;
  part.doubt = (highest - lowest) / std::sqrt(12.0);
  const auto by_half = lit_area(region, shadows.half_of_panes(), 1);
  if (!by_half || !is_power_of_half((*by_half)[0] / part.exposed)) return part;
  part.uneven.setZero();
  part.doubt = (part.lit - *middle).abs();
  return part;
}

std::optional<std::vector<LitPart>> Shades::lit_parts(const Receiver& patch, const LightPlace& light) const {
  auto shadows = shadows_on(patch, light);
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
    const auto lit = lit_part(*shadows, part, light);
    if (!lit) return std::nullopt;
    parts.push_back(*lit);
  }
  return parts;
}

}  // namespace patchlight
