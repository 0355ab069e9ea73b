#include "render/render.h"

#include "base/parallel.h"
#include "mesh/patch_lookup.h"
#include "render/lens.h"
#include "render/seen.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace patchlight {
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
