#include "transport/smoothing.h"

#include "base/parallel.h"
#include "base/sampling.h"

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

// Slots of the table that one task looks through, and how many patches there are to a slot.
constexpr std::size_t found_at_once = 4096;
constexpr std::uint32_t slots_at_once = 64;
constexpr std::size_t patches_per_slot = 8;

using Cell = std::array<std::int64_t, 3>;

// Centroids that may be near, with their patches.
struct Candidates {
  std::vector<PatchIndex> patches;
  std::vector<Point> centroids;
};

// The centroids of all patches in cubic cells, found by a hash of the cell.
class Cells {
 public:
  Cells(const PatchMesh& mesh, double edge);

  std::uint32_t slots() const { return mask_ + 1; }
  // The patches of a slot are those at these places of the table; cells may share it.
  std::pair<std::uint32_t, std::uint32_t> places_in(std::uint32_t slot) const {
    return {first_[slot], first_[slot + 1]};
  }
  PatchIndex patch(std::uint32_t place) const { return patches_[place]; }
  const Cell& cell(std::uint32_t place) const { return cells_[place]; }
  // All patches in a cell and in those around: none else is nearer than a cell's edge to what lies in it.
  Candidates around(const Cell& home) const;

 private:
  Cell cell_of(const Point& point) const;
  std::uint32_t slot(const Cell& cell) const;

  double edge_;
  std::uint32_t mask_ = 0;
  std::vector<std::uint32_t> first_;  // per slot; one more at the end
  std::vector<PatchIndex> patches_;
  std::vector<Cell> cells_;       // of patches_
  std::vector<Point> centroids_;  // of patches_
};

Cell Cells::cell_of(const Point& point) const {
  Cell cell{};
  for (int d = 0; d < 3; ++d)
    cell[static_cast<std::size_t>(d)] = static_cast<std::int64_t>(std::floor(point[d] / edge_));
  return cell;
}

std::uint32_t Cells::slot(const Cell& cell) const {
  std::uint32_t state = 0;
  for (const std::int64_t c : cell) state = hash(state ^ (static_cast<std::uint32_t>(c) * 0x9e3779b9U));
  return state & mask_;
}

Cells::Cells(const PatchMesh& mesh, double edge) : edge_(edge) {
  std::uint32_t slots = 1;
  while (slots * patches_per_slot < mesh.size()) slots *= 2;
  mask_ = slots - 1;
  // Sort by counting.
  std::vector<std::uint32_t> slot_of(mesh.size());
  first_.assign(std::size_t{slots} + 1, 0);
  parallel_for((mesh.size() + found_at_once - 1) / found_at_once, [&](std::size_t task) {
    const std::size_t end = std::min<std::size_t>(mesh.size(), (task + 1) * found_at_once);
    for (std::size_t i = task * found_at_once; i < end; ++i) slot_of[i] = slot(cell_of(mesh.centroid[i]));
  });
  for (const std::uint32_t s : slot_of) ++first_[1 + s];
  for (std::size_t s = 0; s < slots; ++s) first_[s + 1] += first_[s];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  patches_.resize(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) patches_[next[slot_of[i]]++] = i;
  cells_.reserve(mesh.size());
  centroids_.reserve(mesh.size());
  for (const PatchIndex i : patches_) {
    cells_.push_back(cell_of(mesh.centroid[i]));
    centroids_.push_back(mesh.centroid[i]);
  }
}

Candidates Cells::around(const Cell& home) const {
  Candidates found;
  for (int k = 0; k < 27; ++k) {
    const Cell cell{home[0] + k / 9 - 1, home[1] + k / 3 % 3 - 1, home[2] + k % 3 - 1};
    const std::uint32_t s = slot(cell);
    for (std::uint32_t p = first_[s]; p < first_[s + 1]; ++p) {
      // Cells may share a slot; each of its patches counts once.
      if (cells_[p] != cell) continue;
      found.patches.push_back(patches_[p]);
      found.centroids.push_back(centroids_[p]);
    }
  }
  return found;
}

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
  std::vector<Neighbour> neighbours(PatchIndex i, const Candidates& candidates) const;
};

