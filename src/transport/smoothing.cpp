#include "transport/smoothing.h"

#include "base/parallel.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace patchlight {
namespace {

// Bits of a place along one axis: those of three axes fit into one number.
constexpr int bits = 20;

// Patches of one task.
constexpr std::size_t patches_of_task = 1024;

using Places = std::array<std::uint64_t, 3>;  // along x, y and z

// The lower bits of a number, each followed by two bits that are 0.
std::uint64_t spread(std::uint64_t number) {
  number = (number | number << 32) & 0x001f00000000ffff;
  number = (number | number << 16) & 0x001f0000ff0000ff;
  number = (number | number << 8) & 0x100f00f00f00f00f;
  number = (number | number << 4) & 0x10c30c30c30c30c3;
  return (number | number << 2) & 0x1249249249249249;
}

// And back.
std::uint64_t gathered(std::uint64_t number) {
  number &= 0x1249249249249249;
  number = (number | number >> 2) & 0x10c30c30c30c30c3;
  number = (number | number >> 4) & 0x100f00f00f00f00f;
  number = (number | number >> 8) & 0x001f0000ff0000ff;
  number = (number | number >> 16) & 0x001f00000000ffff;
  return (number | number >> 32) & 0x1fffff;
}

std::uint64_t code_of(const Places& places) {
  return spread(places[0]) << 2 | spread(places[1]) << 1 | spread(places[2]);
}

Places places_of(std::uint64_t code) { return {gathered(code >> 2), gathered(code >> 1), gathered(code)}; }

}  // namespace

PatchCells::PatchCells(const PatchMesh& mesh, double length) : centroids_(mesh.centroid), places_(mesh.size()) {
  assert(length > 0);
  if (places_.empty()) return;
  Box box;
  for (const Point& centroid : mesh.centroid) box.extend(centroid);
  const int halvings = bits - 2 - std::ilogb(std::max(1.0, box.sizes().maxCoeff() / length));
  // A little wider: patches as near as `length` lie in one cell or in neighboring ones although their places are
  // rounded.
  edge_ = std::ldexp((1 + 0x1p-30) * length, -halvings);
  parallel_for((mesh.size() + patches_of_task - 1) / patches_of_task, [&](std::size_t task) {
    const std::size_t end = std::min<std::size_t>(mesh.size(), (task + 1) * patches_of_task);
    for (std::size_t i = task * patches_of_task; i < end; ++i) {
      const Vector edges = (mesh.centroid[i] - box.min()) / edge_;
      const auto along = [&](int axis) { return static_cast<std::uint64_t>(edges[axis]); };
      places_[i] = {code_of({along(0), along(1), along(2)}), static_cast<PatchIndex>(i)};
    }
  });
  std::sort(places_.begin(), places_.end());
}

int PatchCells::level_of(double length) const {
  // length = share 2^exponent edges, with a share of 1/2 up to, but not, 1.
  int exponent = 0;
  const double share = std::frexp(length / edge_, &exponent);
  return std::clamp(share > 0.5 ? exponent : exponent - 1, 0, bits);
}

void PatchCells::add_patches_in(const Cell& cell, NearPatches& near) const {
  const int shift = 3 * cell.level;
  auto place = std::lower_bound(places_.begin(), places_.end(), Place{cell.code << shift, 0});
  for (; place != places_.end() && place->code >> shift == cell.code; ++place) {
    near.patches.push_back(place->patch);
    for (int axis = 0; axis < 3; ++axis)
      near.centroids[static_cast<std::size_t>(axis)].push_back(centroids_[place->patch][axis]);
  }
}

NearPatches PatchCells::around(const Cell& home) const {
  NearPatches near;
  const auto [x, y, z] = places_of(home.code);
  const std::uint64_t end = std::uint64_t{1} << (bits - home.level);  // along each axis
  for (std::uint64_t k = 0; k < 27; ++k) {
    // Below the first cell the number is past the last one.
    const Places places{x + k / 9 - 1, y + k / 3 % 3 - 1, z + k % 3 - 1};
    if (std::all_of(places.begin(), places.end(), [end](std::uint64_t place) { return place < end; }))
      add_patches_in({home.level, code_of(places)}, near);
  }
  return near;
}

