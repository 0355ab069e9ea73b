#include "patchlight/transport/lost_share.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/patch_shape.h"
#include "mesh/nested_mesh.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// To test whether a point is covered, this many rays start there over the hemisphere, and the same number around the
// horizon.
constexpr int rays_per_point = 8;

struct Shares {
  double escaped, at_backs, covered, dark, overlaid;
};

struct HemisphereSampler {
  const PatchMesh& mesh;
  const Occluder& occluder;
  Sights sights;
  bool ends_at_specular;
  bool sees_backs;
  double small;  // area in m^2 below which patches are small

  std::vector<Seen> look(PatchIndex patch, const std::vector<Ray>& rays, std::uint32_t seed) const;
  std::vector<Ray> hemisphere_rays(PatchIndex patch, int groups, int size, std::uint32_t seed) const;
  std::vector<Seen> look_together(PatchIndex patch, const std::vector<Ray>& rays, std::uint32_t seed) const;
  Shares measure_groups(PatchIndex patch, const std::vector<Ray>& rays, std::uint32_t seed) const;
  Shares measure(PatchIndex patch, int rays, std::uint32_t seed) const;
};

// The ends of rays; at the first polygons if specular polygons are treated like all others.
std::vector<Seen> HemisphereSampler::look(PatchIndex patch, const std::vector<Ray>& rays, std::uint32_t seed) const {
  if (!ends_at_specular) return sights.of_rays(patch, rays, seed);
  std::vector<Seen> seen;
  for (const auto& [way, end] : sights.along_ways(patch, rays, seed)) {
    if (way.empty()) {
      seen.push_back({{}, end});
      continue;
    }
    const Hit& first = way.front().hit;
    const Sight there = sights.has_patches(first) ? Sight::patch : Sight::back;
    seen.push_back({first, way.size() == 1 && !has_left(way) ? end : there});
  }
  return seen;
}

// `groups` starting points, each with `size` directions.
std::vector<Ray> HemisphereSampler::hemisphere_rays(PatchIndex patch, int groups, int size, std::uint32_t seed) const {
  const auto samples = scrambled_sobol(static_cast<std::uint32_t>(groups * size), seed);
  const QuadPoints places(mesh.corner_points(patch).points);
  const Eigen::Matrix3d frame = patch_frame(mesh, patch);
  std::vector<Ray> rays;
  rays.reserve(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    // The first points of the sequence, as every eighth alone would lie in an eighth of the patch.
    const auto& start = samples[k / static_cast<std::size_t>(size)];
    rays.push_back({places.at(start[0], start[1]),
                    frame * (ends_at_specular ? square_to_cosine_hemisphere(samples[k][2], samples[k][3])
                                              : occluder.optics().sample_nonspecular_direction(
                                                    mesh.polygon[patch], samples[k][2], samples[k][3])),
                    mesh.polygon[patch]});
  }
  return rays;
}

// For each group of rays as many from its starting point, evenly around the horizon: under a face that hangs close over
// the patch these get out, inside a solid they do not.
std::vector<Ray> grazing_rays(const PatchMesh& mesh, PatchIndex patch, std::vector<Ray> groups) {
  const Eigen::Matrix3d frame = patch_frame(mesh, patch);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(k % rays_per_point) / rays_per_point;
    groups[k].direction = (frame * Vector(std::cos(azimuth), std::sin(azimuth), 1e-3)).normalized();
  }
  return groups;
}

// Rays with a common start. If some hit backs, the start may be inside a solid. Then a face also counts as a back if
// another lies against it: of two coincident faces a ray hits either.
std::vector<Seen> HemisphereSampler::look_together(PatchIndex patch, const std::vector<Ray>& rays,
                                                   std::uint32_t seed) const {
  std::vector<Seen> seen = look(patch, rays, seed);
  for (std::size_t first = 0; first < seen.size(); first += rays_per_point) {
    const auto group = std::span(seen).subspan(first, rays_per_point);
    if (unseen(group) == 0) continue;
    for (Seen& one : group) {
      if (one.sight == Sight::patch && sights.is_in_contact(*one.met)) one.sight = Sight::back;
    }
  }
  return seen;
}

// The shares by groups of rays from one point each. A point is covered when every ray from it hits a back, a face in
// contact with the patch, or a face in contact with another.
Shares HemisphereSampler::measure_groups(PatchIndex patch, const std::vector<Ray>& rays, std::uint32_t seed) const {
  const std::vector<Seen> seen = look_together(patch, rays, seed);
  int covered = 0, exposed = 0, escaped = 0, at_backs = 0, dark = 0, overlaid = 0;
  for (std::size_t first = 0; first < seen.size(); first += rays_per_point) {
    const auto group = std::span(seen).subspan(first, rays_per_point);
    if (unseen(group) == rays_per_point) {
      const auto begin = rays.begin() + static_cast<std::ptrdiff_t>(first);
      if (unseen(look_together(patch, grazing_rays(mesh, patch, {begin, begin + rays_per_point}), seed)) ==
          rays_per_point) {
        ++covered;
        overlaid += occluder.is_covered(mesh.polygon[patch], mesh.side[patch], begin->origin) ? 1 : 0;
        continue;
      }
    }
    ++exposed;
    escaped += count(group, Sight::nothing);
    at_backs += count(group, Sight::back);
    dark += 2 * count(group, Sight::back) > rays_per_point ? 1 : 0;
  }
  const double of_rays = std::max(1, exposed * rays_per_point);
  const double points = covered + exposed;
  return {escaped / of_rays, at_backs / of_rays, covered / points, static_cast<double>(dark) / std::max(1, exposed),
          overlaid / points};
}

