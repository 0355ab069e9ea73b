#include "solve/pockets.h"

#include "base/vectors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
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
// A pocket of at most so many patches is solved by elimination: however often light is reflected there, only rounding
// is left, which the bounces multiply. Of so many 1e-8 of the light. Iterations take the longer the more there are.
constexpr Eigen::Index few_patches = 512;
constexpr double most_bounces = 1e8;
constexpr double most_bounces_by_iterations = 1e5;

// Those of some patches that keep the share.
std::vector<PatchIndex> keeping_enough(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& share) {
  std::vector<PatchIndex> those;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (share[static_cast<Eigen::Index>(k)] > kept_share) those.push_back(patches[k]);
  return those;
}

// The rows of some patches, of what these meet among them: `place` is that of every patch there, or no_patch.
RayRows rows_among(const RayRows& rows, std::span<const PatchIndex> patches, const std::vector<PatchIndex>& place) {
  RayRows among{.first_hit = {0}, .hits = {}, .hit_weight = {}, .first_entry = {0}, .entries = {}};
  for (const PatchIndex i : patches) {
    for (std::uint64_t hit = rows.first_hit[i]; hit < rows.first_hit[i + 1]; ++hit)
      if (place[rows.hits[hit]] != no_patch) among.hits.push_back(place[rows.hits[hit]]);
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k) {
      const RayEntry& entry = rows.entries[k];
      if (place[entry.patch] != no_patch) among.entries.push_back({place[entry.patch], entry.form_factor});
    }
    among.first_hit.push_back(among.hits.size());
    among.hit_weight.push_back(rows.hit_weight[i]);
    among.first_entry.push_back(among.entries.size());
  }
  return among;
}

RayTransport rays_among(const RayTransport& rays, std::span<const PatchIndex> patches,
                        const std::vector<PatchIndex>& place) {
  return RayTransport({rows_among(rays.rows(0), patches, place), rows_among(rays.rows(1), patches, place)});
}

RayTransport rays_among(const RayTransport& rays, const std::vector<PatchIndex>& patches) {
  std::vector<PatchIndex> place(rays.size(), no_patch);
  for (std::size_t k = 0; k < patches.size(); ++k) place[patches[k]] = static_cast<PatchIndex>(k);
  return rays_among(rays, patches, place);
}

Eigen::VectorXd values_at(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& values) {
  Eigen::VectorXd those(static_cast<Eigen::Index>(patches.size()));
  for (std::size_t k = 0; k < patches.size(); ++k) those[static_cast<Eigen::Index>(k)] = values[patches[k]];
  return those;
}

// What is left after some bounces of light that is even at first.
Eigen::VectorXd left_after(int bounces, const RayTransport& rays, const Eigen::VectorXd& reflectance) {
  Eigen::VectorXd left = Eigen::VectorXd::Ones(reflectance.size());
  for (int bounce = 0; bounce < bounces; ++bounce)
    left = reflectance.cwiseProduct(rays.apply(left.array()).col(0).matrix());
  return left;
}

// The patches of which half of the light stays among them; more than an eighth of all where it is the room.
std::vector<PatchIndex> keeping_light(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  std::vector<PatchIndex> patches(transport.size());
  std::iota(patches.begin(), patches.end(), PatchIndex{0});
  patches = keeping_enough(patches, left_after(first_bounces, transport, reflectance));
  if (static_cast<double>(patches.size()) > largest_part * transport.size()) return patches;
  const RayTransport among = rays_among(transport, patches);
  return keeping_enough(patches, left_after(more_bounces, among, values_at(patches, reflectance)));
}

// Calls `visit` with each patch that one meets.
void for_met_from(const RayTransport& rays, PatchIndex patch, const auto& visit) {
  for (const std::size_t half : {0, 1}) {
    const RayRows& rows = rays.rows(half);
    for (std::uint64_t hit = rows.first_hit[patch]; hit < rows.first_hit[patch + 1]; ++hit) visit(rows.hits[hit]);
    for (std::uint64_t k = rows.first_entry[patch]; k < rows.first_entry[patch + 1]; ++k) visit(rows.entries[k].patch);
  }
}

