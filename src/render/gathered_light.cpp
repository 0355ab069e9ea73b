#include "render/gathered_light.h"

#include "base/sampling.h"
#include "light/texture.h"
#include "lighting/mirrored_irradiance.h"
#include "render/hemisphere.h"
#include "render/pixel_samples.h"
#include "render/sky_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// A record serves up to this share of the harmonic mean distance of what is around it.
constexpr double share_of_distance = 0.25;

// Of light that mirrors and clear faces send to a record; at points there are 16 times as many.
constexpr int samples_of_mirrored = 2;

// From a place that a ray has met so many rays look for lights.
constexpr std::uint32_t rays_of_bounce = 2;

}  // namespace

Spectrum reflectance_at(const SolvedLight& light, PatchIndex patch, const Point& point) {
  if (!light.scene) return light.reflectance.row(patch);
  const Polygon& polygon = light.scene->polygons[light.mesh.polygon[patch]];
  const TextureMap* map = texture_map_on(*light.scene, polygon, light.mesh.side[patch]);
  if (!map) return light.reflectance.row(patch);
  const TexturedReflectance& texture = *light.scene->materials[light.mesh.material[patch]].texture;
  return reflectance_at(texture, map->linear * point + map->offset).min(1);
}

bool is_plain(const SolvedLight& light, PatchIndex patch) {
  return light.occluder.specular_faces().at(light.mesh.polygon[patch]) == nullptr;
}

std::optional<PatchIndex> behind(const SolvedLight& light, PatchIndex patch) {
  if (light.other_side.empty() || light.other_side[patch] == patch) return std::nullopt;
  return light.other_side[patch];
}

// Where a ray ends on a patch; none where it finds nothing.
struct GatheredLight::Stop {
  std::optional<PatchIndex> patch;
  Point point = Point::Zero();
  double distance = std::numeric_limits<double>::infinity();
  bool is_specular = false;  // a mirror or a clear face, or met by way of one
  double held = 1;           // of the patch's side
};

GatheredLight::GatheredLight(const SolvedLight& solved) : solved_(solved), lookup_(solved.mesh) {}

SkyAim GatheredLight::aim_at(PatchIndex patch) const {
  if (!solved_.lights.lighting.sky) return {};
  const PatchMesh& mesh = solved_.mesh;
  const PatchCorners corners = mesh.corner_points(patch);
  const Receiver receiver{
      [&](double u, double v) {
        return SurfacePoint{square_to_quad(corners.points, u, v), mesh.normal[patch], mesh.polygon[patch]};
      },
      mesh.side[patch],
      {corners.points.begin(), corners.points.begin() + corners.count}};
  return aim_at_few(sky_aim(solved_.lights.lighting, receiver, AimFor::points), solved_.lights.lighting.openings);
}

std::vector<GatheredLight::Stop> GatheredLight::stops_of(const std::vector<Ray>& rays, std::uint64_t seed) const {
  const Occluder& occluder = solved_.occluder;
  const auto hits = occluder.first_held_hits(rays, seed);
  std::vector<Stop> stops(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (!hits[k]) continue;
    const Hit& hit = *hits[k];
    Stop& stop = stops[k];
    stop.distance = hit.distance;
    stop.point = hit.point;
    stop.patch = lookup_.patch_at(hit.polygon, hit.side, hit.point);
    stop.held = occluder.held_share(hit.polygon, hit.side);
    stop.is_specular = hit.reflections > 0 || occluder.specular_faces().at(hit.polygon) != nullptr;
  }
  return stops;
}

