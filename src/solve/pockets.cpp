#include "solve/pockets.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Light that is still there after as many bounces among all patches, and then among those that have kept it so far.
// With 16 more of the latter fewer patches are followed apart, and the kitchen of docs/models.md takes 30 iterations,
// not 19.
constexpr int first_bounces = 4;
constexpr int more_bounces = 8;
constexpr double kept_share = 0.5;
// Half of it is left after 8 bounces of which each leaves .917.
constexpr double least_reflectance = 0.917;
constexpr double largest_part = 1.0 / 8;
// What a row may lack to 1 by rounding.
constexpr double least_loss = 1e-6;
// Of the incomplete factors: what is dropped, relative to its row, and their size, relative to the matrix.
constexpr double dropped_share = 0.01;
constexpr int size_of_factors = 2;
// A pocket of fewer patches is solved by elimination: however often light is reflected there, only rounding is left.
constexpr Eigen::Index few_patches = 512;

// Those of some patches that keep the share.
std::vector<PatchIndex> keeping_enough(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& share) {
  std::vector<PatchIndex> those;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (share[static_cast<Eigen::Index>(k)] > kept_share) those.push_back(patches[k]);
  return those;
}

// F among some patches.
Rows rows_among(const RayTransport& transport, const std::vector<PatchIndex>& patches) {
  constexpr int none = -1;
  std::vector<int> number(transport.size(), none);
  for (std::size_t k = 0; k < patches.size(); ++k) number[patches[k]] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const PatchIndex i = patches[k];
    const auto add = [&](PatchIndex j, double form_factor) {
      if (number[j] != none) entries.emplace_back(static_cast<int>(k), number[j], 0.5 * form_factor);
    };
    for (const std::size_t half : {0, 1}) {
      const RayRows& rows = transport.rows(half);
      for (std::uint64_t hit = rows.first_hit[i]; hit < rows.first_hit[i + 1]; ++hit)
        add(rows.hits[hit], rows.hit_weight[i]);
      for (std::uint64_t e = rows.first_entry[i]; e < rows.first_entry[i + 1]; ++e)
        add(rows.entries[e].patch, static_cast<double>(rows.entries[e].form_factor));
    }
  }
  const auto size = static_cast<Eigen::Index>(patches.size());
  Rows among(size, size);
  among.setFromTriplets(entries.begin(), entries.end());
  return among;
}

Eigen::VectorXd values_at(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& values) {
  Eigen::VectorXd those(static_cast<Eigen::Index>(patches.size()));
  for (std::size_t k = 0; k < patches.size(); ++k) those[static_cast<Eigen::Index>(k)] = values[patches[k]];
  return those;
}

// The patches of which half of the light stays among them; more than an eighth of all where it is the room.
std::vector<PatchIndex> keeping_light(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  std::vector<PatchIndex> patches(transport.size());
  std::iota(patches.begin(), patches.end(), PatchIndex{0});
  const auto most = static_cast<std::size_t>(largest_part * transport.size());
  Eigen::VectorXd left = Eigen::VectorXd::Ones(reflectance.size());
  for (int bounce = 0; bounce < first_bounces; ++bounce)
    left = reflectance.cwiseProduct(transport.apply(left).col(0).matrix());
  patches = keeping_enough(patches, left);
  if (patches.size() > most) return patches;
  const Rows among = rows_among(transport, patches);
  const Eigen::VectorXd reflected = values_at(patches, reflectance);
  left = Eigen::VectorXd::Ones(among.rows());
  for (int bounce = 0; bounce < more_bounces; ++bounce) left = reflected.cwiseProduct(among * left);
  return keeping_enough(patches, left);
}

// Which of some patches lose light: they absorb, some leaves, or it gets to others that do. As in trapped_light().
Eigen::ArrayXd losing_light(const Rows& among, const Eigen::VectorXd& reflectance) {
  const Eigen::VectorXd row_sum = among * Eigen::VectorXd::Ones(among.rows());
  Eigen::VectorXd loses = (reflectance.array() < 1 || row_sum.array() < 1 - least_loss).cast<double>().matrix();
  for (double before = -1; loses.sum() > before;) {
    before = loses.sum();
    loses = (loses.array() > 0 || (among * loses).array() > 0).cast<double>().matrix();
  }
  return loses.array();
}

// The numbers of those of some patches that see each other, directly or by way of others, for each such group; without
// those that lose no light.
std::vector<std::vector<std::size_t>> groups_of(const Rows& among, const Eigen::ArrayXd& loses) {
  std::vector<std::size_t> first(static_cast<std::size_t>(loses.size()));
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto first_of = [&first](std::size_t k) {
    while (first[k] != k) k = first[k] = first[first[k]];
    return k;
  };
  const auto loses_light = [&loses](std::size_t k) { return loses[static_cast<Eigen::Index>(k)] > 0; };
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (!loses_light(k)) continue;
    for (Rows::InnerIterator entry(among, static_cast<Eigen::Index>(k)); entry; ++entry) {
      const auto seen = static_cast<std::size_t>(entry.col());
      if (!loses_light(seen)) continue;
      const auto [low, high] = std::minmax({first_of(k), first_of(seen)});
      first[high] = low;
    }
  }
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> number(first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (!loses_light(k)) continue;
    const std::size_t at = first_of(k);
    if (at == k) {
      number[k] = groups.size();
      groups.emplace_back();
    }
    groups[number[at]].push_back(k);
  }
  return groups;
}

