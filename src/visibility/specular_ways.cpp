#include "visibility/specular_ways.h"

#include "base/sampling.h"
#include "scene/transmittance.h"

#include <optional>

namespace patchlight {
namespace {

// As many as shadow rays cross.
constexpr std::uint64_t most_meetings = 64;

// What a ray does at a stop that is not its last by number.
Onward onward_at(const SpecularFaces& faces, const Hit& hit, double drawn) {
  const SpecularFace* const face = faces.at(hit.polygon);
  if (!face || !face->is_specular(hit.side)) return Onward::ends;
  const double cosine = cosine_between(faces.normal(hit.polygon), hit.direction);
  return drawn < face->mirrored_rays(hit.side, cosine) ? Onward::mirrored : Onward::through;
}

Way way_from(const Occluder& occluder, const std::optional<Hit>& first, std::uint64_t seed, std::size_t key) {
  const SpecularFaces& faces = occluder.specular_faces();
  Way way;
  std::optional<Hit> hit = first;
  for (std::uint64_t meeting = 0; hit; ++meeting) {
    way.push_back({*hit, Onward::ends});
    if (meeting == most_meetings) return way;
    WayStop& stop = way.back();
    stop.onward = onward_at(faces, stop.hit, hash({seed, key, meeting}) * 0x1p-32);
    if (stop.onward == Onward::ends) return way;
    const bool is_mirrored = stop.onward == Onward::mirrored;
    const Vector direction = is_mirrored ? occluder.mirrored(stop.hit.polygon, stop.hit.direction) : stop.hit.direction;
    const Ray next{stop.hit.point, direction, stop.hit.polygon};
    hit = occluder.first_hits({&next, 1}).front();
    if (!hit) return way;
    hit->distance += stop.hit.distance;
    hit->reflections = stop.hit.reflections + (is_mirrored ? 1 : 0);
  }
  return way;
}

}  // namespace

std::vector<Way> specular_ways(const Occluder& occluder, std::span<const Ray> rays, std::uint64_t seed,
                               std::span<const std::size_t> keys) {
  const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
  std::vector<Way> ways;
  ways.reserve(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k)
    ways.push_back(way_from(occluder, hits[k], seed, keys.empty() ? k : keys[k]));
  return ways;
}

}  // namespace patchlight
