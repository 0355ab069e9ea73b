#include "render/ambient_occlusion.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "render/lens.h"

#include <vector>

namespace patchlight {
namespace {

constexpr std::uint32_t seed_of_places = 31;
constexpr std::uint32_t rays_of_pixel = 32;
constexpr double plain_reflectance = 0.02;  // what is darker would hide its shape

// From a place, as far as the distance.
Segment short_ray(const Point& from, const Vector& normal, PolygonIndex polygon, double distance,
                  const std::array<double, 2>& u) {
  return {from, from + distance * cosine_direction(normal, u[0], u[1]), polygon, no_polygon};
}

}  // namespace

Eigen::VectorXd ambient_occlusion(const PatchMesh& mesh, const Occluder& occluder, double distance,
                                  std::uint32_t rays) {
  Eigen::VectorXd free = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size()));
  const auto samples = scrambled_sobol(rays, seed_of_places);
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
        const auto u = pixel_sample(k, hash({static_cast<std::uint64_t>(pixel), seed_of_places}));
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
      image.pixels.row(of_pixel[of_segment[n]]) += material.reflectance.max(plain_reflectance) / rays_of_pixel;
    }
  });
  return image;
}

}  // namespace patchlight
