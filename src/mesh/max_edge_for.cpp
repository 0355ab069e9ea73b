#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/cut_polygons.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

double diameter(const Scene& scene) { return bounds(scene).diagonal().norm(); }

double diameter(const std::vector<Point>& points) {
  Box box;
  for (const Point& point : points) box.extend(point);
  return box.diagonal().norm();
}

// Numbers of patches by the longest edge, each counted once.
class Numbers {
 public:
  explicit Numbers(std::function<double(double)> count) : count_(std::move(count)) {}

  double with_edge(double edge) {
    const auto [known, is_new] = known_.try_emplace(edge, 0.0);
    if (is_new) known->second = count_(edge);
    return known->second;
  }
  const std::map<double, double>& known() const { return known_; }
  // The edge with the number that is nearest.
  double nearest(double wanted) const {
    const auto nearer = [wanted](const auto& a, const auto& b) {
      return std::abs(a.second - wanted) < std::abs(b.second - wanted);
    };
    return std::min_element(known_.begin(), known_.end(), nearer)->first;
  }

 private:
  std::function<double(double)> count_;
  std::map<double, double> known_;
};

// Bounds on the edge length that gives a number of patches, in meters.
struct Bracket {
  double too_long;
  double few;            // patches
  double too_short = 0;  // 0 when none is known
  double many = 0;
};

// From the known numbers; `wanted` is more than that of the longest edge.
Bracket bracket_of(const std::map<double, double>& numbers, double wanted) {
  const auto too_long =
      std::find_if(numbers.begin(), numbers.end(), [wanted](const auto& entry) { return entry.second < wanted; });
  assert(too_long != numbers.end());
  Bracket bracket{too_long->first, too_long->second};
  if (too_long == numbers.begin()) return bracket;
  bracket.too_short = std::prev(too_long)->first;
  bracket.many = std::prev(too_long)->second;
  return bracket;
}

// The number above the least goes about as edge^-2, and is as if linear in that between two that are known.
double guess_in(const Bracket& bracket, double wanted, double least, double first) {
  if (bracket.too_short > 0) {
    const double a = 1 / (bracket.too_long * bracket.too_long);
    const double b = 1 / (bracket.too_short * bracket.too_short);
    return 1 / std::sqrt(a + (b - a) * (wanted - bracket.few) / (bracket.many - bracket.few));
  }
  if (first < bracket.too_long) return first;
  // Few faces may be cut yet of many that are as large: one step takes no more than sixteen times as many patches.
  if (bracket.few <= least) return 0.5 * bracket.too_long;
  return bracket.too_long * std::max(0.25, std::sqrt((bracket.few - least) / (wanted - least)));
}

double middle_of(const Bracket& bracket) {
  return bracket.too_short > 0 ? std::sqrt(bracket.too_short * bracket.too_long) : 0.5 * bracket.too_long;
}

double possible(std::size_t patches) {
  const double wanted = static_cast<double>(std::max<std::size_t>(patches, 1));
  if (wanted > max_patches) throw MemoryError("mesh.patches: too many (limit 2^31)");
  return wanted;
}

}  // namespace

// The polygons for one edge, and the numbers of their patches for several.
class EdgeSearch::PatchNumber {
 public:
  PatchNumber(const Scene& scene, const KeptSides& sides, const ContactLines& contacts)
      : scene_(scene),
        sides_(sides),
        contacts_(contacts),
        loose_(find_loose_corners(scene)),
        whole_(scene.polygons.size()),
        longest_(diameter(scene)) {}

  Numbers numbers{[this](double edge) { return counted(edge); }};
  Numbers parts_of_parents{[this](double edge) { return counted_nested(edge); }};

  double least() { return numbers.with_edge(longest_); }

  // The edge for a number of patches. `close_enough` is the tolerance relative to the number above the least. If the
  // least is nearly all of them, a tolerance relative to the total would not control the size of patches on large
  // faces.
  double edge_for(Numbers& counts, std::size_t patches, double close_enough) const {
    const double wanted = possible(patches);
    // 1. No number below that of the uncut scene.
    const double least = counts.with_edge(longest_);
    if (least >= wanted) return longest_;
    //    The first guess is for a sixteenth of the patches: a cheap look at how many a square meter gets.
    const double first = std::min(0.5 * longest_, 4 * std::sqrt(kept_area(scene_, sides_) / wanted));

    // 2. Keep the edge between one that gives too few patches and one that gives too many. Where the number changes in
    //    steps, so that one end stays where it is, halve the interval.
    const double same_edge = 1 + close_enough / 2;  // as the number goes as edge^-2
    const double off = close_enough * (wanted - least);
    double best = counts.nearest(wanted);
    int same_end = 0;
    for (int guess = 0; guess < 100 && std::abs(counts.with_edge(best) - wanted) > off; ++guess) {
      const Bracket bracket = bracket_of(counts.known(), wanted);
      if (bracket.too_long <= same_edge * bracket.too_short) break;
      const double likely = guess_in(bracket, wanted, least, first);
      const bool inside = likely > bracket.too_short && likely < bracket.too_long && std::abs(same_end) < 2;
      const bool is_few = counts.with_edge(inside ? likely : middle_of(bracket)) < wanted;
      same_end = is_few ? std::max(same_end, 0) + 1 : std::min(same_end, 0) - 1;
      if (!inside) same_end = 0;
      best = counts.nearest(wanted);
    }
    return best;
  }

