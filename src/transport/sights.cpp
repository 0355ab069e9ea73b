#include "transport/sights.h"

#include "base/sampling.h"

#include <algorithm>

namespace patchlight {
namespace {

// Second tries start this share of the way to the centroid, and this share of the scene's extent behind the patch.
constexpr double toward_centroid = 0.01;
constexpr double behind_plane = 1e-5;

}  // namespace

int count(std::span<const Seen> among, Sight sight) {
  return static_cast<int>(
      std::count_if(among.begin(), among.end(), [&](const Seen& one) { return one.sight == sight; }));
}

int unseen(std::span<const Seen> seen) { return count(seen, Sight::back) + count(seen, Sight::contact); }

Sights::Sights(const PatchMesh& mesh, const Occluder& occluder)
    : mesh_(mesh), occluder_(occluder), behind_(behind_plane * (1 / occluder.frame().scale)) {}

bool Sights::has_patches(const Hit& hit) const {
  const PatchRange range = mesh_.patches_on(hit.polygon, hit.side);
  return range.begin != range.end;
}

Seen Sights::seen_at(const Hit& hit) const { return {has_patches(hit) ? Sight::patch : Sight::back, hit}; }

std::vector<Seen> Sights::of_rays(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const {
  std::vector<Seen> seen(rays.size());
  if (occluder_.is_covered_in_part(mesh_.polygon[patch], mesh_.side[patch])) {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      if (!occluder_.is_covered(mesh_.polygon[patch], mesh_.side[patch], rays[k].origin)) continue;
      seen[k].sight = Sight::contact;
      rays[k].direction.setZero();  // need not be traced
    }
  }
  std::vector<Ray> second_tries;
  std::vector<std::size_t> tried_again;
  const auto hits = occluder_.first_held_hits(rays, seed);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (seen[k].sight == Sight::contact) continue;
    if (hits[k]) {
      seen[k] = seen_at(*hits[k]);
      continue;
    }
    Ray moved = rays[k];
    moved.origin += toward_centroid * (mesh_.centroid[patch] - moved.origin) - behind_ * mesh_.normal[patch];
    second_tries.push_back(moved);
    tried_again.push_back(k);
  }
  // What a clear polygon has let through once it lets through again: a second draw would hold back twice.
  const auto second_hits = occluder_.first_held_hits(second_tries, seed, tried_again);
  for (std::size_t k = 0; k < second_tries.size(); ++k) {
    if (!second_hits[k]) continue;
    const double height = second_hits[k]->distance * second_tries[k].direction.dot(mesh_.normal[patch]);
    seen[tried_again[k]] = seen_at(*second_hits[k]);
    if (height < 2 * behind_) seen[tried_again[k]].sight = Sight::contact;
  }
  return seen;
}

bool Sights::is_in_contact(const Hit& hit) const {
  const Vector& normal = mesh_.normal[mesh_.patches_on(hit.polygon, hit.side).begin];
  const Ray through{hit.point - behind_ * normal, normal, hit.polygon};
  const auto next = occluder_.first_hits({&through, 1})[0];
  return next && next->distance < 2 * behind_ && has_patches(*next);
}

}  // namespace patchlight
