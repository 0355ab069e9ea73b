#include "lighting/luminaire_irradiance.h"

#include "patchlight/form_factor/solid_angle.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// Nearer to the plane of a patch, relative to its corners' distance, a luminaire counts as in the plane.
constexpr double luminaire_in_plane = 1e-9;

bool is_before(const Point& luminaire, const Receiver& receiver, const Vector& normal) {
  double height = 0;
  double distance = 0;
  for (const Point& corner : receiver.corners) {
    height = std::max(height, normal.dot(luminaire - corner));
    distance = std::max(distance, (luminaire - corner).norm());
  }
  return height > luminaire_in_plane * distance;
}

double exposed_share(const Lighting& lighting, const Receiver& receiver, SamplePoints places) {
  const PolygonIndex polygon = receiver.place(0.5, 0.5).polygon;
  if (!lighting.paths.is_covered_in_part(polygon, receiver.side)) return 1;
  std::size_t exposed = 0;
  for (const auto& [u, v, s, t] : places) exposed += is_covered(lighting, receiver, receiver.place(u, v)) ? 0 : 1;
  return static_cast<double>(exposed) / static_cast<double>(places.size());
}

// What the luminaire sees of the patch.
struct SeenPatch {
  double solid_angle = 0;
  double weights = 0;  // of all points, those under other polygons as well
  std::vector<Segment> segments;
  std::vector<double> intensities;  // times the points' weights
  const Spectrum* colour = nullptr;
};

SeenPatch seen_patch(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                     SamplePoints rays) {
  SurfacePoint at = receiver.place(0.5, 0.5);
  SeenPatch seen;
  if (!is_before(luminaire.position, receiver, at.normal)) return seen;
  for (const auto& [u, v, s, t] : rays) {
    const SeenPoint sample = sample_seen_point(luminaire.position, receiver.corners, u, v);
    if (!(sample.solid_angle > 0)) return {};
    seen.solid_angle = sample.solid_angle;
    seen.weights += sample.weight;
    at.point = sample.point;
    if (is_covered(lighting, receiver, at)) continue;
    const Arrival arrival = from_luminaire(luminaire, lighting.up, at, {s, t});
    if (!(arrival.irradiance > 0)) continue;
    // I = E d^2 / cos theta
    const Vector way = arrival.from - at.point;
    const double square = way.squaredNorm();
    const double intensity = arrival.irradiance * square * std::sqrt(square) / at.normal.dot(way);
    seen.segments.push_back({at.point, arrival.from, at.polygon, no_polygon});
    seen.intensities.push_back(sample.weight * intensity);
    seen.colour = arrival.colour;
  }
  return seen;
}

}  // namespace

Spectrum luminaire_irradiance(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                              const LuminaireSamples& samples) {
  const Spectrum none = Spectrum::Zero(lighting.bands);
  const SeenPatch seen = seen_patch(lighting, luminaire, receiver, samples.rays);
  if (seen.segments.empty()) return none;
  const double share = exposed_share(lighting, receiver, samples.places);
  if (!(share > 0)) return none;
  // E = 1 / A times the integral of I tau over the solid angle; the weights' mean, which is 1, is divided by because
  // what both vary by cancels.
  const Field transmittance = lighting.paths.transmittance(seen.segments);
  Spectrum sum = none;
  for (std::size_t k = 0; k < seen.intensities.size(); ++k)
    sum += seen.intensities[k] * transmittance.row(static_cast<Eigen::Index>(k)) * *seen.colour;
  return sum * (seen.solid_angle / (seen.weights * share * area_vector(receiver.corners).norm()));
}

}  // namespace patchlight
