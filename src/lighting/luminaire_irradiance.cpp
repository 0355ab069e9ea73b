#include "lighting/luminaire_irradiance.h"

#include "form_factor/solid_angle.h"
#include "lighting/shades.h"

#include <algorithm>
#include <cmath>
#include <optional>
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

// The irradiance without shadows on a part of a patch, for a colour of 1.
struct Kernel {
  double mean = 0;     // by its middle and its corners, right up to the third order
  double error = 0;    // of the mean: what the corners have changed
  double scatter = 0;  // in the part, as of what is evenly distributed between the extremes
};

Kernel kernel_of(const Lighting& lighting, const Luminaire& luminaire, const std::array<Point, 4>& corners,
                 const Vector& normal) {
  const auto at = [&](const Point& point) {
    return from_luminaire(luminaire, lighting.up, {point, normal, no_polygon}, {0.5, 0.5}).irradiance;
  };
  const double middle = at((corners[0] + corners[1] + corners[2] + corners[3]) / 4);
  double lowest = middle, highest = middle, sum = 0;
  for (const Point& corner : corners) {
    const double E = at(corner);
    lowest = std::min(lowest, E);
    highest = std::max(highest, E);
    sum += E;
  }
  const double mean = (2 * middle + sum / 4) / 3;
  return {mean, std::abs(mean - middle), (highest - lowest) / std::sqrt(12.0)};
}

}  // namespace

Spectrum luminaire_irradiance(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                              const ReceiverSamples& samples, bool in_shadow) {
  Spectrum sum = Spectrum::Zero(lighting.bands);
  const SeenPatch seen = seen_patch(lighting, luminaire, receiver, samples.rays);
  if (seen.segments.empty()) return sum;
  const double share = exposed_share(lighting, receiver, samples.places);
  if (!(share > 0)) return sum;
  if (in_shadow) {
    const Field transmittance = lighting.paths.transmittance(seen.segments);
    for (std::size_t k = 0; k < seen.intensities.size(); ++k)
      sum += seen.intensities[k] * transmittance.row(static_cast<Eigen::Index>(k)) * *seen.colour;
  } else {
    for (const double intensity : seen.intensities) sum += intensity * *seen.colour;
  }
  // E = 1 / A times the integral of I tau over the solid angle; the weights' mean, which is 1, is divided by because
  // what both vary by cancels.
  return sum * (seen.solid_angle / (seen.weights * share * area_vector(receiver.corners).norm()));
}

std::optional<LeftByShadows> left_by_shadows(const Lighting& lighting, const Luminaire& luminaire,
                                             const Receiver& receiver) {
  const LightPlace light{luminaire.position, 1};
  const Spectrum none = Spectrum::Zero(lighting.bands);
  const auto whole = lighting.shades->transmittance(receiver, light);
  if (!whole) return std::nullopt;
  if ((*whole == 0).all() || (*whole == 1).all()) return LeftByShadows{*whole, none};

  // Each part by its mean irradiance without shadows.
  const auto parts = lighting.shades->lit_parts(receiver, light);
  if (!parts) return std::nullopt;
  const Vector normal = receiver.place(0.5, 0.5).normal;
  Spectrum lit = none;
  Spectrum error = none;
  double all = 0;
  for (const LitPart& part : *parts) {
    if (!(part.exposed > 0)) continue;
    const Kernel kernel = kernel_of(lighting, luminaire, part.corners, normal);
    all += part.exposed * kernel.mean;
    lit += part.lit * kernel.mean;
    error += part.uneven * kernel.scatter + part.lit * kernel.error + part.doubt * kernel.mean;
  }
  // A beam narrower than the parts falls between their points: it may be in the light or in the shadow.
  if (!(all > 0)) return LeftByShadows{*whole, whole->min(1 - *whole).max(0.0)};
  return LeftByShadows{lit / all, error / all};
}

}  // namespace patchlight
