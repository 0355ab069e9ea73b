#include "transport/smoothing.h"

#include "base/parallel.h"
#include "transport/patch_cells.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace patchlight {
namespace {

// Neighbours lie within this share of the mean distance of what is seen.
constexpr double reach = 0.2;

// About so many at most.
constexpr double most_neighbours = 32;

// Their normals' cosine is above this one, that of 25 degrees.
constexpr double least_cosine = 0.9;

// They lie no farther from the patch's plane than this share of the radius.
constexpr double off_plane = 0.2;

// The slopes of the regression are held back by this share of the weights, so that it is a mean where neighbours lie on
// one side.
constexpr double ridge = 0.05;

// Slots of cells that one task looks through.
constexpr std::uint32_t slots_at_once = 64;

struct Neighbour {
  PatchIndex patch = 0;
  double weight = 0;
  double u = 0, v = 0;  // place in the plane, in radii
};

struct Smoother {
  const PatchMesh& mesh;
  std::span<const float> distance;

  double radius(PatchIndex i) const {
    return std::min(reach * static_cast<double>(distance[i]),
                    std::sqrt(most_neighbours / std::numbers::pi * mesh.area[i]));
  }
  std::vector<Neighbour> neighbours(PatchIndex i, const NearPatches& candidates) const;
};

// With itself.
std::vector<Neighbour> Smoother::neighbours(PatchIndex i, const NearPatches& candidates) const {
  const double r = radius(i);
  const Point& centroid = mesh.centroid[i];
  const Vector& normal = mesh.normal[i];
  const Vector along = normal.unitOrthogonal();
  const Vector across = normal.cross(along);
  std::vector<Neighbour> found;
  found.reserve(2 * static_cast<std::size_t>(most_neighbours));
  for (std::size_t k = 0; k < candidates.patches.size(); ++k) {
    const Vector to = candidates.centroids[k] - centroid;
    const double squared = to.squaredNorm();
    if (squared > r * r) continue;
    const PatchIndex j = candidates.patches[k];
    const double cosine = normal.dot(mesh.normal[j]);
    if (cosine < least_cosine) continue;
    const double reach_of_other = reach * static_cast<double>(distance[j]);
    if (squared > reach_of_other * reach_of_other || std::abs(to.dot(normal)) > off_plane * r) continue;
    const double near = 1 - 0.75 * squared / (r * r);
    const double alike = (cosine - least_cosine) / (1 - least_cosine);
    found.push_back({j, mesh.area[j] * near * alike, to.dot(along) / r, to.dot(across) / r});
  }
  return found;
}

// What each neighbour's value counts in the regression's value at the centroid; they sum up to 1.
std::vector<double> coefficients(const std::vector<Neighbour>& neighbours) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : neighbours) {
    const Vector basis(1, n.u, n.v);
    moments += n.weight * basis * basis.transpose();
  }
  moments(1, 1) += ridge * moments(0, 0);
  moments(2, 2) += ridge * moments(0, 0);
  const Vector dual = moments.inverse().col(0);
  std::vector<double> of_each;
  of_each.reserve(neighbours.size());
  double sum = 0;
  for (const Neighbour& n : neighbours) sum += of_each.emplace_back(n.weight * dual.dot(Vector(1, n.u, n.v)));
  for (double& c : of_each) c /= sum;
  return of_each;
}

// Two halves with errors of this variance alone, 2 v in each of them, have a product of their distances from what is
// smoothed that is more than nine of it once in some 500 times.
constexpr double most_off = 9;

// The same places of fields of as many patches and bands.
struct Smoothing {
  const std::array<Field, 2>& halves;
  SmoothedHalves& into;
};

// Of neighbours with their coefficients: the means of `width` bands from `place` on in both halves, and as the variance
// the weighted sum of the squares of what either half is off their mean.
template <std::size_t width>
void sum_up(const Smoothing& fields, Eigen::Index place, Eigen::Index band, const std::vector<Neighbour>& neighbours,
            const std::vector<double>& c) {
  using Sum = std::array<double, width>;
  Sum mean_a{};
  Sum mean_b{};
  Sum scatter{};
  const Eigen::Index bands = fields.halves[0].cols();
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const Eigen::Index of_neighbour = static_cast<Eigen::Index>(neighbours[k].patch) * bands + band;
    const double* const a = fields.halves[0].data() + of_neighbour;
    const double* const b = fields.halves[1].data() + of_neighbour;
    for (std::size_t w = 0; w < width; ++w) {
      const double off = 0.5 * (a[w] - b[w]);
      mean_a[w] += c[k] * a[w];
      mean_b[w] += c[k] * b[w];
      scatter[w] += neighbours[k].weight * off * off;
    }
  }
  std::copy_n(mean_a.begin(), width, fields.into.halves[0].data() + place);
  std::copy_n(mean_b.begin(), width, fields.into.halves[1].data() + place);
  std::copy_n(scatter.begin(), width, fields.into.variance.data() + place);
}

