#include "render/gathered_light.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "light/texture.h"
#include "lighting/direct_irradiance.h"
#include "render/camera.h"
#include "visibility/walk.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace patchlight {

Hemisphere::Hemisphere(int rays, const Vector& normal)
    : rings_(std::max(1, static_cast<int>(std::lround(std::sqrt(rays / std::numbers::pi))))),
      sectors_(std::max(3, static_cast<int>(std::lround(static_cast<double>(rays) / rings_)))),
      normal_(normal),
      first_(normal.unitOrthogonal()),
      second_(normal.cross(first_)) {}

std::size_t Hemisphere::cell(int ring, int sector) const {
  const int around = (sector + sectors_) % sectors_;
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(sectors_) + static_cast<std::size_t>(around);
}

double Hemisphere::sine(int ring) const { return std::sqrt(static_cast<double>(ring) / rings_); }

std::vector<Vector> Hemisphere::directions(std::uint32_t seed) const {
  std::vector<Vector> all;
  for (int j = 0; j < rings_; ++j) {
    for (int k = 0; k < sectors_; ++k) {
      const auto u = pixel_sample(static_cast<std::uint32_t>(cell(j, k)), seed);
      const double square = (j + u[0]) / rings_;  // sin^2
      const double angle = 2 * std::numbers::pi * (k + u[1]) / sectors_;
      const double sine_here = std::sqrt(square);
      all.push_back(sine_here * (std::cos(angle) * first_ + std::sin(angle) * second_) +
                    std::sqrt(1 - square) * normal_);
    }
  }
  return all;
}

HemisphereIrradiance Hemisphere::irradiance(const FieldView& radiosity, std::span<const double> distances) const {
  const Eigen::Index bands = radiosity.cols();
  const auto row = [&](int j, int k) { return radiosity.row(static_cast<Eigen::Index>(cell(j, k))); };
  const auto nearer = [&](int j, int k, int jj, int kk) {
    return std::min(distances[cell(j, k)], distances[cell(jj, kk)]);
  };
  HemisphereIrradiance found{radiosity.colwise().mean(), Spectrum::Zero(bands), Field::Zero(3, bands)};
  for (int k = 0; k < sectors_; ++k) {
    const double middle = 2 * std::numbers::pi * (k + 0.5) / sectors_;
    const double edge = 2 * std::numbers::pi * k / sectors_;
    const Vector outward = std::cos(middle) * first_ + std::sin(middle) * second_;
    const Vector along = -std::sin(edge) * first_ + std::cos(edge) * second_;
    Spectrum by_rings = Spectrum::Zero(bands);
    Spectrum by_sectors = Spectrum::Zero(bands);
    for (int j = 0; j < rings_; ++j) {
      // With L = B / pi
      if (j > 0) {
        const double square = sine(j) * sine(j);
        const double factor = 2 * std::numbers::pi / sectors_ * sine(j) * (1 - square) / nearer(j, k, j - 1, k);
        by_rings += factor / std::numbers::pi * (row(j, k) - row(j - 1, k));
      }
      const double width = (sine(j + 1) - sine(j)) / nearer(j, k, j, k - 1);
      by_sectors += width / std::numbers::pi * (row(j, k) - row(j, k - 1));
      // Two neighbors differ by twice the variance within a cell, and by the change of the light between them.
      found.variance += (row(j, k) - row(j, k - 1)).square() / 2;
    }
    found.gradient += (outward * by_rings.matrix() + along * by_sectors.matrix()).array();
  }
  const double count = static_cast<double>(rings_) * sectors_;
  found.variance /= count * count;
  return found;
}

double Hemisphere::harmonic_mean(std::span<const double> distances) const {
  double sum = 0;
  for (const double distance : distances) sum += 1 / distance;
  return static_cast<double>(distances.size()) / sum;
}

namespace {

// Records serve at normals up to 10 degrees from theirs: the cosine of that angle.
constexpr double widest_turn = 0.985;

// How fast radii may grow with the distance from a record.
constexpr double growth_of_radius = 0.4;

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Point& point, double cells_per_metre) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(point[axis] * cells_per_metre));
  return cell;
}

// Cells that share a key are looked at together, which costs time alone.
std::uint64_t key_of(const Cell& cell, int level) {
  std::uint64_t key = static_cast<std::uint64_t>(level) + 1024;
  for (const std::int64_t c : cell) {
    key = (key ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15U;
    key ^= key >> 29;
  }
  return key;
}

}  // namespace