namespace {

// Neighbors lie within this share of the mean distance of the surroundings.
constexpr double reach = 0.2;

// The approximate maximum number.
constexpr double most_neighbours = 32;

// Their normals' cosine is above this one, that of 25 degrees.
constexpr double least_cosine = 0.9;

// Ridge regularization of the slopes, as a share of the weights: the result becomes a mean if all neighbors lie on one
// side.
constexpr double ridge = 0.05;

// The number of candidates whose distances are computed together.
constexpr std::size_t measured_at_once = 64;

struct Neighbour {
  PatchIndex patch = 0;
  double weight = 0;
  double u = 0, v = 0;  // place in the plane, in radii
};

// The search radius for neighbors of patches with nothing near them.
double widest_radius(double area) { return std::sqrt(most_neighbours / std::numbers::pi * area); }

struct Smoother {
  const PatchMesh& mesh;
  std::span<const float> distance;

  double radius(PatchIndex i) const {
    return std::min(reach * static_cast<double>(distance[i]), widest_radius(mesh.area[i]));
  }
  std::vector<Neighbour> neighbours(PatchIndex i, const NearPatches& candidates) const;
};

// From one point to another, as plain numbers. A processor has to wait where it loads a whole vector at once just after
// its parts were stored one by one.
struct Way {
  double x, y, z;
  double along(const Vector& direction) const { return x * direction.x() + y * direction.y() + z * direction.z(); }
  double squared_length() const { return x * x + y * y + z * z; }
};

// A patch that looks around, and where it does.
struct LookingPatch {
  const Smoother& smoother;
  PatchIndex patch;
  double radius = smoother.radius(patch);
  double share = 1 / radius;
  Point centroid = smoother.mesh.centroid[patch];
  Vector normal = smoother.mesh.normal[patch];
  Vector along = normal.unitOrthogonal();
  Vector across = normal.cross(along);

