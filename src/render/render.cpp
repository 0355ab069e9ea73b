#include "render/render.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/light_source.h"
#include "visibility/walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

struct MetLuminaire {
  const SeenLuminaire* luminaire = nullptr;
  double distance = std::numeric_limits<double>::infinity();
};

// 1 for width, length and height of a shape that are axes of its ellipse, 0 for those along which it is straight.
Vector round_axes(OpeningShape shape) {
  if (shape == OpeningShape::upright_cylinder) return {1, 1, 0};
  if (shape == OpeningShape::cylinder_by_length) return {1, 0, 1};
  if (shape == OpeningShape::cylinder_by_width) return {0, 1, 1};
  return shape == OpeningShape::ellipsoid ? Vector::Ones() : Vector::Zero();
}

// The distance at which a ray enters a shape; infinity if it does not, below 0 from the inside.
double entry(const Ray& ray, const SeenLuminaire& luminaire) {
  const Vector from = luminaire.to_unit * (ray.origin - luminaire.centre), way = luminaire.to_unit * ray.direction;
  const Vector round = round_axes(luminaire.shape);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double enter = -infinity, leave = infinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (round[axis] != 0) continue;
    const double a = (-1 - from[axis]) / way[axis], b = (1 - from[axis]) / way[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (round.any()) {
    // |o + t d| = 1 across the straight axis
    const Vector o = from.cwiseProduct(round), d = way.cwiseProduct(round);
    const double square = std::max(d.squaredNorm(), std::numeric_limits<double>::min());
    const double nearest = -o.dot(d) / square;
    const double root = (1 - (o + nearest * d).squaredNorm()) / square;
    if (!(root > 0)) return infinity;
    enter = std::max(enter, nearest - std::sqrt(root));
    leave = std::min(leave, nearest + std::sqrt(root));
  }
  return enter < leave ? enter : infinity;
}

// The nearest one on the way of a ray that shines back along it.
MetLuminaire met_by(const Ray& ray, const std::vector<SeenLuminaire>& luminaires) {
  MetLuminaire met;
  for (const SeenLuminaire& luminaire : luminaires) {
    const Vector way = luminaire.centre - ray.origin;
    if (way.cross(ray.direction).squaredNorm() > luminaire.reach * luminaire.reach) continue;
    const double distance = entry(ray, luminaire);
    if (distance > 0 && distance < met.distance && (luminaire.radiance(-ray.direction) > 0).any())
      met = {&luminaire, distance};
  }
  return met;
}

SeenLuminaire seen_sphere(const Luminaire& luminaire, const SphericalLamp& lamp) {
  return {luminaire.position, lamp.radius, OpeningShape::ellipsoid, Eigen::Matrix3d::Identity() / lamp.radius,
          [radiance = Spectrum(lamp.exitance / std::numbers::pi)](const Vector&) { return radiance; }};
}

SeenLuminaire seen_opening(const Luminaire& luminaire, const std::shared_ptr<const PhotometricWeb>& web,
                           const Vector& up) {
  constexpr double least = 1e-9;  // m, of a flat opening: its rim is as good as never met
  const LuminaireFrame frame{luminaire.aim, luminaire.zero_plane};
  Eigen::Matrix3d axes;
  axes << frame.zero_plane.cross(frame.aim), frame.zero_plane, frame.aim;
  const Vector half = web->opening.cwiseMax(least) / 2;
  const auto radiance = [luminaire, web, frame, up](const Vector& direction) -> Spectrum {
    // E at 1 m is I
    const LightSample arrival =
        LightSource(luminaire, up).sample({luminaire.position + direction, -direction}, Eigen::Vector2d::Zero());
    const double area = projected_opening(*web, frame, direction);
    return *arrival.color * (area > 0 ? arrival.irradiance / area : 0);
  };
  return {luminaire.position, half.norm(), web->shape, half.cwiseInverse().asDiagonal() * axes.transpose(), radiance};
}

// Patches whose sight lines are traced together.
constexpr std::size_t traced_at_once = 64;

// The sight lines from a point of a patch to its corners, a thousandth of its size above it.
void add_sight_lines(std::vector<Segment>& lines, const PatchMesh& mesh, PatchIndex patch, const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector above = 1e-3 * (corners.points[2] - corners.points[0]).norm() * mesh.normal[patch];
  const PolygonIndex own = mesh.polygon[patch];
  for (std::size_t k = 0; k < static_cast<std::size_t>(corners.count); ++k)
    lines.push_back({point + above, corners.points[k] + above, own, own});
}

// Which corners of a patch can be seen from a point of it, 1 or 0 each.
std::array<double, 4> corners_seen(const PatchMesh& mesh, const Occluder& occluder, PatchIndex patch,
                                   const Point& point) {
  std::vector<Segment> lines;
  add_sight_lines(lines, mesh, patch, point);
  const auto blocked = occluder.occluded(lines);
  std::array<double, 4> seen{};
  for (std::size_t k = 0; k < blocked.size(); ++k) seen[k] = blocked[k] ? 0 : 1;
  return seen;
}

// Per corner the area of its patch where the centroid sees it, else 0.
CornerWeights weights_of_seen(const PatchMesh& mesh, const Eigen::VectorXd& area, const Occluder& occluder) {
  CornerWeights weights = CornerWeights::Zero(mesh.size(), 4);
  parallel_for((mesh.size() + traced_at_once - 1) / traced_at_once, [&](std::size_t task) {
    const auto first = static_cast<PatchIndex>(task * traced_at_once);
    const auto last = static_cast<PatchIndex>(std::min<std::size_t>(mesh.size(), first + traced_at_once));
    std::vector<Segment> lines;
    for (PatchIndex patch = first; patch < last; ++patch) add_sight_lines(lines, mesh, patch, mesh.centroid[patch]);
    const auto blocked = occluder.occluded(lines);
    std::size_t line = 0;
    for (PatchIndex patch = first; patch < last; ++patch) {
      for (Eigen::Index k = 0; k < mesh.corner_points(patch).count; ++k, ++line)
        weights(patch, k) = blocked[line] ? 0 : area[patch];
    }
  });
  return weights;
}

// A vertex that no patch sees takes all of them.
CornerWeights with_every_vertex(const PatchMesh& mesh, CornerWeights weights, const Eigen::VectorXd& area) {
  std::vector<double> total(mesh.vertices.size(), 0);
  const auto count = [&](PatchIndex patch) { return mesh.corner_points(patch).count; };
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    for (int k = 0; k < count(patch); ++k) total[mesh.corners[patch][static_cast<std::size_t>(k)]] += weights(patch, k);
  }
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    for (int k = 0; k < count(patch); ++k) {
      if (total[mesh.corners[patch][static_cast<std::size_t>(k)]] == 0) weights(patch, k) = area[patch];
    }
  }
  return weights;
}