// The radiosity that each ray finds, without exitance.
Field GatheredLight::arriving(const std::vector<Stop>& stops, int bounces_left, std::uint32_t seed) const {
  const PatchMesh& mesh = solved_.mesh;
  const auto rows = static_cast<Eigen::Index>(stops.size());
  Field found = Field::Zero(rows, solved_.reflected.cols());
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    const Stop& stop = stops[k];
    if (!stop.patch) continue;
    const PatchIndex patch = *stop.patch;
    const bool is_sheet = !solved_.other_side.empty() && solved_.other_side[patch] != patch;
    const bool is_near = stop.distance * stop.distance < mesh.area[patch];
    const bool goes_on = is_near && bounces_left > 0 && !stop.is_specular && !is_sheet &&
                         !solved_.lights.lighting.mirrors && (solved_.exitance.row(patch) == 0).all();
    if (goes_on)
      near.push_back(k);
    else
      found.row(static_cast<Eigen::Index>(k)) = solved_.reflected.row(patch) / stop.held;
  }
  if (near.empty()) return found;

  // From the nearer ones a ray goes on, and others look for lights: rho (H_direct + H_gathered).
  std::vector<Ray> rays;
  std::vector<LitPoint> points;
  std::map<PatchIndex, SkyAim> aims;
  for (std::size_t n = 0; n < near.size(); ++n) {
    const Stop& stop = stops[near[n]];
    const PatchIndex patch = *stop.patch;
    const auto u = pixel_sample(static_cast<std::uint32_t>(n), hash({seed, 3}));
    rays.push_back({stop.point, cosine_direction(mesh.normal[patch], u[0], u[1]), mesh.polygon[patch]});
    const SkyAim* aim = nullptr;
    if (solved_.lights.lighting.sky) {
      auto place = aims.find(patch);
      if (place == aims.end()) place = aims.emplace(patch, aim_at(patch)).first;
      aim = &place->second;
    }
    points.push_back(
        {{stop.point, mesh.normal[patch], mesh.polygon[patch]}, static_cast<std::uint32_t>(n), hash({seed, 4}), aim});
  }
  const Field direct = light_samples(solved_.lights, points, rays_of_bounce);
  const Field onward = arriving(stops_of(rays, hash({seed, 5})), bounces_left - 1, hash({seed, 6}));
  for (std::size_t n = 0; n < near.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    found.row(static_cast<Eigen::Index>(near[n])) =
        reflectance_at(solved_, *stops[near[n]].patch, stops[near[n]].point) * (direct.row(row) + onward.row(row));
  }
  return found;
}

IrradianceRecord GatheredLight::record_at(const PatchPoint& at, std::uint64_t key, double least, double most,
                                          const HemisphereOptions& options) const {
  const PatchMesh& mesh = solved_.mesh;
  const Vector& normal = mesh.normal[at.patch];
  const Hemisphere hemisphere(options.rays, normal);
  const std::uint32_t seed = hash({options.seed, key});
  std::vector<Ray> rays;
  for (const Vector& direction : hemisphere.directions(seed))
    rays.push_back({at.point, direction, mesh.polygon[at.patch]});
  const std::vector<Stop> stops = stops_of(rays, hash({seed, 1}));
  std::vector<double> distances;
  for (const Stop& stop : stops) distances.push_back(stop.distance);
  const HemisphereIrradiance found = hemisphere.irradiance(arriving(stops, options.most_bounces, seed), distances);

  IrradianceRecord record{at.point, normal, 0, found.irradiance, found.gradient, 0};
  Spectrum variance = found.variance;
  if (solved_.lights.lighting.mirrors) {
    const SurfacePoint point{at.point, normal, mesh.polygon[at.patch]};
    const DirectIrradiance mirrored =
        mirrored_irradiance(solved_.lights.lighting, solved_.lights.lamps, std::span(&point, 1),
                            {.mirrored_samples = samples_of_mirrored, .seed = seed});
    record.irradiance += mirrored.irradiance.row(0);
    variance += mirrored.standard_error.row(0).square();
  }
  const Eigen::VectorXd& weights = solved_.luminous_weights;
  record.uncertainty = std::sqrt((variance.matrix() * weights.cwiseAbs2()).value());
  const double value = (record.irradiance.matrix() * weights).value();
  const double slope = (record.gradient.matrix() * weights).norm();
  const double wanted = std::min(share_of_distance * hemisphere.harmonic_mean(distances),
                                 slope > 0 ? value / slope : std::numeric_limits<double>::infinity());
  record.radius = std::clamp(wanted, least, most);
  // A record that has to serve farther than its slope is good for has none.
  if (wanted < least) record.gradient.setZero();
  for (Eigen::Index band = 0; band < record.irradiance.size(); ++band) {
    const double change = record.radius * record.gradient.col(band).matrix().norm();
    if (change > record.irradiance[band]) record.gradient.col(band) *= record.irradiance[band] / change;
  }
  return record;
}

}  // namespace patchlight
