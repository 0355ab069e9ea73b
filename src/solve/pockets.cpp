#include "solve/pockets.h"

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/vectors.h"
#include "solve/bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

namespace patchlight {
namespace {

// A pocket of at most so many patches is solved by elimination.
constexpr Eigen::Index few_patches = 512;

// The incomplete factors of a pocket, as a preconditioner that Eigen's solvers do not compute.
struct KnownFactors {
  const Eigen::IncompleteLUT<double>* factors = nullptr;

  KnownFactors& compute(const SparseRows&) { return *this; }
  Eigen::ComputationInfo info() const { return Eigen::Success; }
  template <class Right>
  auto solve(const Right& right) const {
    return factors->solve(right);
  }
};

// I - F R
SparseRows system_matrix(const SparseRows& form_factors, const Eigen::VectorXd& reflectance) {
  SparseRows one(form_factors.rows(), form_factors.cols());
  one.setIdentity();
  return one - form_factors * reflectance.asDiagonal();
}

// With a larger fraction of all patches, the room itself is white.
constexpr double largest_part = 1.0 / 8;

// Those of some patches that keep half of their light.
std::vector<PatchIndex> keeping_enough(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& share) {
  std::vector<PatchIndex> those;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (share[static_cast<Eigen::Index>(k)] > 0.5) those.push_back(patches[k]);
  return those;
}

// F among some patches.
SparseRows rows_among(const RayTransport& transport, const std::vector<PatchIndex>& patches) {
  std::vector<int> number(transport.size(), -1);
  for (std::size_t k = 0; k < patches.size(); ++k) number[patches[k]] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const PatchIndex i = patches[k];
    const auto add = [&](PatchIndex j, double form_factor) {
      if (number[j] >= 0) entries.emplace_back(static_cast<int>(k), number[j], 0.5 * form_factor);
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
  SparseRows among(size, size);
  among.setFromTriplets(entries.begin(), entries.end());
  return among;
}

// The patches of which half of the light stays among all for four bounces, and among them for eight more. More bounces
// would find fewer patches, and solvers would take more iterations. More than an eighth of all where it is the room.
std::vector<PatchIndex> keeping_light(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  std::vector<PatchIndex> patches(transport.size());
  std::iota(patches.begin(), patches.end(), PatchIndex{0});
  const auto most = static_cast<std::size_t>(largest_part * transport.size());
  Eigen::VectorXd left = Eigen::VectorXd::Ones(reflectance.size());
  for (int bounce = 0; bounce < 4; ++bounce) left = reflectance.cwiseProduct(transport.apply(left).col(0).matrix());
  patches = keeping_enough(patches, left);
  if (patches.size() > most) return patches;
  const SparseRows among = rows_among(transport, patches);
  const Eigen::VectorXd reflected = reflectance(patches);
  left = Eigen::VectorXd::Ones(among.rows());
  for (int bounce = 0; bounce < 8; ++bounce) left = reflected.cwiseProduct(among * left);
  return keeping_enough(patches, left);
}

// Which of some patches lose light: they absorb, some leaves, or it gets to others that do. As in trapped_light().
Eigen::ArrayXd losing_light(const SparseRows& among, const Eigen::VectorXd& reflectance) {
  const Eigen::VectorXd row_sum = among * Eigen::VectorXd::Ones(among.rows());
  Eigen::VectorXd loses =
      (reflectance.array() < largest_contraction || row_sum.array() < 1 - least_escape).cast<double>().matrix();
  for (double before = -1; loses.sum() > before;) {
    before = loses.sum();
    loses = (loses.array() > 0 || (among * loses).array() > 0).cast<double>().matrix();
  }
  return loses.array();
}

// Groups of patches that see each other, directly or by way of others of them.
struct Groups {
  std::vector<std::vector<std::size_t>> members;  // of each, by their numbers, in rising order
  std::vector<std::size_t> group;                 // per patch; as many as patches: of none
  std::vector<int> place;                         // per patch: among the members of its group
};

// Without patches that lose no light: these are of no group.
Groups groups_of(const SparseRows& among, const Eigen::ArrayXd& loses) {
  const auto count = static_cast<std::size_t>(loses.size());
  DisjointSets sets(count);
  for (Eigen::Index row = 0; row < among.rows(); ++row) {
    if (loses[row] == 0) continue;
    for (SparseRows::InnerIterator entry(among, row); entry; ++entry)
      if (loses[entry.col()] != 0) sets.join(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(entry.col()));
  }
  Groups groups{{}, std::vector<std::size_t>(count, count), std::vector<int>(count, 0)};
  for (std::uint32_t k = 0; k < count; ++k) {
    if (loses[k] == 0) continue;
    const std::uint32_t lowest = sets.root(k);
    if (lowest == k) {
      groups.group[k] = groups.members.size();
      groups.members.emplace_back();
    }
    groups.group[k] = groups.group[lowest];
    groups.place[k] = static_cast<int>(groups.members[groups.group[k]].size());
    groups.members[groups.group[k]].push_back(k);
  }
  return groups;
}

// F among the patches of one group.
SparseRows rows_of(const Groups& groups, std::size_t group, const SparseRows& among) {
  const std::vector<std::size_t>& members = groups.members[group];
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::size_t k : members) {
    for (SparseRows::InnerIterator entry(among, static_cast<Eigen::Index>(k)); entry; ++entry) {
      const auto seen = static_cast<std::size_t>(entry.col());
      if (groups.group[seen] == group) entries.emplace_back(groups.place[k], groups.place[seen], entry.value());
    }
  }
  const auto size = static_cast<Eigen::Index>(members.size());
  SparseRows rows(size, size);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// Incomplete factors of I - F rho. The cost equals that of some applications per entry of a row.
std::shared_ptr<const Eigen::IncompleteLUT<double>> incomplete_factors(const SparseRows& form_factors,
                                                                       const Eigen::VectorXd& reflectance) {
  auto factors = std::make_shared<Eigen::IncompleteLUT<double>>();
  factors->setDroptol(0.01);  // relative to the row
  factors->setFillfactor(2);  // relative to the matrix
  factors->compute(system_matrix(form_factors, reflectance));
  return factors;
}

// The pocket of these patches, with F among them; empty if their bounces are not known within a factor of two. Then the
// error of its solution has no bound. If (I - F rho) bounces >= 1/2, light is reflected at most twice as often as
// `bounces` gives.
std::optional<Pocket> pocket_of(std::vector<PatchIndex> patches, const SparseRows& form_factors,
                                const Eigen::VectorXd& reflectance) {
  Pocket pocket;
  pocket.patches = std::move(patches);
  pocket.form_factors = form_factors;
  const Eigen::VectorXd reflected = reflectance(pocket.patches);
  const PocketSystem system = system_within(pocket.form_factors, reflected.array());
  if (!system.is_eliminated()) pocket.nearly_solved = incomplete_factors(pocket.form_factors, reflected);
  const Field once = Field::Ones(reflected.size(), 1);
  const Field bounces = solution_within(pocket, system, once, 1e-6);
  // Elimination leaves rounding alone, which the bounces multiply: of 1e8 of them 1e-8 of the light.
  const double most = system.is_eliminated() ? 1e8 : 1e5;
  const bool hold = (bounces > 0).all() && (residual_within(pocket, system, once, bounces) < 0.5).all();
  if (!hold || bounces.maxCoeff() > most) return std::nullopt;
  pocket.bounces = bounces.col(0).matrix();
  return pocket;
}

// F B: the irradiance of the patches by each other in each band.
Field arriving_within(const Pocket& pocket, const Field& radiosity) {
  using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Dense arriving = pocket.form_factors * radiosity.matrix();
  return arriving.array();
}

// F_PP B_P
Field sent_within(const Pocket& pocket, const FieldView& radiosity) {
  return arriving_within(pocket, chosen_rows(radiosity, pocket.patches));
}

void raise_to(std::atomic<double>& highest, double value) {
  double before = highest;
  while (before < value && !highest.compare_exchange_weak(before, value)) {
  }
}

}  // namespace

PocketSystem system_within(const SparseRows& form_factors, const FieldView& reflectance) {
  PocketSystem system{.reflectance = reflectance, .matrices = {}, .factors = {}};
  for (Eigen::Index band = 0; band < reflectance.cols(); ++band) {
    SparseRows matrix = system_matrix(form_factors, reflectance.col(band).matrix());
    if (matrix.rows() <= few_patches)
      system.factors.emplace_back(Eigen::MatrixXd(matrix));
    else
      system.matrices.push_back(std::move(matrix));
  }
  return system;
}

Field residual_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, const FieldView& x) {
  return right - x + arriving_within(pocket, system.reflectance * x);
}

Field solution_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, double tolerance) {
  assert(right.cols() == system.reflectance.cols());
  Field found(right.rows(), right.cols());
  if (system.is_eliminated()) {
    for (Eigen::Index band = 0; band < right.cols(); ++band)
      found.col(band) = system.factors[static_cast<std::size_t>(band)].solve(right.col(band).matrix()).array();
    return found;
  }
  for (Eigen::Index band = 0; band < right.cols(); ++band) {
    Eigen::BiCGSTAB<SparseRows, KnownFactors> solver;
    solver.preconditioner().factors = pocket.nearly_solved.get();
    solver.setTolerance(tolerance);
    solver.setMaxIterations(200);
    solver.compute(system.matrices[static_cast<std::size_t>(band)]);
    found.col(band) = solver.solve(right.col(band).matrix()).array();
  }
  return found;
}

