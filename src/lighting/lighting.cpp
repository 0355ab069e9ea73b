#include "lighting/lighting.h"

#include "lighting/mirrored_irradiance.h"
#include "lighting/shades.h"
#include "scene/photometric_web.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

// Relative intensity and color of lamps without extent.
double relative_intensity(const PointLight&, const Luminaire&, const Vector&, const Vector&) { return 1; }
double relative_intensity(const SpotLight& spot, const Luminaire& luminaire, const Vector& direction, const Vector&) {
  return spot_profile(spot, luminaire.aim.dot(direction));
}
double relative_intensity(const WebLight& light, const Luminaire& luminaire, const Vector& direction,
                          const Vector& up) {
  const double tilt = std::acos(std::clamp(-luminaire.aim.dot(up), -1.0, 1.0)) * (180 / std::numbers::pi);
  return tilt_factor(*light.web, tilt) * candela(*light.web, {luminaire.aim, luminaire.zero_plane}, direction);
}
const Spectrum& colour_of(const PointLight& light) { return light.intensity; }
const Spectrum& colour_of(const SpotLight& light) { return light.intensity; }
const Spectrum& colour_of(const WebLight& light) { return light.watts_per_lumen; }

// E = I cos theta / d^2
template <typename Light>
Arrival from_light(const Light& light, const Luminaire& luminaire, const Vector& up, const SurfacePoint& at) {
  const Vector way = luminaire.position - at.point;
  const double square = way.squaredNorm();
  const double cosine = at.normal.dot(way) / std::sqrt(square);
  if (!(cosine > 0)) return {};
  const double intensity = relative_intensity(light, luminaire, -way / std::sqrt(square), up);
  return {luminaire.position, intensity * cosine / square, &colour_of(light)};
}

Arrival from_sphere(const SphericalLamp& lamp, const Point& centre, const SurfacePoint& at, const Eigen::Vector2d& uv) {
  const Vector way = centre - at.point;
  const double distance = way.norm();
  if (distance <= lamp.radius) return {};
  // The sphere fills the cone with this half angle; 1 - cos without cancellation.
  const double sine = lamp.radius / distance;
  const double lift = sine * sine / (1 + std::sqrt(1 - sine * sine));
  const double cosine = 1 - uv.x() * lift;
  const double turn = 2 * std::numbers::pi * uv.y();
  const Vector axis = way / distance;
  const Vector across = axis.unitOrthogonal();
  const Vector direction = cosine * axis + std::sqrt(std::max(0.0, 1 - cosine * cosine)) *
                                               (std::cos(turn) * across + std::sin(turn) * axis.cross(across));
  const double received = at.normal.dot(direction);
  if (!(received > 0)) return {};
  // Nearer than the sphere's middle by the half chord.
  const double along = distance * cosine;
  const double half_chord = std::sqrt(std::max(0.0, lamp.radius * lamp.radius - distance * distance + along * along));
  // L times the solid angle of the cone, 2 pi (1 - cos), with L = E / pi.
  return {at.point + (along - half_chord) * direction, 2 * lift * received, &lamp.exitance};
}

}  // namespace

Lighting lighting_of(const Scene& scene, const Tracing& tracing) {
  Lighting lighting{.luminaires = scene.luminaires,
                    .sun = {},
                    .sky = {},
                    .openings = {},
                    .up = scene.up,
                    .bands = number_of_bands(scene),
                    .paths = LightPaths(scene, tracing),
                    .shades = {},
                    .mirrors = {}};
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0) lighting.sun = scene.sun;
  if (lighting.sun || !scene.luminaires.empty())
    lighting.shades = std::make_shared<const Shades>(scene, tracing.coverings(), lighting.paths.optics());
  if (scene.sky) {
    lighting.sky = sky_model(*scene.sky, scene.up);
    lighting.openings = sky_openings(scene, lighting.paths);
  }
  if (tracing.reflections() == Reflections::followed && tracing.has_specular_surfaces())
    lighting.mirrors = std::make_shared<const Mirrors>(scene, tracing, lighting);
  return lighting;
}

Arrival from_luminaire(const Luminaire& luminaire, const Vector& up, const SurfacePoint& at,
                       const Eigen::Vector2d& uv) {
  if (const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light))
    return from_sphere(*sphere, luminaire.position, at, uv);
  if (const auto* point = std::get_if<PointLight>(&luminaire.light)) return from_light(*point, luminaire, up, at);
  if (const auto* spot = std::get_if<SpotLight>(&luminaire.light)) return from_light(*spot, luminaire, up, at);
  return from_light(std::get<WebLight>(luminaire.light), luminaire, up, at);
}

Arrival from_sun(const Lighting& lighting, const SurfacePoint& at) {
  const double cosine = at.normal.dot(lighting.sun->direction);
  if (!(cosine > 0)) return {};
  return {lighting.paths.beyond(at.point, lighting.sun->direction), cosine, &lighting.sun->normal_irradiance};
}

std::vector<LampFace> lamp_faces(const Scene& scene, PolygonIndex polygon, Side side) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  const Spectrum& exitance = scene.materials[material_on(scene.polygons[polygon], side)].exitance;
  const Vector normal = (side == Side::front ? 1 : -1) * front_normal(scene, polygon);
  std::vector<LampFace> faces;
  if (corners.size() == 4 && is_convex(corners)) {
    faces.push_back(
        {{corners[0], corners[1], corners[2], corners[3]}, normal, area_vector(corners).norm(), polygon, exitance});
    return faces;
  }
  for (const auto& [a, b, c] : triangles_of(corners))
    faces.push_back({{a, b, c, c}, normal, (b - a).cross(c - a).norm() / 2, polygon, exitance});
  return faces;
}

}  // namespace patchlight
