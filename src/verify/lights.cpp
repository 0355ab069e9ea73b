#include "verify/lights.h"

#include "lighting/mirrored_irradiance.h"

#include <algorithm>
#include <cstddef>

namespace patchlight {
namespace {

// A shadow ray from a place, and what it brings if nothing is in the way.
struct Shadow {
  Eigen::Index place = 0;
  Segment segment;
  Spectrum irradiance;
};

Shadow shadow_of(std::size_t place, const SurfacePoint& at, const Arrival& arrival, double weight) {
  return {static_cast<Eigen::Index>(place),
          {at.point, arrival.from, at.polygon, no_polygon},
          weight * arrival.irradiance * *arrival.colour};
}

// Mean of the bands.
double size_of(const Arrival& arrival) {
  return arrival.irradiance > 0 ? arrival.irradiance * arrival.colour->mean() : 0;
}

// One of the luminaires, chosen with the probability w / sum w, w what each would give: it counts sum w / w times.
void add_luminaire(std::vector<Shadow>& shadows, const Lighting& lighting, std::size_t k, const LitPlace& place) {
  std::vector<Arrival> arrivals;
  double sum = 0;
  for (const Luminaire& luminaire : lighting.luminaires) {
    arrivals.push_back(from_luminaire(luminaire, lighting.up, place.at, place.uv));
    sum += size_of(arrivals.back());
  }
  double left = place.choice * sum;
  const Arrival* chosen = nullptr;
  for (const Arrival& arrival : arrivals) {
    if (!(size_of(arrival) > 0)) continue;
    chosen = &arrival;
    left -= size_of(arrival);
    if (left < 0) break;
  }
  if (chosen != nullptr) shadows.push_back(shadow_of(k, place.at, *chosen, sum / size_of(*chosen)));
}

}  // namespace

Field irradiance_by_lights(const Lighting& lighting, std::span<const LitPlace> places) {
  std::vector<Shadow> shadows;
  for (std::size_t k = 0; k < places.size(); ++k) {
    add_luminaire(shadows, lighting, k, places[k]);
    if (!lighting.sun) continue;
    const Arrival of_sun = from_sun(lighting, places[k].at);
    if (of_sun.irradiance > 0) shadows.push_back(shadow_of(k, places[k].at, of_sun, 1));
  }
  std::vector<Segment> segments;
  for (const Shadow& shadow : shadows) segments.push_back(shadow.segment);
  const Field transmittance = lighting.paths.transmittance(segments);
  Field irradiance = Field::Zero(static_cast<Eigen::Index>(places.size()), lighting.bands);
  for (std::size_t k = 0; k < shadows.size(); ++k)
    irradiance.row(shadows[k].place) += shadows[k].irradiance * transmittance.row(static_cast<Eigen::Index>(k));
  return irradiance;
}

Field irradiance_in_mirrors(const Lighting& lighting, std::span<const LitPlace> places) {
  Field irradiance = Field::Zero(static_cast<Eigen::Index>(places.size()), lighting.bands);
  if (!lighting.mirrors) return irradiance;
  for (const MirrorChain& chain : lighting.mirrors->paths.chains()) {
    std::vector<Shadow> shadows;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const SurfacePoint& at = places[k].at;
      LitPlace image = places[k];
      image.at = {chain.image * at.point, chain.image.linear() * at.normal, at.polygon};
      const std::size_t before = shadows.size();
      add_luminaire(shadows, lighting, k, image);
      const Arrival of_sun = lighting.sun ? from_sun(lighting, image.at) : Arrival{};
      if (of_sun.irradiance > 0) shadows.push_back(shadow_of(k, image.at, of_sun, 1));
      for (std::size_t s = before; s < shadows.size(); ++s) shadows[s].segment.from = at.point;
    }
    std::vector<Segment> segments;
    for (const Shadow& shadow : shadows) segments.push_back(shadow.segment);
    const Field transmittance = lighting.mirrors->paths.transmittance(chain, lighting.paths, segments);
    for (std::size_t k = 0; k < shadows.size(); ++k)
      irradiance.row(shadows[k].place) += shadows[k].irradiance * transmittance.row(static_cast<Eigen::Index>(k));
  }
  return irradiance;
}

Field radiance_from_outside(const Lighting& lighting, std::span<const Ray> rays) {
  Field found = Field::Zero(static_cast<Eigen::Index>(rays.size()), lighting.bands);
  if (!lighting.sky) return found;
  std::vector<Segment> segments;
  for (const Ray& ray : rays)
    segments.push_back({ray.origin, lighting.paths.beyond(ray.origin, ray.direction), ray.from_polygon, no_polygon});
  found = lighting.paths.transmittance(segments);
  for (std::size_t k = 0; k < rays.size(); ++k)
    found.row(static_cast<Eigen::Index>(k)) *= radiance(*lighting.sky, rays[k].direction);
  return found;
}

}  // namespace patchlight