double IrradianceCache::weight_of(const Reach& record, const Point& point, const Vector& normal) {
  const Vector way = point - record.point;
  const double square = way.squaredNorm();
  if (!(square < record.radius * record.radius)) return 0;
  const double cosine = normal.dot(record.normal);
  if (!(cosine > widest_turn)) return 0;
  // A table's top does not serve on the floor: 10 degrees over the radius of curved surfaces.
  if (std::abs(record.normal.dot(way)) > 0.15 * record.radius) return 0;
  const double turn = std::sqrt(std::max(0.0, 1 - cosine) / (1 - widest_turn));
  return 1 - std::max(std::sqrt(square) / record.radius, turn);
}

template <typename See>
void IrradianceCache::for_each_around(const Point& point, const Vector& normal, const See& see) const {
  for (const Level& level : levels_) {
    const auto cell = cells_.find(key_of(cell_of(point, level.cells_per_metre), level.log2_of_edge));
    if (cell == cells_.end()) continue;
    for (const std::uint32_t index : cell->second) {
      const double weight = weight_of(reaches_[index], point, normal);
      if (weight > 0) see(index, weight);
    }
  }
}

std::vector<IrradianceCache::Weighted> IrradianceCache::around(const Point& point, const Vector& normal) const {
  std::vector<Weighted> found;
  for_each_around(point, normal, [&](std::uint32_t index, double weight) { found.push_back({index, weight}); });
  return found;
}

IrradianceCache::IrradianceCache(Eigen::VectorXd luminous_weights) : luminous_weights_(std::move(luminous_weights)) {}

// Cells at least as wide as the ball of the record: it meets eight of them at most.
IrradianceCache::Level IrradianceCache::level_for(double radius) {
  const int log2_of_edge = static_cast<int>(std::ceil(std::log2(2 * radius)));
  const auto has_it = [&](const Level& level) { return level.log2_of_edge == log2_of_edge; };
  const auto known = std::find_if(levels_.begin(), levels_.end(), has_it);
  if (known != levels_.end()) return *known;
  levels_.push_back({log2_of_edge, std::ldexp(1.0, -log2_of_edge)});
  return levels_.back();
}

void IrradianceCache::add(const IrradianceRecord& record) {
  assert(record.irradiance.size() == luminous_weights_.size() && record.gradient.cols() == record.irradiance.size());
  const Level level = level_for(record.radius);
  const auto index = static_cast<std::uint32_t>(reaches_.size());
  reaches_.push_back({record.point, record.normal, record.radius, record.uncertainty});
  for (Eigen::Index band = 0; band < record.irradiance.size(); ++band) {
    values_.push_back(record.irradiance[band]);
    for (Eigen::Index axis = 0; axis < 3; ++axis) values_.push_back(record.gradient(axis, band));
  }
  const Vector reach = Vector::Constant(record.radius);
  const Cell lower = cell_of(record.point - reach, level.cells_per_metre);
  const Cell upper = cell_of(record.point + reach, level.cells_per_metre);
  for (std::int64_t x = lower[0]; x <= upper[0]; ++x)
    for (std::int64_t y = lower[1]; y <= upper[1]; ++y)
      for (std::int64_t z = lower[2]; z <= upper[2]; ++z)
        cells_[key_of({x, y, z}, level.log2_of_edge)].push_back(index);
}

void IrradianceCache::add_graded(const std::vector<IrradianceRecord>& records) {
  const std::size_t before = reaches_.size();
  for (const IrradianceRecord& record : records) add(record);
  // Cells keep records whose radius shrinks, which no longer serve there.
  for (std::size_t k = before; k < reaches_.size(); ++k) {
    Reach& record = reaches_[k];
    for (const Weighted& one : around(record.point, record.normal)) {
      Reach& other = reaches_[one.index];
      const double distance = (other.point - record.point).norm();
      other.radius = std::min(other.radius, record.radius + growth_of_radius * distance);
      record.radius = std::min(record.radius, other.radius + growth_of_radius * distance);
    }
  }
}

double IrradianceCache::weight_at(const Point& point, const Vector& normal) const {
  double sum = 0;
  for_each_around(point, normal, [&](std::uint32_t, double weight) { sum += weight; });
  return sum;
}

