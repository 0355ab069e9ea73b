#include "transport/smoothing.h"

#include "base/parallel.h"
#include "base/sampling.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
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

constexpr std::size_t smoothed_at_once = 256;

// The centroids of all patches in cubic cells, found by a hash of the cell.
class Cells {
 public:
  Cells(const PatchMesh& mesh, double edge);

  // Calls use(patch, from the point to its centroid) for all patches whose centroids lie within a distance of a point
  // that is at most a cell's edge.
  template <typename Use>
  void for_near(const Point& point, double distance, Use use) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Point& point) const;
  std::uint32_t slot(const Cell& cell) const;

  double edge_;
  std::uint32_t mask_ = 0;
  std::vector<std::uint32_t> first_;  // per slot; one more at the end
  std::vector<PatchIndex> patches_;
  std::vector<Point> centroids_;  // of patches_
};

Cells::Cell Cells::cell_of(const Point& point) const {
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
  while (slots < mesh.size()) slots *= 2;
  mask_ = slots - 1;
  // Sort by counting.
  std::vector<std::uint32_t> slot_of(mesh.size());
  first_.assign(std::size_t{slots} + 1, 0);
  for (PatchIndex i = 0; i < mesh.size(); ++i) ++first_[1 + (slot_of[i] = slot(cell_of(mesh.centroid[i])))];
  for (std::size_t s = 0; s < slots; ++s) first_[s + 1] += first_[s];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  patches_.resize(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) patches_[next[slot_of[i]]++] = i;
  centroids_.reserve(mesh.size());
  for (const PatchIndex i : patches_) centroids_.push_back(mesh.centroid[i]);
}

template <typename Use>
void Cells::for_near(const Point& point, double distance, Use use) const {
  const Cell home = cell_of(point);
  for (int k = 0; k < 27; ++k) {
    const Cell cell{home[0] + k / 9 - 1, home[1] + k / 3 % 3 - 1, home[2] + k % 3 - 1};
    const std::uint32_t s = slot(cell);
    for (std::uint32_t p = first_[s]; p < first_[s + 1]; ++p) {
      const Vector to = centroids_[p] - point;
      // Cells may share a slot; each of its patches counts once.
      if (to.squaredNorm() <= distance * distance && cell_of(centroids_[p]) == cell) use(patches_[p], to);
    }
  }
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
  std::vector<Neighbour> neighbours(PatchIndex i, const Cells& cells) const;
};

// With itself.
std::vector<Neighbour> Smoother::neighbours(PatchIndex i, const Cells& cells) const {
  const double r = radius(i);
  const Vector& normal = mesh.normal[i];
  const Vector along = normal.unitOrthogonal();
  const Vector across = normal.cross(along);
  std::vector<Neighbour> found;
  cells.for_near(mesh.centroid[i], r, [&](PatchIndex j, const Vector& to) {
    const double squared = to.squaredNorm();
    const double cosine = normal.dot(mesh.normal[j]);
    if (cosine < least_cosine) return;
    const double reach_of_other = reach * static_cast<double>(distance[j]);
    if (squared > reach_of_other * reach_of_other || std::abs(to.dot(normal)) > off_plane * r) return;
    const double near = 1 - 0.75 * squared / (r * r);
    const double alike = (cosine - least_cosine) / (1 - least_cosine);
    found.push_back({j, mesh.area[j] * near * alike, to.dot(along) / r, to.dot(across) / r});
  });
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
  const std::vector<double> c = coefficients(neighbours);
  Eigen::Array<double, 1, Eigen::Dynamic> scatter = Eigen::Array<double, 1, Eigen::Dynamic>::Zero(halves[0].cols());
  double weights = 0;
  double squares = 0;
  for (std::size_t half = 0; half < 2; ++half) into.halves[half].row(i).setZero();
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const auto& [j, weight, u, v] = neighbours[k];
    for (std::size_t half = 0; half < 2; ++half) into.halves[half].row(i) += c[k] * halves[half].row(j);
    scatter += weight * (0.5 * (halves[0].row(j) - halves[1].row(j))).square();
    weights += weight;
    squares += c[k] * c[k];
  }
  if (is_apart(i, into, halves, scatter / weights)) {
    for (std::size_t half = 0; half < 2; ++half) into.halves[half].row(i) = halves[half].row(i);
    return;
  }
  into.variance.row(i) = squares / weights * scatter;
}

}  // namespace

SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves) {
  SmoothedHalves into{halves, (0.5 * (halves[0] - halves[1])).square()};
  const Smoother smoother{mesh, distance};
  // Patches by the power of two next above their radius, so that cells are as wide as they look.
  std::vector<std::vector<PatchIndex>> by_level;
  constexpr int lowest = -32;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double r = smoother.radius(i);
    if (!(r > 0)) continue;
    const auto level = static_cast<std::size_t>(std::max(0, static_cast<int>(std::ceil(std::log2(r))) - lowest));
    if (by_level.size() <= level) by_level.resize(level + 1);
    by_level[level].push_back(i);
  }
  for (std::size_t level = 0; level < by_level.size(); ++level) {
    const std::vector<PatchIndex>& patches = by_level[level];
    if (patches.empty()) continue;
    const Cells cells(mesh, std::ldexp(1.0, static_cast<int>(level) + lowest));
    parallel_for((patches.size() + smoothed_at_once - 1) / smoothed_at_once, [&](std::size_t task) {
      const std::size_t end = std::min(patches.size(), (task + 1) * smoothed_at_once);
      for (std::size_t k = task * smoothed_at_once; k < end; ++k) {
        const std::vector<Neighbour> neighbours = smoother.neighbours(patches[k], cells);
        if (neighbours.size() > 1) smooth_patch(patches[k], neighbours, halves, into);
      }
    });
  }
  return into;
}

}  // namespace patchlight