// The rows and columns of these numbers.
Rows part_of(const Rows& among, const std::vector<std::size_t>& numbers) {
  constexpr int none = -1;
  std::vector<int> number(static_cast<std::size_t>(among.rows()), none);
  for (std::size_t k = 0; k < numbers.size(); ++k) number[numbers[k]] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    for (Rows::InnerIterator entry(among, static_cast<Eigen::Index>(numbers[k])); entry; ++entry)
      if (const int column = number[static_cast<std::size_t>(entry.col())]; column != none)
        entries.emplace_back(static_cast<int>(k), column, entry.value());
  const auto size = static_cast<Eigen::Index>(numbers.size());
  Rows part(size, size);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

// Eigen's place for a preconditioner, filled with factors that the pockets hold.
class KnownFactors {
 public:
  KnownFactors() = default;
  template <typename Matrix>
  explicit KnownFactors(const Matrix& /*matrix*/) {}
  template <typename Matrix>
  KnownFactors& analyzePattern(const Matrix& /*matrix*/) {  // NOLINT(readability-identifier-naming): Eigen's
    return *this;
  }
  template <typename Matrix>
  KnownFactors& factorize(const Matrix& /*matrix*/) {
    return *this;
  }
  template <typename Matrix>
  KnownFactors& compute(const Matrix& /*matrix*/) {
    return *this;
  }
  void set(const Eigen::IncompleteLUT<double>& factors) { factors_ = &factors; }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return factors_->solve(right); }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  const Eigen::IncompleteLUT<double>* factors_ = nullptr;
};

// (I - F rho) bounces >= 1/2: light is reflected at most twice as often as the bounces say.
bool bounces_hold(const Pocket& pocket, const PocketSystem& system) {
  return (pocket.bounces.array() > 0).all() && ((system.matrix * pocket.bounces).array() > 0.5).all();
}

// Of patches and F among them.
Pocket pocket_of(std::vector<PatchIndex> patches, Rows form_factors, const Eigen::VectorXd& reflectance) {
  Pocket pocket;
  pocket.patches = std::move(patches);
  pocket.form_factors = std::move(form_factors);
  const PocketSystem system = system_within(pocket, values_at(pocket.patches, reflectance));
  if (system.matrix.rows() > few_patches) {
    pocket.nearly_solved = std::make_unique<Eigen::IncompleteLUT<double>>();
    pocket.nearly_solved->setDroptol(dropped_share);
    pocket.nearly_solved->setFillfactor(size_of_factors);
    pocket.nearly_solved->compute(system.matrix);
  }
  constexpr double loosely = 1e-6;
  pocket.bounces = solution_within(pocket, system, Eigen::VectorXd::Ones(system.matrix.rows()), loosely);
  // Where they are not known to a factor of two, nothing tells how far off what is followed is.
  if (!bounces_hold(pocket, system)) pocket.patches.clear();
  return pocket;
}

}  // namespace

std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  if (!(reflectance.array() > least_reflectance).any()) return nullptr;
  const std::vector<PatchIndex> patches = keeping_light(transport, reflectance);
  if (patches.empty() || static_cast<double>(patches.size()) > largest_part * transport.size()) return nullptr;

  const auto pockets = std::make_shared<Pockets>();
  const Rows among = rows_among(transport, patches);
  const Eigen::ArrayXd loses = losing_light(among, values_at(patches, reflectance));
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (!(loses[static_cast<Eigen::Index>(k)] > 0)) pockets->closed.push_back(patches[k]);
  for (const std::vector<std::size_t>& numbers : groups_of(among, loses)) {
    std::vector<PatchIndex> those;
    for (const std::size_t k : numbers) those.push_back(patches[k]);
    Pocket pocket = pocket_of(std::move(those), part_of(among, numbers), reflectance);
    if (!pocket.patches.empty()) pockets->each.push_back(std::move(pocket));
  }
  return pockets;
}

PocketSystem system_within(const Pocket& pocket, const Eigen::VectorXd& reflectance) {
  Rows one(pocket.form_factors.rows(), pocket.form_factors.cols());
  one.setIdentity();
  PocketSystem system{.matrix = one - pocket.form_factors * reflectance.asDiagonal(), .factors = {}};
  if (one.rows() <= few_patches) system.factors.compute(Eigen::MatrixXd(system.matrix));
  return system;
}

Eigen::VectorXd solution_within(const Pocket& pocket, const PocketSystem& system, const Eigen::VectorXd& right,
                                double tolerance) {
  if (system.factors.rows() > 0) return system.factors.solve(right);
  constexpr int most_iterations = 200;
  Eigen::BiCGSTAB<Rows, KnownFactors> solver;
  solver.preconditioner().set(*pocket.nearly_solved);
  solver.setTolerance(tolerance);
  solver.setMaxIterations(most_iterations);
  solver.compute(system.matrix);
  return solver.solve(right);
}

}  // namespace patchlight