std::optional<CachedIrradiance> IrradianceCache::at(const Point& point, const Vector& normal) const {
  const Eigen::Index bands = luminous_weights_.size();
  CachedIrradiance found{Spectrum::Zero(bands), 0};
  double weights = 0, squares = 0, own = 0, first = 0, second = 0;
  for_each_around(point, normal, [&](std::uint32_t index, double weight) {
    // E_i + (x - x_i) . grad E_i
    const Reach& record = reaches_[index];
    const Vector way = point - record.point;
    const double* of_band = values_.data() + static_cast<std::size_t>(index) * static_cast<std::size_t>(4 * bands);
    double value = 0;
    for (Eigen::Index band = 0; band < bands; ++band, of_band += 4) {
      const double change = way.x() * of_band[1] + way.y() * of_band[2] + way.z() * of_band[3];
      const double predicted = std::max(0.0, of_band[0] + change);
      found.irradiance[band] += weight * predicted;
      value += predicted * luminous_weights_[band];
    }
    weights += weight;
    squares += weight * weight;
    own += weight * weight * record.uncertainty * record.uncertainty;
    first += weight * value;
    second += weight * value * value;
  });
  if (weights == 0) return std::nullopt;
  // The error from the scatter of the records, with the degrees of freedom of as many records of equal weight.
  const double mean = first / weights;
  const double scatter = std::max(0.0, second / weights - mean * mean);
  const double freedom = std::max(0.5, weights * weights / squares - 1);
  const double variance = own / (weights * weights) + scatter / freedom;
  found.irradiance /= weights;
  found.deviation = std::sqrt(variance);
  return found;
}

Spectrum reflectance_at(const SolvedLight& light, PatchIndex patch, const Point& point) {
  if (!light.scene) return light.reflectance.row(patch);
  const Polygon& polygon = light.scene->polygons[light.mesh.polygon[patch]];
  const TextureMap* map = texture_map_on(*light.scene, polygon, light.mesh.side[patch]);
  if (!map) return light.reflectance.row(patch);
  const TexturedReflectance& texture = *light.scene->materials[light.mesh.material[patch]].texture;
  return reflectance_at(texture, map->linear * point + map->offset).min(1);
}

bool is_plain(const SolvedLight& light, PatchIndex patch) {
  return light.occluder.optics().at(light.mesh.polygon[patch]) == nullptr;
}

const SurfaceOptics& optics_of(const SolvedLight& light) { return *light.lights.lighting().paths.optics(); }

std::optional<PatchIndex> behind(const SolvedLight& light, PatchIndex patch) {
  if (light.other_side.empty() || light.other_side[patch] == patch) return std::nullopt;
  return light.other_side[patch];
}

// A patch that a ray meets, straight or by way of clear faces and mirrors.
struct GatheredLight::Stop {
  std::size_t ray = 0;
  PatchIndex patch = 0;
  Point point = Point::Zero();
  double distance = 0;       // meters, along the path
  bool is_specular = false;  // a mirror or a clear face, or met by way of one
  Spectrum weight;           // the share of its radiosity that arrives
};

// The stops of rays, and how far each ray looks: up to the end of its path with the largest share of the light, which
// may be infinitely far.
struct GatheredLight::Stops {
  std::vector<Stop> all;
  std::vector<double> distances;
};

GatheredLight::GatheredLight(const SolvedLight& solved) : solved_(solved), lookup_(solved.mesh) {}

SkyAim GatheredLight::aim_at(PatchIndex patch) const {
  const PatchMesh& mesh = solved_.mesh;
  const PatchCorners corners = mesh.corner_points(patch);
  const Receiver receiver{
      [&](double u, double v) {
        return SurfacePoint{square_to_quad(corners.points, u, v), mesh.normal[patch], mesh.polygon[patch]};
      },
      mesh.side[patch],
      {corners.points.begin(), corners.points.begin() + corners.count}};
  return aim_at_few(sky_aim(solved_.lights.lighting(), receiver, AimFor::points), solved_.lights.lighting().openings);
}

LitPoint GatheredLight::lit_point(const PatchPoint& at, std::uint32_t sample, std::uint32_t seed, SkyAims& aims) const {
  const SkyAim* aim = nullptr;
  if (solved_.lights.lighting().sky) {
    const auto [place, is_new] = aims.try_emplace(at.patch);
    if (is_new) place->second = aim_at(at.patch);
    aim = &place->second;
  }
  return {{at.point, solved_.mesh.normal[at.patch], solved_.mesh.polygon[at.patch]}, sample, seed, aim};
}

GatheredLight::Stops GatheredLight::stops_of(std::vector<Ray> rays, std::uint64_t seed) const {
  const Occluder& occluder = solved_.occluder;
  constexpr double far = std::numeric_limits<double>::infinity();
  Stops stops{{}, std::vector<double>(rays.size(), far)};
  std::vector<double> largest(rays.size(), 0);
  const auto look = [&](const SpecularPath& path, double share, double distance) {
    if (!(share > largest[path.start])) return;
    largest[path.start] = share;
    stops.distances[path.start] = distance;
  };
  walk(occluder, optics_of(solved_), std::move(rays), {.seed = seed},
       [&](const SpecularPath& path, const std::optional<Hit>& hit) {
         const double throughput = path.throughput.mean();
         if (!hit) {
           look(path, throughput, far);
           return Continuation::ends;
         }
         const double distance = path.distance + hit->distance;
         const double profile = occluder.optics().nonspecular_profile(hit->polygon, hit->direction);
         look(path, throughput * profile * occluder.optics().nonspecular_fraction(hit->polygon, hit->side), distance);
         const bool is_specular = occluder.optics().at(hit->polygon) != nullptr;
         if (const auto patch = lookup_.patch_at(hit->polygon, hit->side, hit->point))
           stops.all.push_back({path.start, *patch, hit->point, distance, is_specular || path.reflections > 0,
                                path.throughput * profile});
         return Continuation::specular;
       });
  return stops;
}

