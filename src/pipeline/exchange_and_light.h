#pragma once

#include "lighting/direct_irradiance.h"
#include "pipeline/problem_of.h"
#include "pipeline/run.h"
#include "transport/lamp_factors.h"
#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Patches and lamps above this multiple of the mean exitance are bright. Measured; anything from 2 to 16 does.
inline constexpr double bright = 4;

/// The lamps whose light is found apart from rows of rays, the strongest first: sides of polygons that emit more than
/// `bright` times the mean over all patches, as many as are 16 triangles and convex quadrilaterals, and 64 where there
/// are mirrors, in which rays over the hemisphere would find the others by luck.
std::vector<LampSide> lamps_apart(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem,
                                  const Tracing& tracing);

/// Rows of rays, and the light of lamps, which is found apart from them: few rays of a row meet a small bright source,
/// and smoothing would blur its shadows.
struct RayLight {
  LitProblem lit;                      ///< the problem as lit_problem() has it: with all that patches emit
  std::vector<std::uint8_t> is_apart;  ///< per patch: what it emits counts in by_lamps, not in rows
  std::array<Field, 2> by_lamps;       ///< irradiance straight from them, by both halves of the samples, W/m^2
  Field lamp_standard_error;           ///< of its mean, W/m^2
  DirectIrradiance in_mirrors;  ///< what the same lamps send over mirrors and clear faces; empty where there are none
  std::vector<float> distance;  ///< as TracedRows has it
  std::vector<std::uint8_t> is_missed;  ///< per patch: bright, but known rows have sent no ray there on purpose
  double rays_per_patch = 0;            ///< mean number over the hemisphere
  std::optional<DirectIrradiance> as_found = {};  ///< of luminaires, sun and sky, over whole patches, where the next
                                                  ///< mesh may take it over
};

/// Rows as they were traced, of the geometry alone, and the light that goes with them, as means over whole patches.
struct ExchangeAndLight {
  RayExchange exchange;
  RayLight light;
};

/// With lamps_apart(): light that all surfaces emit alike, and the light of many lamps, stays in the rows, which send
/// rays towards bright patches on purpose. By Steps::ray_exchange where it is given; lamps that it does not know are
/// found apart as well, by shadow rays. \throws Cancelled; InputError when these are too many.
ExchangeAndLight exchange_and_light(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known = {});

/// The same in some of its bands, by the run `part` that has no others: rows are the same, the light that lamps send
/// straight through clear faces is computed again.
ExchangeAndLight in_colour(const ExchangeAndLight& all, const std::vector<Eigen::Index>& bands, const Run& part,
                           const Plan& plan, const PatchMesh& mesh);

/// The exitance of patches without lamps apart, W/m^2.
Field emitted_in_rows(const RayLight& light);

/// The irradiance by light that comes from no patch of the rows, W/m^2.
Field direct_of(const RayLight& light);

}  // namespace patchlight