std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  if (!(reflectance.array() > 0.917).any()) return nullptr;  // its eighth power is one half
  const std::vector<PatchIndex> patches = keeping_light(transport, reflectance);
  if (patches.empty() || static_cast<double>(patches.size()) > largest_part * transport.size()) return nullptr;

  const auto pockets = std::make_shared<Pockets>();
  const SparseRows among = rows_among(transport, patches);
  const Eigen::ArrayXd loses = losing_light(among, reflectance(patches));
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (loses[static_cast<Eigen::Index>(k)] == 0) pockets->closed.push_back(patches[k]);
  const Groups groups = groups_of(among, loses);
  for (std::size_t group = 0; group < groups.members.size(); ++group) {
    std::vector<PatchIndex> those;
    for (const std::size_t k : groups.members[group]) those.push_back(patches[k]);
    std::optional<Pocket> pocket = pocket_of(std::move(those), rows_of(groups, group, among), reflectance);
    if (pocket) pockets->each.push_back(std::move(*pocket));
  }
  return pockets->each.empty() && pockets->closed.empty() ? nullptr : pockets;
}

PocketTransport::PocketTransport(const TransportOperator& transport, const Pockets& pockets,
                                 const Scattering& scattering, bool closed_are_dark, double accuracy)
    : transport_(transport), pockets_(pockets), closed_are_dark_(closed_are_dark), accuracy_(accuracy) {
  assert(scattering.is_diagonal());
  for (const Pocket& pocket : pockets.each) {
    const Field reflectance = chosen_rows(scattering.reflectance, pocket.patches);
    of_bands_.push_back(system_within(pocket.form_factors, reflectance));
    if (reflectance.cols() > 1)
      of_highest_.push_back(system_within(pocket.form_factors, reflectance.rowwise().maxCoeff()));
  }
}