 private:
  double counted(double edge) {
    std::vector<std::size_t> counts(scene_.polygons.size(), 0);
    const std::vector<Outline> outlines = outlines_for(edge);
    parallel_for(counts.size(), [&](std::size_t p) {
      if (kept(p) == 0) return;
      counts[p] = kept(p) * (whole_[p] ? whole_[p]->size() : count_patches(outlines[p], edge));
    });
    return static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  }

  double counted_nested(double edge) {
    std::vector<std::vector<double>> edges(scene_.polygons.size());
    const std::vector<Outline> outlines = outlines_for(edge);
    parallel_for(edges.size(), [&](std::size_t p) {
      if (kept(p) > 0 && !whole_[p]) edges[p] = longest_edges(outlines[p], edge);
    });
    const auto edges_on = [&](std::size_t p) -> const std::vector<double>& {
      return whole_[p] ? *whole_[p] : edges[p];
    };
    double longest = 0;
    for (std::size_t p = 0; p < edges.size(); ++p) {
      for (const double one : edges_on(p)) longest = std::max(longest, one);
    }
    double number = 0;
    for (std::size_t p = 0; p < edges.size(); ++p) {
      for (const double one : edges_on(p)) number += static_cast<double>(kept(p) * parts_of_parent(one, longest));
    }
    return number;
  }

  // The outlines of the polygons that are kept and not known to stay whole. Beyond twice its size neither lattice nor
  // outline of a polygon depend on the longest edge (lattice_spacing() in polygon_mesh.cpp): then its patches are
  // remembered, as long as the same lines are followed.
  std::vector<Outline> outlines_for(double edge) {
    const double detail = contacts_.on.empty() ? 0 : followed_detail(contacts_, edge);
    const bool same_detail = detail_ == detail;
    polygons_ = cut_again(std::move(polygons_), scene_, loose_, contacts_, edge, same_detail);
    detail_ = detail;
    const auto is_small = [&](std::size_t p) { return !is_loose(p) && edge >= 2 * diameter(polygons_[p].corners); };
    std::vector<std::uint8_t> is_needed(polygons_.size());
    parallel_for(is_needed.size(), [&](std::size_t p) {
      if (!same_detail || !is_small(p)) whole_[p].reset();
      is_needed[p] = kept(p) > 0 && !whole_[p] ? 1 : 0;
    });
    std::vector<Outline> outlines = cut_outlines(polygons_, edge, is_needed);
    parallel_for(is_needed.size(), [&](std::size_t p) {
      if (is_needed[p] && is_small(p)) whole_[p] = longest_edges(outlines[p], edge);
    });
    return outlines;
  }

  std::size_t kept(std::size_t polygon) const { return sides_.front[polygon] + sides_.back[polygon]; }
  bool is_loose(std::size_t polygon) const { return !loose_.empty() && !loose_[polygon].empty(); }

  const Scene& scene_;
  const KeptSides& sides_;
  const ContactLines& contacts_;
  LooseCorners loose_;
  std::optional<double> detail_;                           // of the lines that the polygons below follow, meters
  std::vector<CutPolygon> polygons_;                       // with these lines
  std::vector<std::optional<std::vector<double>>> whole_;  // longest edges of the patches of polygons that stay whole
  double longest_;                                         // meters: leaves the scene uncut
};

std::size_t number_of_patches(const Scene& scene, const KeptSides& sides, double max_edge,
                              const ContactLines& contacts) {
  require_so_many_patches(scene, sides, max_edge);
  return static_cast<std::size_t>(EdgeSearch(scene, sides, contacts).patches_with(max_edge));
}

std::size_t least_patches(const Scene& scene, const KeptSides& sides, const ContactLines& contacts) {
  return number_of_patches(scene, sides, diameter(scene), contacts);
}

std::vector<std::size_t> left_out_corners(const Scene& scene, double max_edge) {
  const LooseCorners loose = find_loose_corners(scene);
  std::vector<std::size_t> counts(scene.polygons.size(), 0);
  if (loose.empty()) return counts;
  parallel_for(counts.size(), [&](std::size_t p) {
    const auto polygon = static_cast<PolygonIndex>(p);
    if (loose[p].empty()) return;
    counts[p] = outline_corners(scene, polygon).size() - coarse_outline(scene, loose, polygon, max_edge).size();
  });
  return counts;
}

EdgeSearch::EdgeSearch(const Scene& scene, const KeptSides& sides, const ContactLines& contacts)
    : number_(std::make_unique<PatchNumber>(scene, sides, contacts)) {}

EdgeSearch::~EdgeSearch() = default;

double EdgeSearch::patches_with(double max_edge) { return number_->numbers.with_edge(max_edge); }

double EdgeSearch::nested_patches_with(double max_edge) { return number_->parts_of_parents.with_edge(max_edge); }

std::size_t EdgeSearch::least_patches() { return static_cast<std::size_t>(number_->least()); }

double EdgeSearch::edge_for(std::size_t patches) { return number_->edge_for(number_->numbers, patches, 0.005); }

double EdgeSearch::nested_edge_for(std::size_t patches) {
  return number_->edge_for(number_->parts_of_parents, patches, 0.05);
}

double max_edge_for(const Scene& scene, const KeptSides& sides, std::size_t patches, const ContactLines& contacts) {
  return EdgeSearch(scene, sides, contacts).edge_for(patches);
}

}  // namespace patchlight