// Which of some patches lose light: they absorb, some leaves, or it gets to others that do. As in trapped_light().
Eigen::ArrayXd losing_light(const RayTransport& among, const Eigen::VectorXd& reflectance) {
  Eigen::ArrayXd loses = (reflectance.array() < 1 || among.row_sums().array() < 1 - least_loss).cast<double>();
  for (double before = -1; loses.sum() > before;) {
    before = loses.sum();
    loses = (loses > 0 || among.apply(loses).col(0) > 0).cast<double>();
  }
  return loses;
}

// Groups of patches that see each other, directly or by way of others of them.
struct Groups {
  std::vector<std::vector<PatchIndex>> members;  // of each, in rising order
  std::vector<PatchIndex> place;                 // per patch: among the members of its group
};

// Union and find by the lowest patch of each group; those that lose no light are groups of their own.
std::vector<PatchIndex> lowest_of_groups(const RayTransport& among, const Eigen::ArrayXd& loses) {
  std::vector<PatchIndex> lower(among.size());
  std::iota(lower.begin(), lower.end(), PatchIndex{0});
  const auto lowest = [&lower](PatchIndex k) {
    while (lower[k] != k) k = lower[k] = lower[lower[k]];
    return k;
  };
  for (PatchIndex patch = 0; patch < among.size(); ++patch) {
    if (loses[patch] == 0) continue;
    for_met_from(among, patch, [&](PatchIndex met) {
      if (loses[met] == 0) return;
      const auto [low, high] = std::minmax({lowest(patch), lowest(met)});
      lower[high] = low;
    });
  }
  for (PatchIndex k = 0; k < among.size(); ++k) lower[k] = lowest(k);
  return lower;
}

// Without patches that lose no light: these are of no group.
Groups groups_of(const RayTransport& among, const Eigen::ArrayXd& loses) {
  const std::vector<PatchIndex> lowest = lowest_of_groups(among, loses);
  Groups groups{{}, std::vector<PatchIndex>(lowest.size(), no_patch)};
  std::vector<std::size_t> group(lowest.size());
  for (PatchIndex k = 0; k < among.size(); ++k) {
    if (loses[k] == 0) continue;
    if (lowest[k] == k) {
      group[k] = groups.members.size();
      groups.members.emplace_back();
    }
    std::vector<PatchIndex>& members = groups.members[group[lowest[k]]];
    groups.place[k] = static_cast<PatchIndex>(members.size());
    members.push_back(k);
  }
  return groups;
}

// Is light that starts at one patch followed to a thousandth? From all patches alike it is found at once where these
// keep it alike; from one it has to get to the others.
bool follows_light_of_one(const RayTransport& rays, const PocketSystem& system, double highest_bound) {
  constexpr double wanted = 1e-3;
  Field one = Field::Zero(rays.size(), 1);
  one(0, 0) = 1;
  const Field found = solution_within(rays, system, one, Eigen::ArrayXd::Constant(1, wanted / highest_bound));
  return residual_within(rays, system, one, found).abs().maxCoeff() * highest_bound <= wanted * found.maxCoeff();
}

// Of patches and F among them, unless their bounces are not known to a factor of two: then nothing tells how far off
// what is followed is. (I - F rho) bounces >= 1/2 says that light is reflected at most twice as often.
std::optional<Pocket> pocket_of(std::vector<PatchIndex> patches, RayTransport rays,
                                const Eigen::VectorXd& reflectance) {
  const PocketSystem system = system_within(rays, values_at(patches, reflectance).array());
  constexpr double loosely = 1e-6;
  const Field once = Field::Ones(rays.size(), 1);
  const Field bounces = solution_within(
      rays, system, once, Eigen::ArrayXd::Constant(1, loosely * std::sqrt(static_cast<double>(rays.size()))));
  const bool hold = (bounces > 0).all() && (residual_within(rays, system, once, bounces) < 0.5).all();
  const double most = system.is_eliminated() ? most_bounces : most_bounces_by_iterations;
  if (!hold || bounces.maxCoeff() > most) return std::nullopt;
  if (!system.is_eliminated() && !follows_light_of_one(rays, system, 2 * bounces.maxCoeff())) return std::nullopt;
  return Pocket{std::move(patches), std::move(rays), bounces.col(0).matrix()};
}

