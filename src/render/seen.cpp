#include "render/seen.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

constexpr int most_crossings = 64;  // sides without patches that one ray may pass

// Of what a ray sees over several mirrors less than this is left out.
constexpr double least_share = 0.01;

// Rays that are still under way.
struct UnderWay {
  std::vector<Ray> rays;
  std::vector<std::size_t> of_ray;  // where each has begun
  std::vector<double> shares;
  std::vector<double> gone;              // metres so far
  std::vector<std::uint8_t> is_through;  // 1 behind a clear face

  void add(const Ray& ray, std::size_t begun, double share, double so_far, bool through) {
    rays.push_back(ray);
    of_ray.push_back(begun);
    shares.push_back(share);
    gone.push_back(so_far);
    is_through.push_back(through ? 1 : 0);
  }
};

struct MetSphere {
  const SeenSphere* sphere = nullptr;
  double distance = std::numeric_limits<double>::infinity();
};

// The nearest one on the way of a ray.
MetSphere met_by(const Ray& ray, const std::vector<SeenSphere>& spheres) {
  MetSphere met;
  for (const SeenSphere& sphere : spheres) {
    // |o + t d - c| = r
    const Vector way = sphere.centre - ray.origin;
    const double nearest = way.dot(ray.direction);
    const double root = sphere.radius * sphere.radius - (way - nearest * ray.direction).squaredNorm();
    if (!(root > 0)) continue;
    const double distance = nearest - std::sqrt(root);
    if (distance > 0 && distance < met.distance) met = {&sphere, distance};
  }
  return met;
}

}  // namespace

std::vector<SeenSphere> spheres_of(const std::vector<Luminaire>& luminaires) {
  std::vector<SeenSphere> spheres;
  for (const Luminaire& luminaire : luminaires) {
    const auto* const lamp = std::get_if<SphericalLamp>(&luminaire.light);
    if (lamp != nullptr) spheres.push_back({luminaire.position, lamp->radius, lamp->exitance / std::numbers::pi});
  }
  return spheres;
}

std::vector<SeenPatch> seen_by(const Occluder& occluder, const PatchLookup& lookup, const std::vector<Ray>& rays,
                               const std::vector<SeenSphere>& spheres) {
  std::vector<SeenPatch> seen;
  UnderWay now;
  for (std::size_t k = 0; k < rays.size(); ++k) now.add(rays[k], k, 1, 0, false);
  for (int crossing = 0; crossing <= most_crossings && !now.rays.empty(); ++crossing) {
    const std::vector<std::optional<Hit>> hits = occluder.first_hits(now.rays);
    UnderWay next;
    for (std::size_t k = 0; k < now.rays.size(); ++k) {
      const std::optional<Hit>& hit = hits[k];
      const std::size_t begun = now.of_ray[k];
      const double share = now.shares[k];
      const bool through = now.is_through[k] != 0;
      if (const MetSphere met = met_by(now.rays[k], spheres); met.sphere && (!hit || met.distance < hit->distance)) {
        const Point place = now.rays[k].origin + met.distance * now.rays[k].direction;
        seen.push_back(
            {begun, {}, place, now.rays[k].direction, share, through, now.gone[k] + met.distance, met.sphere});
        continue;
      }
      if (!hit) {
        seen.push_back({begun, {}, {}, now.rays[k].direction, share, true, std::numeric_limits<double>::infinity()});
        continue;
      }
      const auto patch = lookup.patch_at(hit->polygon, hit->side, hit->point);
      const Vector& direction = hit->direction;
      const double gone = now.gone[k] + hit->distance;
      if (!patch) {
        next.add({hit->point, direction, hit->polygon}, begun, share, gone, through);
        continue;
      }
      const double held = share * occluder.relative_held(hit->polygon, direction);
      seen.push_back({begun, *patch, hit->point, direction, held, through, gone});
      const double onward = share * occluder.transmittance(hit->polygon, direction);
      if (onward > 0) next.add({hit->point, direction, hit->polygon}, begun, onward, gone, true);
      const double reflected = share * occluder.specular_reflectance(hit->polygon, direction);
      if (reflected > least_share)
        next.add({hit->point, occluder.mirrored(hit->polygon, direction), hit->polygon}, begun, reflected, gone,
                 through);
    }
    now = std::move(next);
  }
  return seen;
}

}  // namespace patchlight
