#include "lighting/mirrored_sources.h"

#include "base/sampling.h"

#include <numbers>
#include <variant>

namespace patchlight {
namespace {

std::optional<MirroredArrival> arrived(const SurfacePoint& at, const Arrival& arrival) {
  if (!(arrival.irradiance > 0)) return {};
  return MirroredArrival{{at.point, arrival.from, at.polygon, no_polygon}, arrival.irradiance * *arrival.colour};
}

// E G A: one point of the lamp.
std::optional<MirroredArrival> from_lamp(const LampFace& lamp, const Point& y, const SurfacePoint& at,
                                         const SurfacePoint& image) {
  const Vector toward = y - image.point;
  const double cosine = image.normal.dot(toward);
  const double cosine_there = -lamp.normal.dot(toward);
  if (!(cosine > 0 && cosine_there > 0)) return {};
  const double geometry = cosine * cosine_there / (std::numbers::pi * toward.squaredNorm() * toward.squaredNorm());
  return MirroredArrival{{at.point, y, at.polygon, lamp.polygon}, geometry * lamp.area * lamp.exitance};
}

}  // namespace

std::vector<MirroredSource> mirrored_sources(const Lighting& lighting, std::span<const LampFace> lamps) {
  std::vector<MirroredSource> sources;
  const auto luminaires = static_cast<std::uint32_t>(lighting.luminaires.size());
  for (std::uint32_t k = 0; k < luminaires; ++k) {
    const Luminaire& luminaire = lighting.luminaires[k];
    const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
    sources.push_back({k,
                       [&](const SurfacePoint& at, const SurfacePoint& image, const Eigen::Vector2d& uv) {
                         return arrived(at, from_luminaire(luminaire, lighting.up, image, uv));
                       },
                       {{}, {luminaire.position, sphere != nullptr ? sphere->radius : 0}},
                       luminaire.aim});
  }
  if (lighting.sun)
    sources.push_back({luminaires,
                       [&](const SurfacePoint& at, const SurfacePoint& image, const Eigen::Vector2d&) {
                         return arrived(at, from_sun(lighting, image));
                       },
                       {lighting.sun->direction, {}}});
  for (const LampFace& lamp : lamps)
    sources.push_back({luminaires + 1 + lamp.polygon,
                       [&lamp, points = QuadPoints(lamp.corners)](const SurfacePoint& at, const SurfacePoint& image,
                                                                  const Eigen::Vector2d& uv) {
                         return from_lamp(lamp, points.at(uv.x(), uv.y()), at, image);
                       },
                       {{}, ball_around(lamp.corners)},
                       lamp.normal});
  return sources;
}

}  // namespace patchlight