struct PixelRays {
  std::vector<Ray> rays;
  std::vector<Eigen::Index> pixels;  // one for each ray, as keys
  std::vector<std::uint64_t> keys;
};

// The rays of a tile, pixel by pixel. A pixel has n^2 rays, one in each cell of an n x n grid. In the canonical
// arrangement of Chiu, Shirley and Wang 1994 (Multi-Jittered Sampling), there is also one in each of n^2 columns and
// rows. So n^2 steps resolve an upright edge.
PixelRays camera_rays(const Lens& lens, const RenderOptions& options, const PixelTile& tile) {
  const int n = options.rays_per_pixel_edge;
  PixelRays all;
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      for (int sample = 0; sample < n * n; ++sample) {
        const int column = sample % n;
        const int row = sample / n;
        const auto ray = lens.ray(x + (column + (row + 0.5) / n) / n, y + (row + (column + 0.5) / n) / n);
        if (!ray) continue;
        all.rays.push_back(*ray);
        all.pixels.push_back(static_cast<Eigen::Index>(y) * options.width + x);
        all.keys.push_back(static_cast<std::uint64_t>(all.pixels.back() * n * n + sample));
      }
    }
  }
  return all;
}

constexpr std::uint32_t rays_of_pixel = 32;

// From a place, as far as the distance.
Segment short_ray(const Point& from, const Vector& normal, PolygonIndex polygon, double distance,
                  const std::array<double, 2>& u) {
  return {from, from + distance * cosine_direction(normal, u[0], u[1]), polygon, no_polygon};
}

}  // namespace