using SumUp = void (*)(const Smoothing&, Eigen::Index place, Eigen::Index band, const std::vector<Neighbour>&,
                       const std::vector<double>&);
constexpr std::array<SumUp, 4> sum_up_of_width{sum_up<1>, sum_up<2>, sum_up<3>, sum_up<4>};

double squared_difference(const std::array<Field, 2>& halves, Eigen::Index place) {
  const double half = 0.5 * (halves[0].data()[place] - halves[1].data()[place]);
  return half * half;
}

// Does a patch, its bands at [first, last), see other light than its neighbours, as both halves tell? A face that lies
// a little behind another may look into a space of its own. The variance is that of `fields` times a factor.
bool is_apart(const Smoothing& fields, Eigen::Index first, Eigen::Index last, double factor) {
  for (Eigen::Index place = first; place < last; ++place) {
    const auto off = [&](std::size_t half) {
      return fields.into.halves[half].data()[place] - fields.halves[half].data()[place];
    };
    const double variance =
        std::max(factor * fields.into.variance.data()[place], squared_difference(fields.halves, place));
    if (off(0) * off(1) > most_off * variance) return true;
  }
  return false;
}

// The value of patch i in both halves, and the variance of their mean.
void smooth_patch(PatchIndex i, const std::vector<Neighbour>& neighbours, const Smoothing& fields) {
  const std::vector<double> c = coefficients(neighbours);
  const Eigen::Index bands = fields.halves[0].cols();
  const Eigen::Index first = static_cast<Eigen::Index>(i) * bands;
  const auto most = static_cast<Eigen::Index>(sum_up_of_width.size());
  for (Eigen::Index band = 0; band < bands; band += most) {
    const auto width = static_cast<std::size_t>(std::min(most, bands - band));
    sum_up_of_width[width - 1](fields, first + band, band, neighbours, c);
  }

  double weights = 0;
  for (const Neighbour& neighbour : neighbours) weights += neighbour.weight;
  auto& [halves, variance] = fields.into;
  if (is_apart(fields, first, first + bands, 1 / weights)) {
    for (std::size_t half = 0; half < 2; ++half) halves[half].row(i) = fields.halves[half].row(i);
    for (Eigen::Index place = first; place < first + bands; ++place)
      variance.data()[place] = squared_difference(fields.halves, place);
    return;
  }
  double squares = 0;
  for (const double of_each : c) squares += of_each * of_each;
  variance.row(i) *= squares / weights;
}

// The lowest power of two that a cell's edge may be.
constexpr int lowest_level = -32;

// The power of two next above each patch's radius, from the lowest on; -1 where nothing is smoothed.
std::vector<int> levels_of(const Smoother& smoother) {
  std::vector<int> levels(smoother.mesh.size(), -1);
  for (PatchIndex i = 0; i < smoother.mesh.size(); ++i) {
    const double r = smoother.radius(i);
    if (r > 0) levels[i] = std::max(0, static_cast<int>(std::ceil(std::log2(r))) - lowest_level);
  }
  return levels;
}

// The patches of a slot that are of this level; those of one cell follow each other, and share candidates.
void smooth_slot(const Smoother& smoother, const PatchCells& cells, std::uint32_t slot,
                 const std::vector<int>& level_of, int level, const Smoothing& fields) {
  std::optional<Cell> cell;
  NearPatches candidates;
  const auto [first, last] = cells.places_in(slot);
  for (std::uint32_t place = first; place < last; ++place) {
    const PatchIndex i = cells.patch(place);
    if (level_of[i] != level) continue;
    if (cells.cell(place) != cell) {
      cell = cells.cell(place);
      candidates = cells.around(*cell);
    }
    const std::vector<Neighbour> neighbours = smoother.neighbours(i, candidates);
    if (neighbours.size() > 1) smooth_patch(i, neighbours, fields);
  }
}

}  // namespace

SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves) {
  SmoothedHalves into{halves, (0.5 * (halves[0] - halves[1])).square()};
  const Smoother smoother{mesh, distance};
  // Patches by their radius, so that cells are as wide as they look.
  const std::vector<int> level_of = levels_of(smoother);
  const std::set<int> levels(level_of.begin(), level_of.end());
  for (const int level : levels) {
    if (level < 0) continue;
    const PatchCells cells(mesh, std::ldexp(1.0, level + lowest_level));
    parallel_for((cells.slots() + slots_at_once - 1) / slots_at_once, [&](std::size_t task) {
      const auto begin = static_cast<std::uint32_t>(task * slots_at_once);
      const std::uint32_t end = std::min(cells.slots(), begin + slots_at_once);
      for (std::uint32_t slot = begin; slot < end; ++slot)
        smooth_slot(smoother, cells, slot, level_of, level, {halves, into});
    });
  }
  return into;
}

}  // namespace patchlight