Shares HemisphereSampler::measure(PatchIndex patch, int rays, std::uint32_t seed) const {
  // 1. Single rays settle it for most patches.
  if (!sees_backs) {
    const std::vector<Seen> seen = look(patch, hemisphere_rays(patch, rays, 1, seed), seed);
    if (unseen(seen) == 0) return {static_cast<double>(count(seen, Sight::nothing)) / rays, 0, 0, 0, 0};
  }
  // 2. If backs are visible, groups of rays distinguish a patch that looks at backs from one inside a solid. For a
  //    small patch a quarter of them is enough, if they find no covered part.
  if (sees_backs && mesh.area[patch] < small) {
    const Shares few = measure_groups(patch, hemisphere_rays(patch, std::max(1, rays / 4), rays_per_point, seed), seed);
    if (few.covered == 0) return few;
  }
  return measure_groups(patch, hemisphere_rays(patch, rays, rays_per_point, seed), seed);
}

}  // namespace

Eigen::ArrayXd rays_of_patches(const LostShare& lost, PatchIndex patches) {
  return lost.rays_per_patch * multiples(lost.doublings, patches);
}

Eigen::VectorXd clear_shares(const PatchMesh& mesh, const Occluder& occluder) {
  Eigen::VectorXd clear(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    clear[i] = 1 - occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i]);
  return clear.isZero(0) ? Eigen::VectorXd() : clear;
}

Eigen::ArrayXd over_exposed_part(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& exposed_area) {
  Eigen::ArrayXd open = Eigen::Map<const Eigen::ArrayXd>(mesh.area.data(), mesh.size());
  if (lost.clear.size() > 0) open *= 1 - lost.clear.array();
  if (lost.overlaid.size() > 0) open *= 1 - lost.overlaid.array();
  const auto in_part = lost.covered.array() > 0 && lost.covered.array() < 1;
  return in_part.select(open / exposed_area.array(), 1.0);
}

Eigen::VectorXd expected_row_sum(const LostShare& lost) { return 1 - lost.escaped.array() - lost.at_backs.array(); }

LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, int rays_per_patch, std::uint64_t seed,
                             const Observer& observer) {
  LostShare none;
  none.rays_per_patch = rays_per_patch;
  const std::vector<PatchIndex> nowhere(mesh.size(), no_patch);
  return measure_lost_share(mesh, occluder, KnownShares{none, nowhere}, seed, observer);
}

LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, const KnownShares& known,
                             std::uint64_t seed, const Observer& observer) {
  const LostShare& before = known.lost;
  assert(known.place.size() == mesh.size());
  const HemisphereSampler sampler{
      mesh, occluder, Sights(mesh, occluder), known.ends_at_specular, known.sees_backs, small_area(mesh)};

  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const auto zero = Eigen::VectorXd::Zero(mesh.size());
  LostShare lost{zero, zero, zero, before.rays_per_patch, zero, {}, zero};
  lost.doublings.assign(known.doublings.begin(), known.doublings.end());
  parallel_for(mesh.size(), Stage::form_factors, observer, [&](std::size_t k) {
    const auto i = static_cast<PatchIndex>(k);
    const PatchIndex b = known.place[i];
    const int rays = before.rays_per_patch << (known.doublings.empty() ? 0 : known.doublings[i]);
    const Shares shares = b == no_patch ? sampler.measure(i, rays, hash({seed, keys[i], stream::lost_rays}))
                                        : Shares{before.escaped[b], before.at_backs[b], before.covered[b],
                                                 before.dark[b], before.overlaid[b]};
    lost.escaped[i] = shares.escaped;
    lost.at_backs[i] = shares.at_backs;
    lost.covered[i] = shares.covered;
    lost.dark[i] = shares.dark;
    lost.overlaid[i] = shares.overlaid;
  });
  lost.clear = clear_shares(mesh, occluder);
  return lost;
}

Eigen::VectorXd exposed_area(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& seen) {
  Eigen::ArrayXd area = Eigen::Map<const Eigen::ArrayXd>(mesh.area.data(), mesh.size());
  if (lost.clear.size() > 0) area *= 1 - lost.clear.array();
  const Eigen::ArrayXd measured = area * (1 - lost.covered.array());
  const Eigen::ArrayXd shown = (lost.covered.array() > 0).select(seen.array(), 0.0);
  return measured.max(shown.min(area)).max(1e-6 * area);
}

}  // namespace patchlight