  // Is a patch within the radius, at `to` from here, a neighbor? In about one plane, and looking the same way.
  bool is_neighbour(PatchIndex j, const Way& to, double cosine) const {
    const double reach_of_other = reach * static_cast<double>(smoother.distance[j]);
    return cosine >= least_cosine && to.squared_length() <= reach_of_other * reach_of_other &&
           std::abs(to.along(normal)) <= 0.2 * radius;
  }
  Neighbour neighbour(PatchIndex j, const Way& to, double cosine) const {
    const double near = 1 - 0.75 * share * share * to.squared_length();
    const double alike = 1 / (1 - least_cosine) * (cosine - least_cosine);
    return {j, smoother.mesh.area[j] * near * alike, share * to.along(along), share * to.along(across)};
  }
};

// Some places among candidates, as many as are measured together.
struct Within {
  std::array<std::uint32_t, measured_at_once> places;
  std::size_t count = 0;
};

// Which candidates from `first` on lie within a radius. Where they do follows no pattern, so that nothing branches on
// it.
Within within_radius(const NearPatches& candidates, std::size_t first, const Point& centre, double radius) {
  const std::size_t end = std::min(candidates.patches.size(), first + measured_at_once);
  const auto& [x, y, z] = candidates.centroids;
  Within within;
  for (std::size_t k = first; k < end; ++k) {
    const double to_x = x[k] - centre.x();
    const double to_y = y[k] - centre.y();
    const double to_z = z[k] - centre.z();
    within.places[within.count] = static_cast<std::uint32_t>(k);
    within.count += to_x * to_x + to_y * to_y + to_z * to_z <= radius * radius ? 1 : 0;
  }
  return within;
}

// With itself.
std::vector<Neighbour> Smoother::neighbours(PatchIndex i, const NearPatches& candidates) const {
  const LookingPatch from{*this, i};
  const auto& [x, y, z] = candidates.centroids;
  std::vector<Neighbour> found;
  found.reserve(2 * static_cast<std::size_t>(most_neighbours));
  for (std::size_t first = 0; first < candidates.patches.size(); first += measured_at_once) {
    const Within within = within_radius(candidates, first, from.centroid, from.radius);
    for (const std::uint32_t k : std::span(within.places).first(within.count)) {
      const PatchIndex j = candidates.patches[k];
      const Way to{x[k] - from.centroid.x(), y[k] - from.centroid.y(), z[k] - from.centroid.z()};
      const Vector& normal = mesh.normal[j];
      const double cosine = Way{normal.x(), normal.y(), normal.z()}.along(from.normal);
      if (from.is_neighbour(j, to, cosine)) found.push_back(from.neighbour(j, to, cosine));
    }
  }
  return found;
}

// The weights of the neighbors' values in the regression's value at the centroid; they sum up to 1.
std::vector<double> coefficients(const std::vector<Neighbour>& neighbours) {
  double sum = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  for (const Neighbour& n : neighbours) {
    const double wu = n.weight * n.u, wv = n.weight * n.v;
    sum += n.weight;
    u += wu;
    v += wv;
    uu += wu * n.u;
    uv += wu * n.v;
    vv += wv * n.v;
  }
  Eigen::Matrix3d moments;
  moments << sum, u, v, u, uu + ridge * sum, uv, v, uv, vv + ridge * sum;
  const Vector dual = moments.inverse().col(0);
  const double at_centre = dual.x(), along = dual.y(), across = dual.z();
  std::vector<double> of_each;
  of_each.reserve(neighbours.size());
  double all = 0;
  for (const Neighbour& n : neighbours)
    all += of_each.emplace_back(n.weight * (at_centre + along * n.u + across * n.v));
  for (double& c : of_each) c /= all;
  return of_each;
}

// The same places of fields of as many patches and bands.
struct Smoothing {
  const std::array<Field, 2>& halves;
  SmoothedHalves& into;
};

// For neighbors with their coefficients, computes the means of `width` bands from `place` on in both halves. The
// variance is the weighted sum of the squared distances of either half from their mean.
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

// Whether a patch, its bands at [first, last), sees other light than its neighbors, according to both halves. A face
// slightly behind another may look into a separate space. The variance is that of `fields` times a factor.
bool is_apart(const Smoothing& fields, Eigen::Index first, Eigen::Index last, double factor) {
  for (Eigen::Index place = first; place < last; ++place) {
    const auto off = [&](std::size_t half) {
      return fields.into.halves[half].data()[place] - fields.halves[half].data()[place];
    };
    const double variance =
        std::max(factor * fields.into.variance.data()[place], squared_difference(fields.halves, place));
    // Sampling errors alone, 2 v in each half, exceed this about once in 500 times.
    if (off(0) * off(1) > 9 * variance) return true;
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

// Places along the curve of cells by the level of the patches there: that of cells as wide as they may look.
std::map<int, std::vector<std::size_t>> places_by_level(const Smoother& smoother, const PatchCells& cells) {
  std::map<int, std::vector<std::size_t>> places;
  for (std::size_t place = 0; place < cells.size(); ++place) {
    const PatchIndex i = cells.patch(place);
    if (smoother.radius(i) > 0) places[cells.level_of(widest_radius(smoother.mesh.area[i]))].push_back(place);
  }
  return places;
}

// Patches of one level; those of one cell follow each other, and share candidates.
void smooth_places(const Smoother& smoother, const PatchCells& cells, std::span<const std::size_t> places, int level,
                   const Smoothing& fields) {
  std::optional<Cell> cell;
  NearPatches candidates;
  for (const std::size_t place : places) {
    if (cells.cell(place, level) != cell) {
      cell = cells.cell(place, level);
      candidates = cells.around(*cell);
    }
    const PatchIndex i = cells.patch(place);
    const std::vector<Neighbour> neighbours = smoother.neighbours(i, candidates);
    if (neighbours.size() > 1) smooth_patch(i, neighbours, fields);
  }
}

}  // namespace

SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves) {
  SmoothedHalves into{halves, (0.5 * (halves[0] - halves[1])).square()};
  const Smoother smoother{mesh, distance};
  const PatchCells cells(mesh,
                         widest_radius(mesh.area.empty() ? 1 : *std::max_element(mesh.area.begin(), mesh.area.end())));
  for (const auto& [level, places] : places_by_level(smoother, cells)) {
    const std::span<const std::size_t> of_level(places);
    parallel_for((places.size() + patches_of_task - 1) / patches_of_task, [&, level = level](std::size_t task) {
      const std::size_t first = task * patches_of_task;
      const std::size_t count = std::min(patches_of_task, of_level.size() - first);
      smooth_places(smoother, cells, of_level.subspan(first, count), level, {halves, into});
    });
  }
  return into;
}

}  // namespace patchlight