// With itself.
std::vector<Neighbour> Smoother::neighbours(PatchIndex i, const Candidates& candidates) const {
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

// Does patch i see other light than its neighbours, as both halves tell? A face that lies a little behind another may
// look into a space of its own.
bool is_apart(PatchIndex i, const SmoothedHalves& smooth, const std::array<Field, 2>& halves,
              const Eigen::Array<double, 1, Eigen::Dynamic>& variance) {
  const auto off = [&](std::size_t half) { return smooth.halves[half].row(i) - halves[half].row(i); };
  const auto own = (0.5 * (halves[0].row(i) - halves[1].row(i))).square();
  return (off(0) * off(1) > most_off * variance.max(own)).any();
}

// The value of patch i in both halves, and the variance of their mean.
void smooth_patch(PatchIndex i, const std::vector<Neighbour>& neighbours, const std::array<Field, 2>& halves,
                  SmoothedHalves& into) {
  using Row = Eigen::Array<double, 1, Eigen::Dynamic>;
  const std::vector<double> c = coefficients(neighbours);
  const Eigen::Index bands = halves[0].cols();
  Row scatter = Row::Zero(bands);
  double weights = 0;
  double squares = 0;
  const auto own = static_cast<Eigen::Index>(i) * bands;
  double* const smooth_a = into.halves[0].data() + own;
  double* const smooth_b = into.halves[1].data() + own;
  std::fill_n(smooth_a, bands, 0.0);
  std::fill_n(smooth_b, bands, 0.0);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const auto of_neighbour = static_cast<Eigen::Index>(neighbours[k].patch) * bands;
    const double* const a = halves[0].data() + of_neighbour;
    const double* const b = halves[1].data() + of_neighbour;
    const double weight = neighbours[k].weight;
    for (Eigen::Index band = 0; band < bands; ++band) {
      smooth_a[band] += c[k] * a[band];
      smooth_b[band] += c[k] * b[band];
      const double off = 0.5 * (a[band] - b[band]);
      scatter[band] += weight * off * off;
    }
    weights += weight;
    squares += c[k] * c[k];
  }
  if (is_apart(i, into, halves, scatter / weights)) {
    for (std::size_t half = 0; half < 2; ++half) into.halves[half].row(i) = halves[half].row(i);
    return;
  }
  into.variance.row(i) = squares / weights * scatter;
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

}  // namespace

SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves) {
  SmoothedHalves into{halves, (0.5 * (halves[0] - halves[1])).square()};
  const Smoother smoother{mesh, distance};
  // Patches by their radius, so that cells are as wide as they look, and then by cells, which share candidates.
  const std::vector<int> level_of = levels_of(smoother);
  const std::set<int> levels(level_of.begin(), level_of.end());
  for (const int level : levels) {
    if (level < 0) continue;
    const Cells cells(mesh, std::ldexp(1.0, level + lowest_level));
    parallel_for((cells.slots() + slots_at_once - 1) / slots_at_once, [&](std::size_t task) {
      const auto begin = static_cast<std::uint32_t>(task * slots_at_once);
      for (std::uint32_t slot = begin; slot < std::min(cells.slots(), begin + slots_at_once); ++slot) {
        std::optional<Cell> cell;
        Candidates candidates;
        const auto [first, last] = cells.places_in(slot);
        for (std::uint32_t place = first; place < last; ++place) {
          const PatchIndex i = cells.patch(place);
          if (level_of[i] != level) continue;
          if (cells.cell(place) != cell) {
            cell = cells.cell(place);
            candidates = cells.around(*cell);
          }
          const std::vector<Neighbour> neighbours = smoother.neighbours(i, candidates);
          if (neighbours.size() > 1) smooth_patch(i, neighbours, halves, into);
        }
      }
    });
  }
  return into;
}

}  // namespace patchlight
