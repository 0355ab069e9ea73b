#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/patch_keys.h"
#include "mesh/patch_lookup.h"
#include "transport/estimators.h"
#include "transport/narrow.h"
#include "transport/patch_frame.h"
#include "visibility/occluder.h"

#include <map>
#include <vector>

namespace patchlight {
namespace {

// How many rays arrived at which patch.
using Arrivals = std::map<PatchIndex, std::uint32_t>;

constexpr std::size_t rays_at_once = 4096;

struct Hemisphere {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const PatchLookup& patches;

  Arrivals arrivals(PatchIndex from, const std::vector<std::array<double, 4>>& points, std::uint32_t seed) const;
};

Arrivals Hemisphere::arrivals(PatchIndex from, const std::vector<std::array<double, 4>>& points,
                              std::uint32_t seed) const {
  const PatchCorners corners = mesh.corner_points(from);
  const Eigen::Matrix3d frame = patch_frame(mesh, from);
  Arrivals arrived;
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [u, v, s, t] = points[k];
    const Point start = square_to_quad(corners.points, u, v);
    if (!occluder.is_covered(mesh.polygon[from], mesh.side[from], start)) {
      rays.push_back({start, frame * occluder.held_direction(mesh.polygon[from], s, t), mesh.polygon[from]});
    }
    if (rays.size() < rays_at_once && k + 1 < points.size()) continue;
    for (const auto& hit : occluder.first_held_hits(rays, hash({seed, k}))) {
      const auto patch = hit ? patches.patch_at(hit->polygon, hit->side, hit->point) : std::nullopt;
      if (patch) ++arrived[*patch];
    }
    rays.clear();
  }
  return arrived;
}

}  // namespace

Assembly estimate_by_hemisphere(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                const Observer& observer) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const PatchLookup patches(mesh);
  const Hemisphere hemisphere{mesh, occluder, patches};
  std::vector<Arrivals> arrived(mesh.size());
  parallel_for(arrived.size(), Stage::form_factors, observer, [&](std::size_t i) {
    const std::uint32_t seed = hash({options.seed, keys[i], 2});
    const auto points = scrambled_sobol(static_cast<std::uint32_t>(options.samples), seed);
    arrived[i] = hemisphere.arrivals(static_cast<PatchIndex>(i), points, seed);
  });

  // S_ij = (A_i n_ij + A_j n_ji) / (2 s)
  Assembly result{ExchangeAreas(mesh.size()), {}, {}, {}};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const auto& [j, count] : arrived[i]) {
      const double before = static_cast<double>(result.exchange_areas.at(i, j));
      result.counts.facing_pairs += before == 0 ? 1 : 0;
      const double held = occluder.held_share(mesh.polygon[i], mesh.side[i]);
      const double area = before + held * mesh.area[i] * count / (2.0 * options.samples);
      result.exchange_areas.set(i, j, narrow_toward_zero(area));
    }
  }
  result.counts.shadow_rays = static_cast<std::uint64_t>(mesh.size()) * static_cast<std::uint64_t>(options.samples);
  return result;
}

}  // namespace patchlight