// The radiosities that each ray finds at its stops.
Field GatheredLight::sums_of_rays(const std::vector<Stop>& stops, const Field& arriving, std::size_t rays) {
  Field sums = Field::Zero(static_cast<Eigen::Index>(rays), arriving.cols());
  for (std::size_t k = 0; k < stops.size(); ++k)
    sums.row(static_cast<Eigen::Index>(stops[k].ray)) += arriving.row(static_cast<Eigen::Index>(k));
  return sums;
}

// True if the patch is wider than the path is long, and its light follows from its irradiance alone.
bool GatheredLight::is_near(const Stop& stop) const {
  return stop.distance * stop.distance < solved_.mesh.area[stop.patch] && !stop.is_specular &&
         !behind(solved_, stop.patch) && !solved_.lights.lighting().mirrors &&
         (solved_.exitance.row(stop.patch) == 0).all();
}

// The radiosity, without exitance, that arrives from each stop.
Field GatheredLight::arriving(const std::vector<Stop>& stops, int bounces_left, std::uint32_t seed) const {
  const PatchMesh& mesh = solved_.mesh;
  const auto rows = static_cast<Eigen::Index>(stops.size());
  Field found = Field::Zero(rows, solved_.reflected.cols());
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    if (bounces_left > 0 && is_near(stops[k]))
      near.push_back(k);
    else
      found.row(static_cast<Eigen::Index>(k)) = stops[k].weight * solved_.reflected.row(stops[k].patch);
  }
  if (near.empty()) return found;

  // From the nearer ones a ray goes on, and others look for lights: rho (H_direct + H_gathered).
  std::vector<Ray> rays;
  std::vector<LitPoint> points;
  SkyAims aims;
  for (std::size_t n = 0; n < near.size(); ++n) {
    const Stop& stop = stops[near[n]];
    const PatchIndex patch = stop.patch;
    const auto sample = static_cast<std::uint32_t>(n);
    const auto u = pixel_sample(sample, hash({seed, stream::bounce_directions}));
    rays.push_back({stop.point, cosine_direction(mesh.normal[patch], u[0], u[1]), mesh.polygon[patch]});
    points.push_back(lit_point({stop.point, patch}, sample, hash({seed, stream::lights_of_bounce}), aims));
  }
  const Field direct = light_samples(solved_.lights, points, 2);
  const std::vector<Stop> next = stops_of(std::move(rays), hash({seed, stream::panes_of_bounce})).all;
  const Field onward =
      sums_of_rays(next, arriving(next, bounces_left - 1, hash({seed, stream::next_bounce})), near.size());
  for (std::size_t n = 0; n < near.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const Stop& stop = stops[near[n]];
    found.row(static_cast<Eigen::Index>(near[n])) =
        stop.weight * reflectance_at(solved_, stop.patch, stop.point) * (direct.row(row) + onward.row(row));
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
  const std::size_t count = rays.size();
  const auto [stops, distances] = stops_of(std::move(rays), hash({seed, stream::panes_of_gather}));
  const HemisphereIrradiance found =
      hemisphere.irradiance(sums_of_rays(stops, arriving(stops, options.most_bounces, seed), count), distances);

  IrradianceRecord record{at.point, normal, 0, found.irradiance, found.gradient, 0};
  Spectrum variance = found.variance;
  if (solved_.lights.lighting().mirrors) {
    const SurfacePoint point{at.point, normal, mesh.polygon[at.patch]};
    const DirectIrradiance mirrored = direct_irradiance(solved_.lights, std::span(&point, 1),
                                                        {.mirrored_samples = 2, .seed = seed, .only_in_mirrors = true});
    record.irradiance += mirrored.irradiance.row(0);
    variance += mirrored.standard_error.row(0).square();
  }
  const Eigen::VectorXd& weights = solved_.luminous_weights;
  record.uncertainty = std::sqrt((variance.matrix() * weights.cwiseAbs2()).value());
  const double value = (record.irradiance.matrix() * weights).value();
  const double slope = (record.gradient.matrix() * weights).norm();
  const double wanted = std::min(0.25 * hemisphere.harmonic_mean(distances),
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
