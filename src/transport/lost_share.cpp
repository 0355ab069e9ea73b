#include "patchlight/transport/lost_share.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"

#include <vector>

namespace patchlight {
namespace {

// A ray that meets nothing may have slipped through the crack where two polygons meet without sharing vertices: it
// counts as escaped only if it also meets nothing when moved by this share of the scene's extent.
constexpr double crack_width = 1e-5;

struct LostRays {
  int escaped = 0;
  int at_backs = 0;
};

std::vector<Ray> hemisphere_rays(const PatchMesh& mesh, PatchIndex patch, int count, std::uint64_t seed) {
  const auto samples = scrambled_sobol(static_cast<std::uint32_t>(count), hash({seed, patch, 0x6c6f7374}));
  const PatchCorners corners = mesh.corner_points(patch);
  const Eigen::Matrix3d frame = frame_around(mesh.normal[patch]);
  std::vector<Ray> rays;
  rays.reserve(samples.size());
  for (const auto& [u, v, s, t] : samples) {
    rays.push_back(
        {square_to_quad(corners.points, u, v), frame * square_to_cosine_hemisphere(s, t), mesh.polygon[patch]});
  }
  return rays;
}

LostRays count_lost(const PatchMesh& mesh, const Occluder& occluder, const std::vector<Ray>& rays, double extent) {
  LostRays lost;
  std::vector<Ray> second_tries;
  const auto meets_back = [&](const Hit& hit) {
    const PatchRange range = mesh.patches_on(hit.polygon, hit.side);
    return range.begin == range.end;
  };
  const auto hits = occluder.first_hits(rays);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (hits[k]) {
      lost.at_backs += meets_back(*hits[k]);
    } else {
      Ray moved = rays[k];
      moved.origin += crack_width * extent * frame_around(moved.direction) * Vector(0.6, 0.8, 0);
      second_tries.push_back(moved);
    }
  }
  for (const auto& hit : occluder.first_hits(second_tries)) {
    if (!hit) ++lost.escaped;
  }
  return lost;
}

}  // namespace

LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, int rays_per_patch, std::uint64_t seed,
                             const Observer& observer) {
  Box box;
  for (const Point& vertex : mesh.vertices) box.extend(vertex);
  const double extent = box.diagonal().norm();

  LostShare lost{Eigen::VectorXd::Zero(mesh.size()), Eigen::VectorXd::Zero(mesh.size()), rays_per_patch};
  parallel_for(mesh.size(), Stage::form_factors, observer, [&](std::size_t patch) {
    const auto i = static_cast<PatchIndex>(patch);
    const LostRays count = count_lost(mesh, occluder, hemisphere_rays(mesh, i, rays_per_patch, seed), extent);
    lost.escaped[i] = static_cast<double>(count.escaped) / rays_per_patch;
    lost.at_backs[i] = static_cast<double>(count.at_backs) / rays_per_patch;
  });
  return lost;
}

}  // namespace patchlight
