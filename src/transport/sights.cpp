#include "transport/sights.h"

#include "base/sampling.h"
#include "optics/surface_optics.h"
#include "visibility/walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace patchlight {

Eigen::Matrix3d patch_frame(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  Eigen::Matrix3d frame;
  frame.col(2) = mesh.normal[patch];
  frame.col(1) = frame.col(2).cross(corners.points[1] - corners.points[0]).normalized();
  frame.col(0) = frame.col(1).cross(frame.col(2));
  return frame;
}

namespace {

// How a ray goes on at a stop that is not its last by number.
Onward onward_at(const SurfaceOptics& faces, const Hit& hit, double drawn) {
  const SpecularSurface* const face = faces.at(hit.polygon);
  if (!face || !face->is_specular(hit.side)) return Onward::ends;
  const double cosine = cosine_between(faces.normal(hit.polygon), hit.direction);
  return drawn < face->mirrored_rays(hit.side, cosine) ? Onward::mirrored : Onward::through;
}

Way way_from(const Occluder& occluder, const std::optional<Hit>& first, std::uint64_t seed, std::size_t key) {
  const SurfaceOptics& optics = occluder.optics();
  Way way;
  const auto draw = [&](const Hit& hit, std::uint64_t meeting) -> std::optional<Vector> {
    const Onward onward = onward_at(optics, hit, hash({seed, key, meeting}) * 0x1p-32);
    way.push_back({hit, onward});
    if (onward == Onward::ends) return {};
    return onward == Onward::mirrored ? optics.mirrored(hit.polygon, hit.direction) : hit.direction;
  };
  const std::optional<Hit> last = follow_path(occluder, first, draw);
  if (way.size() == Occluder::most_meetings && last && way.back().onward != Onward::ends)
    way.push_back({*last, Onward::ends});
  return way;
}

// Drawn by `seed` as Occluder::sample_nonspecular_hits() draws.
std::vector<Way> specular_ways(const Occluder& occluder, std::span<const Ray> rays, std::uint64_t seed,
                               std::span<const std::size_t> keys) {
  const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
  std::vector<Way> ways;
  ways.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k)
    ways.push_back(way_from(occluder, hits[k], seed, keys.empty() ? k : keys[k]));
  return ways;
}

// Where a ray ends; null where it has left the scene.
const Hit* end_of(const std::optional<Hit>& hit) { return hit ? &*hit : nullptr; }
const Hit* end_of(const Way& way) { return has_left(way) ? nullptr : &way.back().hit; }

}  // namespace

int count(std::span<const Seen> among, Sight sight) {
  return static_cast<int>(
      std::count_if(among.begin(), among.end(), [&](const Seen& one) { return one.sight == sight; }));
}

int unseen(std::span<const Seen> seen) { return count(seen, Sight::back) + count(seen, Sight::contact); }

Sights::Sights(const PatchMesh& mesh, const Occluder& occluder)
    : mesh_(mesh), occluder_(occluder), behind_(1e-5 * (1 / occluder.frame().scale)) {}

bool Sights::has_patches(const Hit& hit) const {
  const PatchRange range = mesh_.patches_on(hit.polygon, hit.side);
  return range.begin != range.end;
}

// 1 for each ray that starts where the patch is covered; it need not be traced.
std::vector<std::uint8_t> Sights::covered_starts(PatchIndex patch, std::vector<Ray>& rays) const {
  std::vector<std::uint8_t> covered(rays.size(), 0);
  if (!occluder_.is_covered_in_part(mesh_.polygon[patch], mesh_.side[patch])) return covered;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (!occluder_.is_covered(mesh_.polygon[patch], mesh_.side[patch], rays[k].origin)) continue;
    covered[k] = 1;
    rays[k].direction.setZero();
  }
  return covered;
}

Ray Sights::moved(PatchIndex patch, Ray ray) const {
  ray.origin += 0.01 * (mesh_.centroid[patch] - ray.origin) - behind_ * mesh_.normal[patch];
  return ray;
}

