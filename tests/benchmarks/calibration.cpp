#include "benchmarks/calibration.h"

#include "base/sampling.h"
#include "form_factor/contour.h"
#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>

namespace patchlight::benchmarks {
namespace {

constexpr double drawn_pairs = 2000;
constexpr std::uint32_t rays_per_pair = 256;

void add(Spread& spread, double z) {
  ++spread.pairs;
  spread.within += std::abs(z) <= 1.96 ? 1 : 0;
  spread.rms_z += z * z;
  spread.mean_z += z;
}

// From sums to means.
Spread mean(Spread spread) {
  const double pairs = std::max(1.0, spread.pairs);
  return {spread.pairs, spread.within / pairs, std::sqrt(spread.rms_z / pairs), spread.mean_z / pairs};
}

struct TracedRays {
  std::size_t free = 0;
  std::size_t blocked = 0;
};

TracedRays traced_rays(const Room& room, const Occluder& occluder, PatchIndex i, PatchIndex j) {
  std::vector<Segment> segments;
  const PatchCorners from = room.mesh.corner_points(i);
  const PatchCorners to = room.mesh.corner_points(j);
  for (const auto& u : scrambled_sobol(rays_per_pair, hash({i, j}))) {
    const Point x = square_to_quad(from.points, u[0], u[1]);
    const Point y = square_to_quad(to.points, u[2], u[3]);
    // Where one lies behind the other's plane no light goes.
    if (room.mesh.normal[i].dot(y - x) <= 0 || room.mesh.normal[j].dot(x - y) <= 0) continue;
    segments.push_back({x, y, room.mesh.polygon[i], room.mesh.polygon[j]});
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  const auto count = static_cast<std::size_t>(std::count(blocked.begin(), blocked.end(), 1));
  return {segments.size() - count, count};
}

}  // namespace

PartialPairs partial_pairs(const std::vector<SampledEntry>& sampled, const Assembly& assembly,
                           const ExchangeAreas& reference) {
  PartialPairs result;
  for (const SampledEntry& entry : sampled) {
    if (!entry.is_partial || entry.unoccluded <= 0) continue;
    const double found = assembly.exchange_areas.at(entry.first, entry.second);
    const double share = found / entry.unoccluded;
    const double error = found - reference.at(entry.first, entry.second);
    const double z = error / assembly.entry_errors.standard_error(entry.first, entry.second);
    const double bin = std::clamp(share * SamplingError::bins, 0.0, SamplingError::bins - 1.0);
    add(result.all, z);
    add(result.bins[static_cast<std::size_t>(bin)], z);
  }
  result.all = mean(result.all);
  for (Spread& bin : result.bins) bin = mean(bin);
  return result;
}

UnanimousPairs unanimous_pairs(const std::vector<SampledEntry>& sampled, const Assembly& assembly,
                               const ExchangeAreas& reference, bool visible) {
  const SamplingError::Unanimous& audit = visible ? assembly.error.visible : assembly.error.occluded;
  UnanimousPairs result;
  result.bound = bound_on_miss(audit);
  result.audited_rate = static_cast<double>(audit.missed) / std::max(1.0, static_cast<double>(audit.pairs()));
  for (const SampledEntry& entry : sampled) {
    const double found = assembly.exchange_areas.at(entry.first, entry.second);
    if (entry.is_partial || (found > 0) != visible) continue;
    const double exact = reference.at(entry.first, entry.second);
    const double unoccluded = std::max(entry.unoccluded, exact);
    ++result.pairs;
    result.within += std::abs(found - exact) <= result.bound * unoccluded ? 1 : 0;
    result.rate += std::abs(found - exact) > 1e-6 * unoccluded ? 1 : 0;
  }
  result.within /= std::max(1.0, result.pairs);
  result.rate /= std::max(1.0, result.pairs);
  return result;
}

DecidedPairs decided_pairs(const Room& room, const Assembly& assembly) {
  const PatchMesh& mesh = room.mesh;
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const Occluder occluder(room.scene);
  DecidedPairs result;
  for (std::uint32_t draw = 0; draw < 4000000; ++draw) {
    if (result.free >= drawn_pairs && result.hidden >= drawn_pairs) break;
    const PatchIndex a = hash({draw, 0}) % mesh.size();
    const PatchIndex b = hash({draw, 1}) % mesh.size();
    const PatchIndex i = std::min(a, b);
    const PatchIndex j = std::max(a, b);
    if (mesh.polygon[i] == mesh.polygon[j] || assembly.entry_errors.kind(i, j) != EntryKind::exact) continue;
    if (orientation(shapes[i], shapes[j]) == Orientation::averted) continue;
    const double found = assembly.exchange_areas.at(i, j);
    if (found > 0 && result.free < drawn_pairs) {
      const double exact = contour_exchange_area(shapes[i].corners, shapes[j].corners);
      ++result.free;
      result.free_wrong += traced_rays(room, occluder, i, j).blocked > 0 ? 1 : 0;
      result.free_error = std::max(result.free_error, std::abs(found / exact - 1));
    }
    if (found == 0 && result.hidden < drawn_pairs) {
      ++result.hidden;
      result.hidden_wrong += traced_rays(room, occluder, i, j).free > 0 ? 1 : 0;
    }
  }
  return result;
}

}  // namespace patchlight::benchmarks