// BiCGSTAB (van der Vorst 1992) from 0, all bands at once with scalars of their own: each entry of F is read once for
// all. A band that is found takes no further step.
Field by_iterations(const RayTransport& rays, const PocketSystem& system, const Field& right,
                    const Eigen::ArrayXd& goal) {
  constexpr int most_iterations = 400;
  const auto apply = [&](const Field& x) -> Field { return x - rays.apply(system.reflectance * x); };
  Field x = Field::Zero(right.rows(), right.cols());
  Field r = right;
  Field p = r;
  Eigen::ArrayXd rho = dot(right, r);
  for (int k = 0; k < most_iterations; ++k) {
    const Eigen::ArrayXd goes_on = (dot(r, r) > goal.square()).cast<double>();
    if (!(goes_on > 0).any()) break;
    const Field v = apply(p);
    const Eigen::ArrayXd alpha = goes_on * quotient(rho, dot(right, v));
    const Field s = r - scaled(v, alpha);
    const Field t = apply(s);
    const Eigen::ArrayXd omega = goes_on * quotient(dot(t, s), dot(t, t));
    x += scaled(p, alpha) + scaled(s, omega);
    r = s - scaled(t, omega);
    const Eigen::ArrayXd rho_next = dot(right, r);
    const Eigen::ArrayXd beta = quotient(rho_next, rho) * quotient(alpha, omega);
    p = r + scaled(p - scaled(v, omega), beta);
    rho = rho_next;
  }
  return x;
}

}  // namespace

std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  if (!(reflectance.array() > least_reflectance).any()) return nullptr;
  const std::vector<PatchIndex> patches = keeping_light(transport, reflectance);
  if (patches.empty() || static_cast<double>(patches.size()) > largest_part * transport.size()) return nullptr;

  const auto pockets = std::make_shared<Pockets>();
  const RayTransport among = rays_among(transport, patches);
  const Eigen::ArrayXd loses = losing_light(among, values_at(patches, reflectance));
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (loses[static_cast<Eigen::Index>(k)] == 0) pockets->closed.push_back(patches[k]);
  const Groups groups = groups_of(among, loses);
  for (const std::vector<PatchIndex>& members : groups.members) {
    std::vector<PatchIndex> those;
    for (const PatchIndex k : members) those.push_back(patches[k]);
    // What members meet among those that lose light is of their group.
    std::optional<Pocket> pocket = pocket_of(std::move(those), rays_among(among, members, groups.place), reflectance);
    if (pocket) pockets->each.push_back(std::move(*pocket));
  }
  return pockets->each.empty() && pockets->closed.empty() ? nullptr : pockets;
}

PocketSystem system_within(const RayTransport& rays, Field reflectance) {
  PocketSystem system{std::move(reflectance), {}};
  if (rays.size() > few_patches) return system;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(rays.size(), rays.size());
  const Eigen::MatrixXd F = rays.apply(one.array()).matrix();
  for (Eigen::Index band = 0; band < system.reflectance.cols(); ++band)
    system.factors.emplace_back(one - F * system.reflectance.col(band).matrix().asDiagonal());
  return system;
}

Field residual_within(const RayTransport& rays, const PocketSystem& system, const Field& right, const Field& x) {
  return right - x + rays.apply(system.reflectance * x);
}

Field solution_within(const RayTransport& rays, const PocketSystem& system, const Field& right,
                      const Eigen::ArrayXd& goal) {
  if (!system.is_eliminated()) return by_iterations(rays, system, right, goal);
  Field x(right.rows(), right.cols());
  for (std::size_t band = 0; band < system.factors.size(); ++band) {
    const auto column = static_cast<Eigen::Index>(band);
    x.col(column) = system.factors[band].solve(right.col(column).matrix()).array();
  }
  return x;
}

}  // namespace patchlight
