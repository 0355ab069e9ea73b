#include "lighting/shades.h"

#include "base/tolerances.h"
#include "scene/extent.h"
#include "scene/triangulate.h"
#include "visibility/flat_polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patchlight {
namespace {

// A share of the region that counts as nothing: rounding.
constexpr double negligible = 1e-13;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Interval {
  double from = 0;
  double to = 0;
};

struct PaneInterval {
  Interval interval;
  const Spectrum* transmittance = nullptr;
};

// Where a horizontal line cuts a convex outline.
Interval cut(const PlanarOutline& outline, double y) {
  Interval found{1, 0};
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d& a = outline[k];
    const Eigen::Vector2d& b = outline[(k + 1) % outline.size()];
    if ((a.y() > y) == (b.y() > y)) continue;
    const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    found = found.from > found.to ? Interval{x, x} : Interval{std::min(found.from, x), std::max(found.to, x)};
  }
  return found;
}

// The integral of the panes' transmittances over an interval.
Spectrum through_panes(const Interval& whole, const std::vector<PaneInterval>& panes, Eigen::Index bands) {
  if (panes.empty()) return Spectrum::Constant(bands, whole.to - whole.from);
  std::vector<double> ends{whole.from, whole.to};
  for (const PaneInterval& pane : panes) {
    for (const double end : {pane.interval.from, pane.interval.to})
      if (end > whole.from && end < whole.to) ends.push_back(end);
  }
  std::sort(ends.begin(), ends.end());
  Spectrum sum = Spectrum::Zero(bands);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double middle = (ends[k] + ends[k + 1]) / 2;
    Spectrum share = Spectrum::Constant(bands, ends[k + 1] - ends[k]);
    for (const PaneInterval& pane : panes)
      if (pane.interval.from < middle && middle < pane.interval.to) share *= *pane.transmittance;
    sum += share;
  }
  return sum;
}

// The same over an interval without the dark ones.
Spectrum lit_length(const Interval& whole, std::vector<Interval> dark, const std::vector<PaneInterval>& panes,
                    Eigen::Index bands) {
  std::sort(dark.begin(), dark.end(), [](const Interval& a, const Interval& b) { return a.from < b.from; });
  dark.push_back({whole.to, whole.to});
  Spectrum sum = Spectrum::Zero(bands);
  double reached = whole.from;
  for (const Interval& next : dark) {
    const double end = std::min(next.from, whole.to);
    if (end > reached) sum += through_panes({reached, end}, panes, bands);
    reached = std::max(reached, next.to);
  }
  return sum;
}

struct Edge {
  Eigen::Vector2d from, way;
};

void add_edges(std::vector<Edge>& edges, const PlanarOutline& outline) {
  for (std::size_t k = 0; k < outline.size(); ++k)
    edges.push_back({outline[k], outline[(k + 1) % outline.size()] - outline[k]});
}

// The heights at which edges begin or cross each other, in order.
std::vector<double> event_heights(const std::vector<Edge>& edges) {
  std::vector<double> heights;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Edge& a = edges[k];
    heights.push_back(a.from.y());
    for (std::size_t l = k + 1; l < edges.size(); ++l) {
      const Edge& b = edges[l];
      const double turn = cross(a.way, b.way);
      if (turn == 0) continue;
      const double along_a = cross(b.from - a.from, b.way) / turn;
      const double along_b = cross(b.from - a.from, a.way) / turn;
      if (along_a > 0 && along_a < 1 && along_b > 0 && along_b < 1) heights.push_back(a.from.y() + along_a * a.way.y());
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

// In each strip between the heights at which edges begin or cross the lit length is linear in the height, so that its
// middle gives the mean.
Spectrum area_by_strips(const PlanarOutline& region, const std::vector<Shade>& shades, Eigen::Index bands) {
  std::vector<Edge> edges;
  add_edges(edges, region);
  for (const Shade& shade : shades) add_edges(edges, shade.outline);
  const std::vector<double> heights = event_heights(edges);
  Spectrum sum = Spectrum::Zero(bands);
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const double middle = (heights[k] + heights[k + 1]) / 2;
    const Interval whole = cut(region, middle);
    if (!(whole.to > whole.from)) continue;
    std::vector<Interval> dark;
    std::vector<PaneInterval> panes;
    for (const Shade& shade : shades) {
      const Interval interval = cut(shade.outline, middle);
      if (!(interval.to > interval.from)) continue;
      if (shade.transmittance == nullptr) {
        dark.push_back(interval);
      } else {
        panes.push_back({interval, shade.transmittance});
      }
    }
    sum += (heights[k + 1] - heights[k]) * lit_length(whole, std::move(dark), panes, bands);
  }
  return sum;
}

// The part of an outline to the left of a line, which goes through `on_line` along `along`; empty when nothing is.
// Sutherland and Hodgman 1974.
PlanarOutline left_of(const PlanarOutline& outline, const Eigen::Vector2d& on_line, const Eigen::Vector2d& along) {
  PlanarOutline left;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d& a = outline[k];
    const Eigen::Vector2d& b = outline[(k + 1) % outline.size()];
    const double at_a = cross(along, a - on_line);
    const double at_b = cross(along, b - on_line);
    if (at_a >= 0) left.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) left.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return left;
}

