#include "pipeline/needed_light.h"

#include "solve/scattering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patchlight {
namespace {

// What each RayLight has of light and its errors, some of it without a value.
std::array<const Field*, 7> fields_of(const RayLight& light) {
  return {&light.lit.problem.exitance,     &light.by_lamps[0],           &light.by_lamps[1],
          &light.lamp_standard_error,      &light.in_mirrors.irradiance, &light.in_mirrors.standard_error,
          &light.lit.direct_standard_error};
}

// Is each band of a field the factor times the one from which it is said to follow? But for some rounding.
bool follows(const Field& field, const SolvedBands& bands) {
  constexpr double tolerance = 16 * std::numeric_limits<double>::epsilon();
  for (Eigen::Index i = 0; i < field.rows(); ++i) {
    for (Eigen::Index band = 0; band < field.cols(); ++band) {
      const auto& [from, factor] = bands.sources[static_cast<std::size_t>(band)];
      const double expected = factor * field(i, bands.solved[static_cast<std::size_t>(from)]);
      if (!(std::abs(field(i, band) - expected) <= tolerance * expected)) return false;
    }
  }
  return true;
}

// Bands differ by a factor where all that shines does.
SolvedBands needed_bands(const RayLight& light, const SolverOptions& options) {
  const RadiosityProblem& all = light.lit.problem;
  if (options.every_band || options.reference) return all_bands(all);
  const Field& direct = all.direct_irradiance;
  SolvedBands bands =
      solved_bands({all.scattering, direct.size() > 0 ? Field(all.exitance + direct) : all.exitance, all.area, {}});
  const auto fields = fields_of(light);
  const bool all_follow = follows(direct, bands) && std::all_of(fields.begin(), fields.end(), [&](const Field* field) {
                            return follows(*field, bands);
                          });
  return all_follow ? bands : all_bands(all);
}

Field squares_in(const SolvedBands& bands, const Field& error) { return reduced(error, bands).square(); }

}  // namespace

NeededLight needed_light(const RayLight& light, const SolverOptions& options) {
  const RadiosityProblem& all = light.lit.problem;
  NeededLight needed{.bands = needed_bands(light, options), .problem = {}, .of_lamps = {}, .of_others = {}};
  const SolvedBands& bands = needed.bands;
  needed.problem = {of_bands(all.scattering, bands.solved), reduced(emitted_in_rows(light), bands), all.area,
                    reduced(direct_of(light), bands)};
  needed.of_lamps = squares_in(bands, light.lamp_standard_error);
  for (const Field* error : {&light.lit.direct_standard_error, &light.in_mirrors.standard_error}) {
    if (error->size() == 0) continue;
    if (needed.of_others.size() == 0) needed.of_others = Field::Zero(error->rows(), needed.of_lamps.cols());
    needed.of_others += squares_in(bands, *error);
  }
  return needed;
}

}  // namespace patchlight
