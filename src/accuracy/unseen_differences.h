#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "accuracy/errors.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace patchlight {

/// Emitting patches with cumulative fluxes, to choose one with a probability roughly proportional to its flux.
struct EmitterChoice {
  std::vector<PatchIndex> emitters;  ///< in the order of the mesh
  std::vector<double> before;        ///< cumulative flux before each emitter, W; one more entry at the end

  struct Chosen {
    PatchIndex emitter;
    double probability;
    double u;  ///< the remaining random number after the choice, in [0, 1]
  };

  /// The probability of a patch; 0 if it is not an emitter. O(log(emitters)).
  double probability_of(PatchIndex patch) const;

  /// The emitter for a number in [0, 1). O(log(emitters)).
  Chosen at(double u) const;
};

/// Weighs emitters by their unoccluded flux to a patch; all have some probability. O(emitters).
EmitterChoice emitter_choice_for(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& emitters,
                                 const Field& exitance);

/// Weighs emitters by their total flux. O(emitters).
EmitterChoice choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& emitters, const Field& exitance);

class Occluder;

/// A solution on patches, and the occluder between them.
struct SolvedPatches {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const LostShare& lost;
  const SolvedProblem& solved;
};

/// The stand-in for a patch that a ray hits: the quarter that is hit, the whole patch if seen from afar, or the point
/// itself. For a point a byte stores the excess of reflected light there, as a share of the mean over the patch: -1
/// where it is dark.
inline constexpr std::uint8_t seen_as_quarter = 0;
inline constexpr std::uint8_t seen_as_whole = 1;
std::uint8_t as_point(double more);                         ///< `more` up to 4, in steps of 0.02
std::optional<double> more_at_point(std::uint8_t seen_as);  ///< nothing if it is not a point

/// The results of the rays of all quarters: patch i has the quarters 4 i to 4 i + 3 (mesh/nested_mesh.h).
struct GatheredQuarters {
  int rays = 0;                 ///< from each quarter
  Field irradiance;             ///< per quarter: mean over its exposed part, without luminaires, sun and sky, W/m^2
  std::vector<PatchIndex> met;  ///< per quarter and ray: the quarter that it hits, or no_patch
  std::vector<std::uint8_t> seen_as;  ///< likewise: seen_as_quarter, seen_as_whole, or a value of as_point()
  Eigen::ArrayXd part_of_ray;         ///< per quarter: the weight of each of its rays when averaging over its patch
  Eigen::ArrayXd exposed;             ///< per quarter: the area that no solid covers, m^2
  Eigen::ArrayXd seen;                ///< per quarter: the share of its hemisphere that patches fill
  Eigen::ArrayXd open;                ///< per quarter: the share of its hemisphere that far patches fill
};

/// The number of rays from each quarter, a power of two, and their seed.
struct RaysOfQuarters {
  int rays = 16;
  std::uint64_t seed = 1;
};

/// Gathers light at the quarters of patches from a solution on the patches: reflected light along cosine-distributed
/// rays, the light of emitters along the same number of shadow rays. The quarters of a patch use the same directions,
/// so their differences have little noise. A patch counts as seen from afar beyond eight times its longest edge, where
/// its quarters look alike. This applies if at least half of the receiver's hemisphere is open: into a niche or a slit,
/// only part of a patch may be visible.
///
/// If a patch sees another with twice its irradiance, closer than the length of that one, light is gathered again at
/// the point that was hit. Two rays and two shadow rays to emitters are combined by the balance heuristic (Veach and
/// Guibas 1995). For example, a patch of a pipe through a wall may lie on both sides of it, with equal quarters.
/// \throws Canceled.
GatheredQuarters gather_at_quarters(const SolvedPatches& patches, const RaysOfQuarters& rays, const Observer& observer);

/// Options of unseen_differences().
struct QuarterLook {
  int rays = 16;  ///< per quarter and half: hemisphere rays, and the same number towards emitters; a power of two
  std::uint64_t seed = 1;
  std::array<Field, 2> direct = {};  ///< per quarter: irradiance by luminaires, sun and sky, W/m^2, computed twice with
                                     ///< different rays; empty without these
};

/// The effects of light differences within patches. Other patches receive light from the visible part of a patch only.
/// For example, a floor close under a board is dark, however bright the mean of a patch that reaches under the board.
struct UnseenDifferences {
  Field error;  ///< of the mean irradiance of each patch, W/m^2
  Field noise;  ///< its square is the part of the square of `error` due to noise, for sums over many patches, W/m^2. It
                ///< exceeds the error if that is only noise
  Field display;  ///< root mean square difference between the irradiance at a point and the patch's mean, W/m^2
  Eigen::VectorXd effects;  ///< per patch: the contribution of its differences to the weighted squared changes by all,
                            ///< up to a factor; noise may make it negative
};

/// Computes the effects by rays. The irradiance of each quarter is gathered from the patches. Its difference from the
/// mean of its patch is gathered again along the same rays and propagated through all reflections. Differences inside
/// the quarters are extrapolated (mesh_order). All this is done twice with different rays: the product has no bias by
/// noise, and its mean over nearby patches has less noise. `weight` is that of each patch in the error. O(size) rays.
/// \throws Canceled.
UnseenDifferences unseen_differences(const SolvedPatches& patches, const TransportOperator& transport,
                                     const Eigen::VectorXd& weight, const QuarterLook& look, const Observer& observer);

}  // namespace patchlight