struct Halving {
  Eigen::Index bands = 0;
  std::size_t cuts = 0;  // made so far

  std::optional<Spectrum> lit(const PlanarOutline& region, const std::vector<Shade>& shades, int depth);
  std::optional<Spectrum> lit_in_halves(const PlanarOutline& region, const std::vector<Shade>& shades, int depth);
};

// Shades lie inside the region. A region with more than 12 of them is halved, 16 times at most; one with more than 100
// is too complicated even then.
std::optional<Spectrum> Halving::lit(const PlanarOutline& region, const std::vector<Shade>& shades, int depth) {
  const double whole = area_of(region);
  std::vector<Shade> in_part;
  Spectrum everywhere = Spectrum::Ones(bands);
  for (const Shade& shade : shades) {
    const double shaded = area_of(shade.outline);
    if (!(shaded > negligible * whole)) continue;
    if (shaded < (1 - negligible) * whole) {
      in_part.push_back(shade);
    } else if (shade.transmittance == nullptr) {
      return Spectrum::Zero(bands);
    } else {
      everywhere *= *shade.transmittance;
    }
  }
  if (in_part.empty()) return Spectrum(whole * everywhere);
  const bool halves = in_part.size() > 12 && depth < 16;
  if (!halves && in_part.size() > 100) return std::nullopt;
  const auto rest = halves ? lit_in_halves(region, in_part, depth) : area_by_strips(region, in_part, bands);
  if (!rest) return std::nullopt;
  return Spectrum(everywhere * *rest);
}

// Cut across the longer side of the box around the region, unless that takes too long.
std::optional<Spectrum> Halving::lit_in_halves(const PlanarOutline& region, const std::vector<Shade>& shades,
                                               int depth) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : region) box.extend(corner);
  Eigen::Vector2d along = box.sizes().x() > box.sizes().y() ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
  Spectrum sum = Spectrum::Zero(bands);
  for (int half = 0; half < 2; ++half, along = -along) {
    std::vector<Shade> there;
    for (const Shade& shade : shades)
      there.push_back({left_of(shade.outline, box.center(), along), shade.transmittance});
    cuts += shades.size();
    if (cuts > 6000) return std::nullopt;  // sampling is cheaper
    const auto lit_there = lit(left_of(region, box.center(), along), there, depth + 1);
    if (!lit_there) return std::nullopt;
    sum += *lit_there;
  }
  return sum;
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

// The corners become counter-clockwise in the frame, in whose plane they lie.
PlanarOutline outline_of(std::span<const Point> corners, const FlatPolygon& frame) {
  PlanarOutline outline;
  for (const Point& corner : corners) outline.push_back(frame.in_plane(corner));
  if (area_of(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

// With its corners counter-clockwise.
FlatPolygon flat_patch(const Receiver& patch) {
  const SurfacePoint middle = patch.place(0.5, 0.5);
  const Vector u = middle.normal.unitOrthogonal();
  FlatPolygon flat{middle.point, u, middle.normal.cross(u), middle.normal, {}, {}};
  flat.corners = outline_of(patch.corners, flat);
  return flat;
}

// True when all of a region lies within an outline.
bool holds(const PlanarOutline& outline, const PlanarOutline& region) {
  if (outline.size() < 3) return false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d along = outline[(k + 1) % outline.size()] - outline[k];
    const auto is_right = [&](const Eigen::Vector2d& corner) { return cross(along, corner - outline[k]) < 0; };
    if (std::any_of(region.begin(), region.end(), is_right)) return false;
  }
  return true;
}

// The part of a triangle between a frame's plane and the light; nothing of one that does not rise higher than `least`.
std::vector<Point> part_above(const std::array<Point, 3>& triangle, const FlatPolygon& frame, double least,
                              const LightPlace& light) {
  const auto height = [&](const Point& point) { return frame.height(point); };
  if (std::none_of(triangle.begin(), triangle.end(), [&](const Point& point) { return height(point) > least; }))
    return {};
  auto above = part_before({triangle.begin(), triangle.end()}, height);
  if (light.weight == 0) return above;
  // Higher parts throw no shadow but at grazing angles.
  const double highest = (1 - tolerance_of_shapes) * height(light.at);
  return part_before(above, [&](const Point& point) { return highest - height(point); });
}

// Nothing outside one of these half spaces can stand between the patch and the light.
std::vector<HalfSpace> shaft_of(const Receiver& patch, const FlatPolygon& frame, const LightPlace& light) {
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

bool is_power_of_half(double share) {
  const double power = std::log2(share);
  return share > 0 && std::abs(power - std::round(power)) < tolerance_of_shapes;
}

bool lies_in(const Box& box, const HalfSpace& below) {
  const Vector highest = (below.normal.array() > 0).select(box.max(), box.min());
  return below.normal.dot(highest) <= below.offset;
}

}  // namespace

double area_of(const PlanarOutline& outline) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < outline.size(); ++k)
    sum += cross(outline[k] - outline[0], outline[k + 1] - outline[0]) / 2;
  return sum;
}