// (I - F_PP R)^-1 H. No entry of the inverse is negative: so |error| <= max |r| y of any y with (I - F_PP R) y >= 1,
// and twice the bounces are such a one.
Field PocketTransport::followed(const Pocket& pocket, const PocketSystem& system, const FieldView& irradiance) const {
  const double highest_bound = 2 * pocket.bounces.maxCoeff();  // of the error, where max |r| is 1
  const auto relative_errors = [&](const Field& found) {
    const Field residual = residual_within(pocket, system, irradiance, found);
    return quotient(highest_bound * highest(residual.abs()), highest(found.abs()));
  };
  const double tolerance = accuracy_ / highest_bound;
  Field found = solution_within(pocket, system, irradiance, tolerance);
  Eigen::ArrayXd error = relative_errors(found);
  // Bands that are not near enough are looked for once more, each by itself.
  if (!system.is_eliminated() && !(error <= accuracy_).all()) {
    const Field again = solution_within(pocket, system, irradiance, 0.1 * tolerance);
    for (Eigen::Index band = 0; band < found.cols(); ++band)
      if (!(error[band] <= accuracy_)) found.col(band) = again.col(band);
    error = relative_errors(found);
  }
  for (Eigen::Index band = 0; band < found.cols(); ++band) {
    // A non-finite irradiance has no solution. The iteration may break down for a finite one, too.
    const bool has_solution = irradiance.col(band).allFinite();
    if (!has_solution) found.col(band).setConstant(irradiance.col(band).sum());
    if (has_solution && !found.col(band).allFinite()) {
      found.col(band) = irradiance.col(band);
      error[band] = std::numeric_limits<double>::infinity();
    }
    if (error[band] > 0) raise_to(farthest_off_, error[band]);
  }
  return found;
}

// An irradiance with (I - F_PP R)^-1 H in its pockets, where H arrives at each of these.
Field PocketTransport::followed_in_each(const std::function<Field(const Pocket&)>& arriving, Field irradiance) const {
  const bool is_of_highest = irradiance.cols() == 1 && !of_highest_.empty();
  const std::vector<PocketSystem>& systems = is_of_highest ? of_highest_ : of_bands_;
  parallel_for(pockets_.each.size(), [&](std::size_t index) {
    const Pocket& pocket = pockets_.each[index];
    irradiance(pocket.patches, Eigen::all) = followed(pocket, systems[index], arriving(pocket));
  });
  return irradiance;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  const Field irradiance = transport_.apply(radiosity);
  const auto from_others = [&](const Pocket& pocket) {
    return Field(chosen_rows(irradiance, pocket.patches) - sent_within(pocket, radiosity));
  };
  Field found = followed_in_each(from_others, irradiance);
  if (closed_are_dark_)
    for (const PatchIndex patch : pockets_.closed) found.row(patch) = 0;
  return found;
}

Field PocketTransport::irradiance_within(const FieldView& radiosity) const {
  const auto from_own = [&](const Pocket& pocket) { return sent_within(pocket, radiosity); };
  return followed_in_each(from_own, Field::Zero(radiosity.rows(), radiosity.cols()));
}

}  // namespace patchlight