std::vector<SeenLuminaire> seen_luminaires(const std::vector<Luminaire>& luminaires, const Vector& up) {
  std::vector<SeenLuminaire> all;
  for (const Luminaire& luminaire : luminaires) {
    if (const auto* const lamp = std::get_if<SphericalLamp>(&luminaire.light))
      all.push_back(seen_sphere(luminaire, *lamp));
    else if (const auto* const light = std::get_if<WebLight>(&luminaire.light))
      all.push_back(seen_opening(luminaire, light->web, up));
  }
  return all;
}

std::vector<SeenPatch> seen_by(const Occluder& occluder, const SurfaceOptics& optics, const PatchLookup& lookup,
                               const std::vector<Ray>& rays, std::span<const std::uint64_t> keys,
                               const std::vector<SeenLuminaire>& luminaires) {
  std::vector<SeenPatch> all;
  walk(occluder, optics, rays, {.min_throughput = 0.01, .keys = keys},
       [&](const SpecularPath& path, const std::optional<Hit>& hit) {
         SeenPatch seen{.ray = path.start, .direction = path.ray.direction, .share = path.throughput};
         seen.outlook = path.crossings > 0;
         const MetLuminaire met = met_by(path.ray, luminaires);
         if (met.luminaire && (!hit || met.distance < hit->distance)) {
           seen.point = path.ray.origin + met.distance * seen.direction;
           seen.distance = path.distance + met.distance;
           seen.luminaire = met.luminaire;
           all.push_back(seen);
           return Continuation::ends;
         }
         if (!hit) {
           seen.outlook = true;
           seen.distance = std::numeric_limits<double>::infinity();
           all.push_back(seen);
           return Continuation::ends;
         }
         seen.patch = lookup.patch_at(hit->polygon, hit->side, hit->point);
         if (!seen.patch) return optics.is_clear(hit->polygon) ? Continuation::specular : Continuation::straight;
         seen.point = hit->point;
         seen.distance = path.distance + hit->distance;
         seen.share *= occluder.optics().nonspecular_profile(hit->polygon, hit->direction);
         all.push_back(seen);
         return Continuation::specular;
       });
  return all;
}

SmoothField smooth(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area,
                   const Occluder& occluder) {
  CornerWeights weights = weights_of_seen(mesh, area, occluder);
  const CornerWeights complete = with_every_vertex(mesh, weights, area);
  return {vertex_means(mesh, patch_values, complete), std::move(weights)};
}

Eigen::Array<double, 1, Eigen::Dynamic> value_at(const PatchMesh& mesh, const SmoothField& field,
                                                 const Occluder& occluder, PatchIndex patch, const Point& point) {
  std::array<double, 4> weights = interpolation_weights(mesh, patch, point);
  const bool divided = (field.weights.row(patch).head(mesh.corner_points(patch).count) == 0).any();
  if (!divided) return interpolate(mesh, field.at_vertices, patch, weights);

  // Only corners that this point sees count; if it sees none, all count.
  const auto seen = corners_seen(mesh, occluder, patch, point);
  double total = 0;
  for (std::size_t k = 0; k < 4; ++k) total += seen[k] * weights[k];
  if (total > 0) {
    for (std::size_t k = 0; k < 4; ++k) weights[k] *= seen[k] / total;
  }
  return interpolate(mesh, field.at_vertices, patch, weights);
}

std::vector<PixelTile> tiles_of(int width, int height) {
  const int edge = 32;
  std::vector<PixelTile> tiles;
  for (int top = 0; top < height; top += edge)
    for (int left = 0; left < width; left += edge)
      tiles.push_back({left, top, std::min(left + edge, width), std::min(top + edge, height)});
  return tiles;
}

