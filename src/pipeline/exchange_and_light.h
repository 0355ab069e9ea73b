#pragma once

#include "lighting/direct_irradiance.h"
#include "pipeline/problem_of.h"
#include "pipeline/run.h"
#include "transport/emitter_factors.h"
#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Emitters above this multiple of the mean exitance are sampled explicitly. Measured: 2 to 16 cost the same
/// time for the same accuracy.
inline constexpr double explicit_emitter_ratio = 4;

/// Selects the sides of polygons that are sampled explicitly, strongest first, up to a number of triangles and convex
/// quadrilaterals. Rays find the light of the others.
std::vector<EmitterSide> select_emitters(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem,
                                         std::size_t max_pieces);

/// The number of pieces beside rows of rays, and at sensors: 16, or 64 with mirrors, in which rays rarely find
/// emitters.
std::size_t max_emitter_pieces(const Tracing& tracing);

/// The light that goes with rows of rays. The light of emitters is computed separately: few rays of a row meet a small
/// bright source, and smoothing would blur its shadows.
struct RayLight {
  LitProblem lit;                      ///< the problem of lit_problem(), with the full exitance
  std::vector<std::uint8_t> is_apart;  ///< per patch: 1 if its exitance counts in by_emitters, not in rows
  std::array<Field, 2> by_emitters;    ///< direct irradiance by separate emitters, by both halves of the samples, W/m^2
  Field emitter_standard_error;        ///< of its mean, W/m^2
  /// Irradiance by the same emitters over mirrors and clear faces; empty where there are none.
  DirectIrradiance in_mirrors;
  std::vector<float> distance;          ///< TracedRows::distance
  std::vector<std::uint8_t> is_missed;  ///< per patch: 1 if it is bright and known rows did not sample it directly
  double rays_per_patch = 0;            ///< mean number over the hemisphere
  /// The irradiance by luminaires, sun and sky, over whole patches, if the next mesh may reuse it.
  std::optional<DirectIrradiance> as_found = {};
};

/// Rows as traced, which depend on geometry only, and the light that goes with them, as means over whole patches.
struct ExchangeAndLight {
  RayExchange exchange;
  RayLight light;
};

/// Traces rows and computes the light of select_emitters(). Light that all surfaces emit alike, and the light of many
/// emitters, stays in the rows, which also sample bright patches directly. Uses Steps::ray_exchange if given; emitters
/// that it does not know are sampled by shadow rays. \throws Canceled; InputError when these are too many.
ExchangeAndLight exchange_and_light(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known = {});

/// Some of the bands of a field, which may be empty.
Field columns_of(const Field& all, const std::vector<Eigen::Index>& bands);

/// The same in some of the bands, by the run `part` that has only these. Rows are the same; the light that emitters
/// send straight through clear faces is computed again.
ExchangeAndLight in_colour(const ExchangeAndLight& all, const std::vector<Eigen::Index>& bands, const Run& part,
                           const Plan& plan, const PatchMesh& mesh);

/// The exitance of patches without the separate emitters, W/m^2.
Field emitted_in_rows(const RayLight& light);

/// The irradiance by all light outside the rows, W/m^2.
Field direct_of(const RayLight& light);

}  // namespace patchlight
