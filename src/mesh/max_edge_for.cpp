#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/cut_outlines.h"
#include "mesh/mesher.h"
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
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

// Polygons with the lines that patches of about one size follow.
struct FollowedLines {
  std::vector<CutPolygon> polygons;
  std::vector<std::optional<std::size_t>> whole;  // patches of a polygon that is far smaller than the longest edge
};

// Edges between which that for some number of patches lies, metres.
struct Bracket {
  double too_long;
  double too_short;  // 0 when none is known
  double best;       // that is known
  double guess;
};

}  // namespace

// The number of patches by the longest edge. What is the same for many edges is found once.
class EdgeSearch::PatchNumber {
 public:
  PatchNumber(const Scene& scene, const KeptSides& sides, const ContactLines& contacts)
      : scene_(scene),
        sides_(sides),
        contacts_(contacts),
        loose_(find_loose_corners(scene)),
        longest_(diameter(scene)) {}

  double longest() const { return longest_; }

  double with_edge(double edge) {
    const auto [known, is_new] = numbers_.try_emplace(edge, 0.0);
    if (is_new) known->second = counted(edge);
    return known->second;
  }

  // What numbers that are known tell of the edge for another one, which is more than that of the longest.
  Bracket bracket(double wanted) const {
    const auto too_long =
        std::find_if(numbers_.begin(), numbers_.end(), [wanted](const auto& entry) { return entry.second < wanted; });
    assert(too_long != numbers_.end());
    const auto [long_edge, few] = *too_long;
    if (too_long == numbers_.begin()) {
      //    The first guess is for a sixteenth of the patches: a cheap look at how many a square metre gets.
      const double first = std::min(0.5 * longest_, 4 * std::sqrt(kept_area(scene_, sides_) / wanted));
      const double next = long_edge < longest_ ? long_edge * std::sqrt(few / wanted) : first;
      return {long_edge, 0, long_edge, next};
    }
    const auto [short_edge, many] = *std::prev(too_long);
    const double best = wanted - few < many - wanted ? long_edge : short_edge;
    return {long_edge, short_edge, best, std::sqrt(long_edge * short_edge)};
  }

 private:
  double counted(double edge) {
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
  double longest_;                            // metres: that leaves the scene uncut
  std::map<double, FollowedLines> followed_;  // by followed_detail()
  std::map<double, double> numbers_;          // by the edge
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

double EdgeSearch::patches_with(double max_edge) { return number_->with_edge(max_edge); }

std::size_t EdgeSearch::least_patches() { return static_cast<std::size_t>(number_->with_edge(number_->longest())); }

double EdgeSearch::edge_for(std::size_t patches) {
  constexpr double close_enough = 0.005;
  constexpr double same_edge = 1 + close_enough / 2;  // as the number goes as edge^-2
  const double wanted = static_cast<double>(std::max<std::size_t>(patches, 1));
  if (wanted > max_patches) throw MemoryError("found a wish for over 2^31 patches; expected fewer");

  // 1. No number below that of the uncut scene.
  const double longest = number_->longest();
  if (number_->with_edge(longest) >= wanted) return longest;

  // 2. Keep the edge between one that gives too few patches and one that gives too many. The number goes as edge^-2;
  //    where this guess fails because the number changes in steps, halve the interval.
  Bracket bracket = number_->bracket(wanted);
  double best = bracket.best;
  double best_error = std::abs(number_->with_edge(best) - wanted);
  double edge = bracket.guess;
  for (int guesses = 1; best_error > close_enough * wanted && bracket.too_long > same_edge * bracket.too_short;
       ++guesses) {
    const double number = number_->with_edge(edge);
    const double error = std::abs(number - wanted);
    if (error < best_error) best = edge, best_error = error;
    (number < wanted ? bracket.too_long : bracket.too_short) = edge;
    edge *= std::sqrt(number / wanted);
    const bool inside = edge > bracket.too_short && edge < bracket.too_long;
    if (!inside || guesses % 5 == 0)
      edge = bracket.too_short > 0 ? std::sqrt(bracket.too_short * bracket.too_long) : 0.5 * bracket.too_long;
  }
  return best;
}

double max_edge_for(const Scene& scene, const KeptSides& sides, std::size_t patches, const ContactLines& contacts) {
  return EdgeSearch(scene, sides, contacts).edge_for(patches);
}

}  // namespace patchlight
