#include "lighting/lit_area.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// Shades of a region that are looked at together; where there are more the region is halved, so often at most.
constexpr std::size_t few_shades = 12;
constexpr std::size_t most_shades = 100;
constexpr int most_halvings = 16;

// Outlines cut before a region counts as too complicated.
constexpr std::size_t most_cuts = 6000;

// A share of the region that counts as nothing: rounding.
constexpr double negligible = 1e-13;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Interval {
  double from = 0;
  double to = 0;
};

struct Pane {
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
Spectrum through_panes(const Interval& whole, const std::vector<Pane>& panes, Eigen::Index bands) {
  if (panes.empty()) return Spectrum::Constant(bands, whole.to - whole.from);
  std::vector<double> ends{whole.from, whole.to};
  for (const Pane& pane : panes) {
    for (const double end : {pane.interval.from, pane.interval.to})
      if (end > whole.from && end < whole.to) ends.push_back(end);
  }
  std::sort(ends.begin(), ends.end());
  Spectrum sum = Spectrum::Zero(bands);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double middle = (ends[k] + ends[k + 1]) / 2;
    Spectrum share = Spectrum::Constant(bands, ends[k + 1] - ends[k]);
    for (const Pane& pane : panes)
      if (pane.interval.from < middle && middle < pane.interval.to) share *= *pane.transmittance;
    sum += share;
  }
  return sum;
}

// The same over what is left of an interval without the dark ones.
Spectrum lit_length(const Interval& whole, std::vector<Interval> dark, const std::vector<Pane>& panes,
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

// By strips between the heights at which edges begin or cross: in each the lit length is linear in the height, so that
// its middle gives the mean.
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
    std::vector<Pane> panes;
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

struct Halving {
  Eigen::Index bands = 0;
  std::size_t cuts = 0;  // made so far

  std::optional<Spectrum> lit(const PlanarOutline& region, const std::vector<Shade>& shades, int depth);
  std::optional<Spectrum> lit_in_halves(const PlanarOutline& region, const std::vector<Shade>& shades, int depth);
};

// Shades lie inside the region.
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
  const bool halves = in_part.size() > few_shades && depth < most_halvings;
  if (!halves && in_part.size() > most_shades) return std::nullopt;
  const auto rest = halves ? lit_in_halves(region, in_part, depth) : area_by_strips(region, in_part, bands);
  if (!rest) return std::nullopt;
  return Spectrum(everywhere * *rest);
}

// Cut across the longer side of the box around the region.
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
    if (cuts > most_cuts) return std::nullopt;
    const auto lit_there = lit(left_of(region, box.center(), along), there, depth + 1);
    if (!lit_there) return std::nullopt;
    sum += *lit_there;
  }
  return sum;
}

}  // namespace

double area_of(const PlanarOutline& outline) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < outline.size(); ++k)
    sum += cross(outline[k] - outline[0], outline[k + 1] - outline[0]) / 2;
  return sum;
}

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

}  // namespace patchlight
