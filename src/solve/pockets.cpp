#include "solve/pockets.h"

#include "solve/bounds.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

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
// However often light is reflected in a pocket that is solved by elimination, only rounding is left, which the bounces
// multiply. Of so many 1e-8 of the light. Iterations take the longer the more there are.
constexpr double most_bounces = 1e8;
constexpr double most_bounces_by_iterations = 1e5;

// Those of some patches that keep the share.
std::vector<PatchIndex> keeping_enough(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& share) {
  std::vector<PatchIndex> those;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (share[static_cast<Eigen::Index>(k)] > kept_share) those.push_back(patches[k]);
  return those;
}

// F among some patches.
SparseRows rows_among(const RayTransport& transport, const std::vector<PatchIndex>& patches) {
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
  SparseRows among(size, size);
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
  const SparseRows among = rows_among(transport, patches);
  const Eigen::VectorXd reflected = values_at(patches, reflectance);
  left = Eigen::VectorXd::Ones(among.rows());
  for (int bounce = 0; bounce < more_bounces; ++bounce) left = reflected.cwiseProduct(among * left);
  return keeping_enough(patches, left);
}

// Which of some patches lose light: they absorb, some leaves, or it gets to others that do. As in trapped_light().
Eigen::ArrayXd losing_light(const SparseRows& among, const Eigen::VectorXd& reflectance) {
  const Eigen::VectorXd row_sum = among * Eigen::VectorXd::Ones(among.rows());
  Eigen::VectorXd loses =
      (reflectance.array() < largest_contraction || row_sum.array() < 1 - least_loss).cast<double>().matrix();
  for (double before = -1; loses.sum() > before;) {
    before = loses.sum();
    loses = (loses.array() > 0 || (among * loses).array() > 0).cast<double>().matrix();
  }
  return loses.array();
}

// Groups of patches that see each other, directly or by way of others of them.
struct Groups {
  std::vector<std::vector<std::size_t>> members;  // of each, by their numbers, in rising order
  std::vector<std::size_t> group;                 // per patch
  std::vector<int> place;                         // per patch: among the members of its group
};

// Union and find by the lowest number of each group; those that lose no light are groups of their own.
std::vector<std::size_t> lowest_of_groups(const SparseRows& among, const Eigen::ArrayXd& loses) {
  std::vector<std::size_t> lower(static_cast<std::size_t>(loses.size()));
  std::iota(lower.begin(), lower.end(), std::size_t{0});
  const auto lowest = [&lower](std::size_t k) {
    while (lower[k] != k) k = lower[k] = lower[lower[k]];
    return k;
  };
  for (Eigen::Index row = 0; row < among.rows(); ++row) {
    if (loses[row] == 0) continue;
    for (SparseRows::InnerIterator entry(among, row); entry; ++entry) {
      if (loses[entry.col()] == 0) continue;
      const auto [low, high] =
          std::minmax({lowest(static_cast<std::size_t>(row)), lowest(static_cast<std::size_t>(entry.col()))});
      lower[high] = low;
    }
  }
  for (std::size_t k = 0; k < lower.size(); ++k) lower[k] = lowest(k);
  return lower;
}

// Without patches that lose no light: these are of no group.
Groups groups_of(const SparseRows& among, const Eigen::ArrayXd& loses) {
  const std::vector<std::size_t> lowest = lowest_of_groups(among, loses);
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  Groups groups{{}, std::vector<std::size_t>(lowest.size(), none), std::vector<int>(lowest.size(), 0)};
  for (std::size_t k = 0; k < lowest.size(); ++k) {
    if (loses[static_cast<Eigen::Index>(k)] == 0) continue;
    if (lowest[k] == k) {
      groups.group[k] = groups.members.size();
      groups.members.emplace_back();
    }
    groups.group[k] = groups.group[lowest[k]];
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

// Of patches and F among them, unless their bounces are not known to a factor of two: then nothing tells how far off
// what is followed is. From (I - F rho) bounces >= 1/2 light is reflected at most twice as often as they say.
std::optional<Pocket> pocket_of(std::vector<PatchIndex> patches, const SparseRows& form_factors,
                                const Eigen::VectorXd& reflectance) {
  Pocket pocket;
  pocket.patches = std::move(patches);
  pocket.form_factors = form_factors;
  const Eigen::VectorXd reflected = values_at(pocket.patches, reflectance);
  const PocketSystem system = system_within(pocket.form_factors, reflected.array());
  if (!system.is_eliminated()) pocket.nearly_solved = incomplete_factors(pocket.form_factors, reflected);
  constexpr double loosely = 1e-6;
  const Field once = Field::Ones(reflected.size(), 1);
  const Field bounces = solution_within(pocket, system, once, loosely);
  const double most = system.is_eliminated() ? most_bounces : most_bounces_by_iterations;
  const bool hold = (bounces > 0).all() && (residual_within(pocket, system, once, bounces) < 0.5).all();
  if (!hold || bounces.maxCoeff() > most) return std::nullopt;
  pocket.bounces = bounces.col(0).matrix();
  return pocket;
}

}  // namespace

std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  if (!(reflectance.array() > least_reflectance).any()) return nullptr;
  const std::vector<PatchIndex> patches = keeping_light(transport, reflectance);
  if (patches.empty() || static_cast<double>(patches.size()) > largest_part * transport.size()) return nullptr;

  const auto pockets = std::make_shared<Pockets>();
  const SparseRows among = rows_among(transport, patches);
  const Eigen::ArrayXd loses = losing_light(among, values_at(patches, reflectance));
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

}  // namespace patchlight