Image render(const PatchMesh& mesh, const SmoothField& radiance, const Occluder& occluder, const SurfaceOptics& optics,
             const Camera& camera, const Vector& up, const RenderOptions& options, const Observer& observer) {
  const Lens lens(camera, up, options.width, options.height);
  const PatchLookup lookup(mesh);
  const double rays_per_pixel = options.rays_per_pixel_edge * options.rays_per_pixel_edge;
  const Eigen::Index count = static_cast<Eigen::Index>(options.width) * options.height;
  Image image{options.width, options.height, Field::Zero(count, radiance.at_vertices.cols()),
              Eigen::VectorXd::Zero(count)};

  const std::vector<PixelTile> tiles = tiles_of(options.width, options.height);
  parallel_for(tiles.size(), Stage::render, observer, [&](std::size_t index) {
    const auto [rays, pixels, keys] = camera_rays(lens, options, tiles[index]);
    for (const SeenPatch& seen : seen_by(occluder, optics, lookup, rays, keys, options.luminaires)) {
      const Eigen::Index pixel = pixels[seen.ray];
      const Spectrum share = seen.share / rays_per_pixel;
      if (seen.outlook) image.outlook[pixel] += share.mean();
      if (seen.patch)
        image.pixels.row(pixel) += value_at(mesh, radiance, occluder, *seen.patch, seen.point) * share;
      else if (seen.luminaire != nullptr)
        image.pixels.row(pixel) += seen.luminaire->radiance(-seen.direction) * share;
      else if (options.surroundings)
        image.pixels.row(pixel) += options.surroundings(seen.direction) * share;
    }
  });
  return image;
}

Eigen::VectorXd ambient_occlusion(const PatchMesh& mesh, const Occluder& occluder, double distance,
                                  std::uint32_t rays) {
  Eigen::VectorXd free = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size()));
  const auto samples = scrambled_sobol(rays, stream::ambient_occlusion);
  parallel_for(mesh.size(), [&](std::size_t k) {
    const auto patch = static_cast<PatchIndex>(k);
    const PatchCorners corners = mesh.corner_points(patch);
    std::vector<Segment> segments;
    for (const auto& [u, v, s, t] : samples)
      segments.push_back(
          short_ray(square_to_quad(corners.points, u, v), mesh.normal[patch], mesh.polygon[patch], distance, {s, t}));
    double count = 0;
    for (const std::uint8_t blocked : occluder.occluded(segments)) count += blocked == 0 ? 1 : 0;
    free[static_cast<Eigen::Index>(k)] = count / rays;
  });
  return free;
}

Image ambient_image(const Scene& scene, const Occluder& occluder, const Lens& lens, int width, int height,
                    double distance) {
  const Eigen::Index pixels = static_cast<Eigen::Index>(width) * height;
  Image image{width, height, Field::Zero(pixels, number_of_bands(scene)), Eigen::VectorXd::Zero(pixels)};
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    std::vector<Ray> rays;
    std::vector<Eigen::Index> of_pixel;
    std::vector<std::array<double, 2>> numbers;
    for (int x = 0; x < width; ++x) {
      const Eigen::Index pixel = static_cast<Eigen::Index>(y) * width + x;
      for (std::uint32_t k = 0; k < rays_of_pixel; ++k) {
        const auto u = pixel_sample(k, hash({static_cast<std::uint64_t>(pixel), stream::ambient_occlusion}));
        const auto ray = lens.ray(x + 0.5 + tent(u[0]), static_cast<double>(y) + 0.5 + tent(u[1]));
        if (!ray) continue;
        rays.push_back(*ray);
        of_pixel.push_back(pixel);
        numbers.push_back({u[2], u[3]});
      }
    }
    const auto hits = occluder.first_hits(rays);
    std::vector<Segment> segments;
    std::vector<std::size_t> of_segment;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      if (!hits[k]) {
        image.outlook[of_pixel[k]] += 1.0 / rays_of_pixel;
        continue;
      }
      const Hit& hit = *hits[k];
      const Vector normal = (hit.side == Side::front ? 1 : -1) * front_normal(scene, hit.polygon);
      segments.push_back(short_ray(hit.point, normal, hit.polygon, distance, numbers[k]));
      of_segment.push_back(k);
    }
    const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
    for (std::size_t n = 0; n < segments.size(); ++n) {
      if (blocked[n] != 0) continue;
      const Hit& hit = *hits[of_segment[n]];
      const Material& material = scene.materials[material_on(scene.polygons[hit.polygon], hit.side)];
      // A darker surface would hide its shape.
      image.pixels.row(of_pixel[of_segment[n]]) += material.reflectance.max(0.02) / rays_of_pixel;
    }
  });
  return image;
}

}  // namespace patchlight
