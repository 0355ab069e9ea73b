#include "lighting/sky_coefficients.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/irradiance_in_mirrors.h"
#include "lighting/sky_irradiance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

namespace patchlight {
namespace {

// The light of one division.
struct OfDivision {
  std::size_t division = 0;
  Spectrum irradiance;
};

using Row = std::vector<OfDivision>;

// In the order of the divisions, each once.
Row joined(Row row) {
  std::stable_sort(row.begin(), row.end(),
                   [](const OfDivision& a, const OfDivision& b) { return a.division < b.division; });
  Row all;
  for (OfDivision& one : row) {
    if (!all.empty() && all.back().division == one.division)
      all.back().irradiance += one.irradiance;
    else
      all.push_back(std::move(one));
  }
  return all;
}

std::vector<SparseCoefficients> matrices_of(const std::vector<Row>& rows, std::size_t divisions, Eigen::Index bands) {
  std::size_t count = 0;
  for (const Row& row : rows) count += row.size();
  std::vector<SparseCoefficients> all;
  for (Eigen::Index band = 0; band < bands; ++band) {
    SparseCoefficients matrix(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(divisions));
    matrix.reserve(static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      matrix.startVec(static_cast<Eigen::Index>(k));
      for (const auto& [division, irradiance] : rows[k])
        matrix.insertBack(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(division)) =
            static_cast<float>(irradiance[band]);
    }
    matrix.finalize();
    all.push_back(std::move(matrix));
  }
  return all;
}

// `samples_at` returns the number of samples of a receiver, a power of two.
std::vector<SparseCoefficients> coefficients_of(const Lighting& lighting, std::size_t count,
                                                const std::function<Receiver(std::size_t)>& receiver_at,
                                                const std::function<std::uint32_t(std::size_t)>& samples_at,
                                                const SkyDivisions& divisions, const SkyCoefficientOptions& options,
                                                const Observer& observer) {
  std::uint32_t most = 1;
  for (std::size_t k = 0; k < count; ++k) most = std::max(most, samples_at(k));
  const std::vector<std::array<double, 4>> points =
      scrambled_sobol(most, hash({options.seed, stream::points_to_sky_divisions}));
  std::vector<Row> rows(count);
  parallel_for(count, Stage::direct_light, observer, [&](std::size_t k) {
    const Receiver receiver = receiver_at(k);
    const SkyAim aim = sky_aim(lighting, receiver, receiver.is_point() ? AimFor::points : AimFor::patch);
    const auto samples =
        shifted(SamplePoints(points).first(samples_at(k)), hash({options.seed, k, stream::points_to_sky_divisions}));
    const AtSky add = [&](std::size_t, const Vector& direction, const Spectrum& weight) {
      rows[k].push_back({divisions.at(direction), weight});
    };
    const SamplePoints all = samples;
    visit_sky(lighting, receiver, aim, {&all, 1}, add);
    if (lighting.mirrors) {
      const auto fewer = std::max<std::size_t>(4, samples.size() / 8);
      visit_sky_in_mirrors(lighting, receiver, SamplePoints(points).first(fewer),
                           hash({options.seed, k, stream::shift_at_receiver}), add);
    }
    rows[k] = joined(std::move(rows[k]));
  });
  return matrices_of(rows, divisions.size(), lighting.bands);
}

}  // namespace

std::vector<SparseCoefficients> sky_coefficients(const Lighting& lighting, const PatchMesh& mesh,
                                                 const SkyDivisions& divisions, const SkyCoefficientOptions& options,
                                                 const Observer& observer) {
  double mean = 0;
  for (const double area : mesh.area) mean += area / static_cast<double>(mesh.size());
  // Large patches take more rays, as in direct_irradiance().
  const auto samples = [&](std::size_t k) {
    const double times = std::exp2(std::clamp(std::round(std::log2(mesh.area[k] / mean) / 2), -2.0, 2.0));
    return std::bit_ceil(static_cast<std::uint32_t>(std::max(4.0, times * options.samples)));
  };
  return coefficients_of(
      lighting, mesh.size(), [&](std::size_t k) { return receiver_of(mesh, static_cast<PatchIndex>(k)); }, samples,
      divisions, options, observer);
}

std::vector<SparseCoefficients> sky_coefficients(const Lighting& lighting, std::span<const SurfacePoint> points,
                                                 const SkyDivisions& divisions, const SkyCoefficientOptions& options,
                                                 const Observer& observer) {
  const auto samples = [&](std::size_t) { return std::bit_ceil(static_cast<std::uint32_t>(16 * options.samples)); };
  return coefficients_of(
      lighting, points.size(), [&](std::size_t k) { return receiver_of(points[k]); }, samples, divisions, options,
      observer);
}

}  // namespace patchlight
