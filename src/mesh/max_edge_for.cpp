#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/cut_outlines.h"
#include "mesh/mesher.h"
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <cmath>
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

// Polygons with the lines that patches of about one size follow.
struct FollowedLines {
  std::vector<CutPolygon> polygons;
  std::vector<std::optional<std::size_t>> whole;  // patches of a polygon that is far smaller than the longest edge
};

// The number of patches by the longest edge. What is the same for many edges is found once.
class PatchNumber {
 public:
  PatchNumber(const Scene& scene, const KeptSides& sides, const ContactLines& contacts)
      : scene_(scene), sides_(sides), contacts_(contacts), loose_(find_loose_corners(scene)) {}

  double with_edge(double edge) {
    FollowedLines& known = followed_[contacts_.on.empty() ? 0 : followed_detail(contacts_, edge)];
    known.polygons = cut_again(std::move(known.polygons), scene_, loose_, contacts_, edge);
    known.whole.resize(known.polygons.size());
    const std::vector<Outline> outlines = cut_outlines(known.polygons, edge);
    std::vector<std::size_t> counts(outlines.size(), 0);
    parallel_for(counts.size(), [&](std::size_t p) {
      const std::size_t kept = sides_.front[p] + sides_.back[p];
      if (kept > 0) counts[p] = kept * number_on(outlines[p], edge, is_loose(p), known.whole[p]);
    });
    return static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  }

 private:
  bool is_loose(std::size_t polygon) const { return !loose_.empty() && !loose_[polygon].empty(); }

  // Beyond twice its size neither lattice nor outline of a polygon depend on the longest edge (lattice_spacing() in
  // refine_polygon.cpp): then its number is remembered.
  static std::size_t number_on(const Outline& outline, double edge, bool is_loose, std::optional<std::size_t>& whole) {
    constexpr double far_smaller = 2;
    if (is_loose || edge < far_smaller * diameter(outline.corners)) return count_patches(outline, edge);
    if (!whole) whole = count_patches(outline, edge);
    return *whole;
  }

  const Scene& scene_;
  const KeptSides& sides_;
  const ContactLines& contacts_;
  LooseCorners loose_;
  std::map<double, FollowedLines> followed_;  // by followed_detail()
};

}  // namespace

std::size_t number_of_patches(const Scene& scene, const KeptSides& sides, double max_edge,
                              const ContactLines& contacts) {
  require_so_many_patches(scene, sides, max_edge);
  return static_cast<std::size_t>(PatchNumber(scene, sides, contacts).with_edge(max_edge));
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

double max_edge_for(const Scene& scene, const KeptSides& sides, std::size_t patches, const ContactLines& contacts) {
  constexpr double close_enough = 0.005;
  constexpr double same_edge = 1 + close_enough / 2;  // as the number goes as edge^-2
  const double wanted = static_cast<double>(std::max<std::size_t>(patches, 1));
  if (wanted > max_patches) throw MemoryError("found a wish for over 2^31 patches; expected fewer");
  PatchNumber patch_number(scene, sides, contacts);
  const auto count = [&](double edge) { return patch_number.with_edge(edge); };

  // 1. No number below that of the uncut scene.
  double too_long = diameter(scene);
  double best = too_long;
  double best_error = wanted - count(too_long);
  if (best_error <= 0) return best;

  // 2. Keep the edge between one that gives too few patches and one that gives too many. The number goes as edge^-2;
  //    where this guess fails because the number changes in steps, halve the interval.
  double too_short = 0;
  //    The first guess is for a sixteenth of the patches: a cheap look at how many a square metre gets.
  double edge = std::min(0.5 * too_long, 4 * std::sqrt(kept_area(scene, sides) / wanted));
  for (int guesses = 1; too_long > same_edge * too_short; ++guesses) {
    const double number = count(edge);
    const double error = std::abs(number - wanted);
    if (error < best_error) best = edge, best_error = error;
    if (error <= close_enough * wanted) break;
    (number < wanted ? too_long : too_short) = edge;
    edge *= std::sqrt(number / wanted);
    const bool inside = edge > too_short && edge < too_long;
    if (!inside || guesses % 5 == 0) edge = too_short > 0 ? std::sqrt(too_short * too_long) : 0.5 * too_long;
  }
  return best;
}

}  // namespace patchlight
