#include "render/render.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/patch_lookup.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

constexpr int tile_edge = 32;       // pixels
constexpr int most_crossings = 64;  // sides without patches that one ray may pass

// The picture plane at distance 1 before the eye: the direction through (u, v) is forward + u right + v up.
struct PicturePlane {
  Point eye;
  Vector forward, right, up;
  double half_height;
};

PicturePlane picture_plane(const Camera& camera, const Vector& up) {
  const double angle = camera.vertical_field_of_view;
  if (!(angle > 0 && angle < 180)) {
    throw InputError(
        "camera", "the field of view is " + std::to_string(angle) + " degrees; expected more than 0 and less than 180");
  }
  const Vector sight = camera.target - camera.eye;
  if (!(sight.norm() > 0) || !sight.allFinite()) {
    throw InputError("camera", "there is no direction from eye to target; expected two different points");
  }
  const Vector forward = sight.normalized();
  // Looking straight up or down, any direction may be upward in the picture.
  Vector right = forward.cross(up.normalized());
  if (!(right.norm() > 1e-9)) right = forward.unitOrthogonal();
  right.normalize();
  return {camera.eye, forward, right, right.cross(forward), std::tan(angle * std::numbers::pi / 360)};
}

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
std::vector<Ray> camera_rays(const PicturePlane& plane, const RenderOptions& options, const Tile& tile) {
  const int n = options.rays_per_pixel_edge;
  const double pixel_edge = 2 * plane.half_height / options.height;
  std::vector<Ray> rays;
  rays.reserve(static_cast<std::size_t>(tile.pixels()) * static_cast<std::size_t>(n * n));
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x) {
      for (int sample = 0; sample < n * n; ++sample) {
        const int column = sample % n;
        const int row = sample / n;
        const double across = x + (column + (row + 0.5) / n) / n - 0.5 * options.width;
        const double down = y + (row + (column + 0.5) / n) / n - 0.5 * options.height;
        const Vector direction = plane.forward + across * pixel_edge * plane.right - down * pixel_edge * plane.up;
        rays.push_back({plane.eye, direction.normalized()});
      }
    }
  }
  return rays;
}

// A patch that a ray sees, behind clear faces or not; none where it meets nothing.
struct Seen {
  std::size_t ray = 0;
  std::optional<PatchIndex> patch;
  Point point;  // on the patch
  Vector direction;
  double share = 1;      // of its light that gets through what is before it
  bool outlook = false;  // behind a clear face, or nothing is met
};

// Of what a ray sees over several mirrors less than this is left out.
constexpr double least_share = 0.01;

// Rays that are still under way.
struct UnderWay {
  std::vector<Ray> rays;
  std::vector<std::size_t> of_ray;  // where each has begun
  std::vector<double> shares;
  std::vector<std::uint8_t> is_through;  // 1 behind a clear face

  void add(const Ray& ray, std::size_t begun, double share, bool through) {
    rays.push_back(ray);
    of_ray.push_back(begun);
    shares.push_back(share);
    is_through.push_back(through ? 1 : 0);
  }
};

// What rays see: the first patch that each meets and, as long as that is clear or a mirror, what is behind it and in
// it. Rays pass sides without patches: they go on from there.
std::vector<Seen> seen_by(const Occluder& occluder, const PatchLookup& lookup, std::vector<Ray> rays) {
  std::vector<Seen> seen;
  UnderWay now;
  for (std::size_t k = 0; k < rays.size(); ++k) now.add(rays[k], k, 1, false);
  for (int crossing = 0; crossing <= most_crossings && !now.rays.empty(); ++crossing) {
    const std::vector<std::optional<Hit>> hits = occluder.first_hits(now.rays);
    UnderWay next;
    for (std::size_t k = 0; k < now.rays.size(); ++k) {
      const std::optional<Hit>& hit = hits[k];
      const std::size_t begun = now.of_ray[k];
      const double share = now.shares[k];
      const bool through = now.is_through[k] != 0;
      if (!hit) {
        seen.push_back({begun, {}, {}, now.rays[k].direction, share, true});
        continue;
      }
      const auto patch = lookup.patch_at(hit->polygon, hit->side, hit->point);
      const Vector& direction = hit->direction;
      if (!patch) {
        next.add({hit->point, direction, hit->polygon}, begun, share, through);
        continue;
      }
      seen.push_back(
          {begun, *patch, hit->point, direction, share * occluder.relative_held(hit->polygon, direction), through});
      const double onward = share * occluder.transmittance(hit->polygon, direction);
      if (onward > 0) next.add({hit->point, direction, hit->polygon}, begun, onward, true);
      const double reflected = share * occluder.specular_reflectance(hit->polygon, direction);
      if (reflected > least_share)
        next.add({hit->point, occluder.mirrored(hit->polygon, direction), hit->polygon}, begun, reflected, through);
    }
    now = std::move(next);
  }
  return seen;
}

}  // namespace

Image render(const PatchMesh& mesh, const SmoothField& radiance, const Occluder& occluder, const Camera& camera,
             const Vector& up, const RenderOptions& options, const Observer& observer) {
  const PicturePlane plane = picture_plane(camera, up);
  const PatchLookup lookup(mesh);
  const auto rays_per_edge = static_cast<std::size_t>(options.rays_per_pixel_edge);
  const std::size_t rays_per_pixel = rays_per_edge * rays_per_edge;
  Image image{options.width, options.height,
              Field::Zero(static_cast<Eigen::Index>(options.width) * options.height, radiance.at_vertices.cols()),
              Eigen::VectorXd::Zero(static_cast<Eigen::Index>(options.width) * options.height)};

  const std::vector<Tile> tiles = tiles_of(options);
  parallel_for(tiles.size(), Stage::render, observer, [&](std::size_t index) {
    const Tile& tile = tiles[index];
    for (const Seen& seen : seen_by(occluder, lookup, camera_rays(plane, options, tile))) {
      const int pixel = static_cast<int>(seen.ray / rays_per_pixel);
      const Eigen::Index x = tile.left + pixel % tile.width();
      const Eigen::Index y = tile.top + pixel / tile.width();
      const double share = seen.share / static_cast<double>(rays_per_pixel);
      if (seen.outlook) image.outlook[y * options.width + x] += share;
      if (seen.patch) {
        image.pixels.row(y * options.width + x) += value_at(mesh, radiance, occluder, *seen.patch, seen.point) * share;
      } else if (options.surroundings) {
        image.pixels.row(y * options.width + x) += options.surroundings(seen.direction) * share;
      }
    }
  });
  return image;
}

}  // namespace patchlight
