#include "verify/ray_walk.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

// Rays between ideal mirrors may never end.
constexpr std::uint64_t max_meetings = 4096;

// After so many meetings a ray ends with the probability of absorption; before, where nothing is scattered, it goes on
// with less weight.
constexpr std::uint64_t roulette_after = 4;

bool scatters(const Surface& surface) {
  return (surface.reflectance > 0).any() || (surface.exitance > 0).any() || (surface.scattered_through > 0).any();
}

}  // namespace

RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed) {
  RayEnd end{std::move(hit), direction, Spectrum::Ones(scene.bands())};
  for (std::uint64_t meeting = 0; end.hit && meeting < max_meetings; ++meeting) {
    const Hit met = *end.hit;
    const Surface& surface = scene.surfaces().at(met.polygon, met.side);
    if (!surface.is_specular) break;
    const double cosine = surface.normal.dot(met.direction);
    const Spectrum through = transmittance(surface, cosine);
    const Spectrum mirrored = specular_reflectance(surface, cosine);
    const bool may_end = scatters(surface) || meeting >= roulette_after;
    const double ends = may_end ? std::max(0.0, 1 - through.mean() - mirrored.mean()) : 0;
    const double sum = through.mean() + mirrored.mean() + ends;
    const double drawn = sum * uniform({seed, meeting, 6});
    if (drawn >= through.mean() + mirrored.mean()) {
      end.factor *=
          ends > 0 ? Spectrum(relative_held(surface, cosine) * (sum / ends)) : Spectrum(Spectrum::Zero(scene.bands()));
      break;
    }
    const bool is_mirrored = drawn >= through.mean();
    end.factor *= (is_mirrored ? mirrored / mirrored.mean() : through / through.mean()) * sum;
    if (is_mirrored) end.direction = mirrored_direction(surface.normal, end.direction);
    const Ray onward{met.point, end.direction, met.polygon};
    end.hit = scene.faces().first_hits({&onward, 1}).front();
    if (!end.hit) break;
    end.hit->distance += met.distance;
    end.hit->reflections = met.reflections + (is_mirrored ? 1 : 0);
  }
  return end;
}

}  // namespace patchlight
