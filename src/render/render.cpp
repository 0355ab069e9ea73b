#include "render/render.h"

#include "base/parallel.h"
#include "mesh/patch_lookup.h"
#include "render/lens.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

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

namespace {

// Sight lines along a surface run this share of the patch's size above it.
constexpr double lift = 1e-3;

// Patches whose sight lines are traced together.
constexpr std::size_t traced_at_once = 64;

// The sight lines from a point of a patch to its corners.
void add_sight_lines(std::vector<Segment>& lines, const PatchMesh& mesh, PatchIndex patch, const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector above = lift * (corners.points[2] - corners.points[0]).norm() * mesh.normal[patch];
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

}  // namespace

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

  // Of the corners that this point cannot see, none counts; if it sees none at all, all do.
  const auto seen = corners_seen(mesh, occluder, patch, point);
  double total = 0;
  for (std::size_t k = 0; k < 4; ++k) total += seen[k] * weights[k];
  if (total > 0) {
    for (std::size_t k = 0; k < 4; ++k) weights[k] *= seen[k] / total;
  }
  return interpolate(mesh, field.at_vertices, patch, weights);
}

namespace {

constexpr int tile_edge = 32;  // pixels

// A rectangle of pixels [left, right) x [top, bottom).
struct Tile {
  int left, top, right, bottom;
  int width() const { return right - left; }
  int pixels() const { return width() * (bottom - top); }
};

std::vector<Tile> tiles_of(const RenderOptions& options) {
  std::vector<Tile> tiles;
  for (int top = 0; top < options.height; top += tile_edge) {
    for (int left = 0; left < options.width; left += tile_edge) {
      tiles.push_back(
          {left, top, std::min(left + tile_edge, options.width), std::min(top + tile_edge, options.height)});
    }
  }
  return tiles;
}

// The rays of a tile, pixel by pixel. Inside a pixel n^2 rays, one in each cell of an n x n grid and, in the canonical
// arrangement of Chiu, Shirley and Wang 1994 (Multi-Jittered Sampling), one in each of n^2 columns and rows: an upright
// edge is resolved in n^2 steps.
struct PixelRays {
  std::vector<Ray> rays;
  std::vector<std::size_t> pixels;  // of the tile, one for each ray
};

PixelRays camera_rays(const Lens& lens, const RenderOptions& options, const Tile& tile) {
  const int n = options.rays_per_pixel_edge;
  PixelRays all;
  all.rays.reserve(static_cast<std::size_t>(tile.pixels()) * static_cast<std::size_t>(n * n));
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      for (int sample = 0; sample < n * n; ++sample) {
        const int column = sample % n;
        const int row = sample / n;
        const auto ray = lens.ray(x + (column + (row + 0.5) / n) / n, y + (row + (column + 0.5) / n) / n);
        if (!ray) continue;
        all.rays.push_back(*ray);
        all.pixels.push_back(static_cast<std::size_t>((y - tile.top) * tile.width() + x - tile.left));
      }
    }
  }
  return all;
}

}  // namespace

Image render(const PatchMesh& mesh, const SmoothField& radiance, const Occluder& occluder, const Camera& camera,
             const Vector& up, const RenderOptions& options, const Observer& observer) {
  const Lens lens(camera, up, options.width, options.height);
  const PatchLookup lookup(mesh);
  const auto rays_per_edge = static_cast<std::size_t>(options.rays_per_pixel_edge);
  const std::size_t rays_per_pixel = rays_per_edge * rays_per_edge;
  Image image{options.width, options.height,
              Field::Zero(static_cast<Eigen::Index>(options.width) * options.height, radiance.at_vertices.cols()),
              Eigen::VectorXd::Zero(static_cast<Eigen::Index>(options.width) * options.height)};

  const std::vector<Tile> tiles = tiles_of(options);
  parallel_for(tiles.size(), Stage::render, observer, [&](std::size_t index) {
    const Tile& tile = tiles[index];
    const auto [rays, pixels] = camera_rays(lens, options, tile);
    for (const SeenPatch& seen : seen_by(occluder, lookup, rays, options.spheres)) {
      const int pixel = static_cast<int>(pixels[seen.ray]);
      const Eigen::Index x = tile.left + pixel % tile.width();
      const Eigen::Index y = tile.top + pixel / tile.width();
      const double share = seen.share / static_cast<double>(rays_per_pixel);
      if (seen.outlook) image.outlook[y * options.width + x] += share;
      if (seen.patch) {
        image.pixels.row(y * options.width + x) += value_at(mesh, radiance, occluder, *seen.patch, seen.point) * share;
      } else if (seen.sphere != nullptr) {
        image.pixels.row(y * options.width + x) += seen.sphere->radiance * share;
      } else if (options.surroundings) {
        image.pixels.row(y * options.width + x) += options.surroundings(seen.direction) * share;
      }
    }
  });
  return image;
}

}  // namespace patchlight