std::optional<Spectrum> lit_area(const PlanarOutline& region, const std::vector<Shade>& shades, Eigen::Index bands) {
  std::vector<Shade> inside;
  for (const Shade& shade : shades) {
    PlanarOutline outline = shade.outline;
    for (std::size_t k = 0; k < region.size() && !outline.empty(); ++k)
      outline = left_of(outline, region[k], region[(k + 1) % region.size()] - region[k]);
    if (outline.size() > 2) inside.push_back({std::move(outline), shade.transmittance});
  }
  Halving halving{bands};
  auto lit = halving.lit(region, inside, 0);
  if (lit) *lit = (*lit > negligible * area_of(region)).select(*lit, 0.0);
  return lit;
}

Shades::Shades(const Scene& scene, const Coverings& coverings, std::shared_ptr<const SurfaceOptics> optics)
    : tolerance_(tolerance_of_shapes * extent_of(scene)),
      bands_(number_of_bands(scene)),
      coverings_(coverings),
      optics_(std::move(optics)) {
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

// The shadows on a patch, in its plane.
struct Shades::Shadows {
  FlatPolygon frame;          // of the patch
  std::vector<Shade> covers;  // polygons that lie on the patch
  std::vector<Shade> all;     // with the shadows of polygons before it

  // The shadows of panes among these. They are opaque until let_through() sets their transmittances.
  struct OfPane {
    std::size_t shade = 0;
    PolygonIndex polygon = no_polygon;
  };
  std::vector<OfPane> of_panes;
  std::vector<Spectrum> shares = {};

  // Sets the transmittances of panes towards the light from a place.
  void let_through(const SurfaceOptics& optics, const Point& place, const LightPlace& light) {
    const Vector direction = light.way_from(place).normalized();
    shares.resize(of_panes.size());
    for (std::size_t k = 0; k < of_panes.size(); ++k) {
      shares[k] = optics.spectral_transmittance(of_panes[k].polygon, direction);
      all[of_panes[k].shade].transmittance = &shares[k];
    }
  }

  // The shadows of panes alone, of which each lets one half through, in a single band: where the same panes are before
  // all of a region, its lit share is a power of one half.
  std::vector<Shade> half_of_panes() {
    for (Spectrum& share : shares) share = Spectrum::Constant(1, 0.5);
    std::vector<Shade> panes = covers;
    for (const OfPane& pane : of_panes) panes.push_back(all[pane.shade]);
    return panes;
  }
};

// No more than the first shadow that holds all of the patch. Nothing where there are too many.
std::optional<Shades::Shadows> Shades::shadows_on(const Receiver& patch, const LightPlace& light) const {
  Shadows shadows{flat_patch(patch), {}, {}, {}};
  const FlatPolygon& frame = shadows.frame;
  const PolygonIndex own = patch.place(0.5, 0.5).polygon;

  // 1. Polygons that lie on the patch take its place.
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
      point -= frame.height(point) / frame.normal.dot(along) * along;
    }
    shadows.all.push_back({outline_of(shadow, frame), nullptr});
    if (optics_->is_clear(triangle.polygon)) {
      shadows.of_panes.push_back({shadows.all.size() - 1, triangle.polygon});
    } else if (holds(shadows.all.back().outline, frame.corners)) {
      shadows.all = {shadows.all.back()};
      shadows.of_panes.clear();
      return shadows;
    }
    if (shadows.all.size() > shadows.covers.size() + 1500) return std::nullopt;  // likewise
  }
  return shadows;
}

std::optional<Spectrum> Shades::transmittance(const Receiver& patch, const LightPlace& light) const {
  const SurfacePoint middle = patch.place(0.5, 0.5);
  const Vector way = light.way_from(middle.point);
  if (!(middle.normal.dot(way) > tolerance_of_shapes * way.norm())) return Spectrum(Spectrum::Zero(bands_));
  auto shadows = shadows_on(patch, light);
  if (!shadows) return std::nullopt;
  shadows->let_through(*optics_, middle.point, light);
  const auto exposed = lit_area(shadows->frame.corners, shadows->covers, 1);
  const auto lit = lit_area(shadows->frame.corners, shadows->all, bands_);
  if (!exposed || !lit) return std::nullopt;
  if (!((*exposed)[0] > 0)) return Spectrum(Spectrum::Zero(bands_));
  return Spectrum(*lit / (*exposed)[0]);
}

// The transmittance of panes varies over the part. Where the same panes are before all of it, its middle and its
// corners give the mean right up to the third order. Else the error is that of an even distribution between the
// extremes.
std::optional<LitPart> Shades::lit_part(Shadows& shadows, const std::array<Point, 4>& corners,
                                        const LightPlace& light) const {
  const PlanarOutline region = outline_of(corners, shadows.frame);
  const auto exposed = lit_area(region, shadows.covers, 1);
  const auto lit_as_from = [&](const Point& place) {
    shadows.let_through(*optics_, place, light);
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