bool Sights::lies_behind(PatchIndex patch, double height, const Hit& hit) const {
  // If two faces in one plane look the same way, e.g. a rug on a floor, the ray hits the lower one from behind.
  const Side other = hit.side == Side::front ? Side::back : Side::front;
  if (occluder_.lies_over(mesh_.polygon[patch], hit.polygon, other)) return true;
  if (!has_patches(hit) && occluder_.is_covered(hit.polygon, other, hit.point)) return true;
  if (height >= behind_) return false;
  const Vector& normal = mesh_.normal[patch];
  const Ray back{hit.point + (behind_ - height) * normal, -normal, mesh_.polygon[patch]};
  const auto next = occluder_.first_hits({&back, 1})[0];
  // A face that lies farther behind the patch is no face in contact that rounding has bent.
  return next && next->polygon == hit.polygon && next->distance > 0.2 * behind_;
}

Sight Sights::sight_of_second_try(PatchIndex patch, const Ray& ray, const Hit& hit) const {
  const double height = hit.distance * ray.direction.dot(mesh_.normal[patch]);
  if (height < 2 * behind_ && lies_behind(patch, height, hit)) return Sight::nothing;
  return height < 2 * behind_ ? Sight::contact : sight_at(hit);
}

template <typename Met, typename Trace>
std::vector<SeenBy<Met>> Sights::seen_by(PatchIndex patch, std::vector<Ray> rays, const Trace& trace) const {
  std::vector<SeenBy<Met>> seen(rays.size());
  const std::vector<std::uint8_t> covered = covered_starts(patch, rays);
  std::vector<Met> met = trace(rays, std::span<const std::size_t>());
  for (const Met& one : met)
    if (const Hit* const hit = end_of(one))
      __builtin_prefetch(&mesh_.first_patch[2 * std::size_t{hit->polygon} + static_cast<std::size_t>(hit->side)]);
  std::vector<Ray> second_tries;
  std::vector<std::size_t> tried_again;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (covered[k] != 0) {
      seen[k].sight = Sight::contact;
    } else if (const Hit* const hit = end_of(met[k])) {
      seen[k].sight = sight_at(*hit);
    } else {
      second_tries.push_back(moved(patch, rays[k]));
      tried_again.push_back(k);
    }
    seen[k].met = std::move(met[k]);
  }
  // A clear polygon lets through again a ray that it has let through once: a second draw would hold back twice.
  met = trace(second_tries, tried_again);
  for (std::size_t k = 0; k < second_tries.size(); ++k) {
    const Hit* const hit = end_of(met[k]);
    const Sight sight = hit ? sight_of_second_try(patch, second_tries[k], *hit) : Sight::nothing;
    if (sight != Sight::nothing) seen[tried_again[k]] = {std::move(met[k]), sight};
  }
  return seen;
}

std::vector<Seen> Sights::of_rays(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const {
  return seen_by<std::optional<Hit>>(patch, std::move(rays), [&](const auto& some, const auto& keys) {
    return occluder_.sample_nonspecular_hits(some, seed, keys);
  });
}

std::vector<SeenWay> Sights::along_ways(PatchIndex patch, std::vector<Ray> rays, std::uint32_t seed) const {
  return seen_by<Way>(patch, std::move(rays),
                      [&](const auto& some, const auto& keys) { return specular_ways(occluder_, some, seed, keys); });
}

bool Sights::is_in_contact(const Hit& hit) const {
  const Vector& normal = mesh_.normal[mesh_.patches_on(hit.polygon, hit.side).begin];
  const Ray through{hit.point - behind_ * normal, normal, hit.polygon};
  const auto next = occluder_.first_hits({&through, 1})[0];
  if (!next || next->distance >= 2 * behind_ || !has_patches(*next)) return false;
  const Side other = next->side == Side::front ? Side::back : Side::front;
  return !occluder_.lies_over(hit.polygon, next->polygon, other);
}

}  // namespace patchlight
