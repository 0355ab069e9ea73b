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

/// Emitting patches, to be chosen by about the flux that they send somewhere.
struct ChoiceOfLamps {
  std::vector<PatchIndex> lamps;  ///< in the order of the mesh
  std::vector<double> before;     ///< the flux of those before each, W; one more entry at the end

  struct Chosen {
    PatchIndex lamp;
    double probability;
    double u;  ///< the rest of the number after the choice, in [0, 1]
  };

  /// That of a patch to be chosen; 0 where it is none of them. O(log(lamps)).
  double probability_of(PatchIndex patch) const;

  /// The one that belongs to this number of [0, 1). O(log(lamps)).
  Chosen at(double u) const;
};

/// By their flux to a patch when nothing is in the way; all have some probability. O(lamps).
ChoiceOfLamps choice_of_lamps(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& lamps,
                              const Field& exitance);

/// By their whole flux. O(lamps).
ChoiceOfLamps choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& lamps, const Field& exitance);

class Occluder;

/// A solution on patches, and the occluder between them.
struct SolvedPatches {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const LostShare& lost;
  const SolvedProblem& solved;
};

/// What stands for a patch that a ray meets: the quarter that is met, the patch as it is seen from afar, or the point
/// itself, of which a byte says how much more is reflected there, as a share of the mean over the patch: -1 where it is
/// dark.
inline constexpr std::uint8_t seen_as_quarter = 0;
inline constexpr std::uint8_t seen_as_whole = 1;
std::uint8_t as_point(double more);                         ///< `more` up to 4, in steps of 0.02
std::optional<double> more_at_point(std::uint8_t seen_as);  ///< nothing where it is no point that counts

/// The results of the rays of all quarters: patch i has the quarters 4 i to 4 i + 3 (mesh/small_patches.h).
struct GatheredQuarters {
  int rays = 0;      ///< from each quarter
  Field irradiance;  ///< per quarter: mean over the exposed part of it, without luminaires, sun and sky, W/m^2
  std::vector<PatchIndex> met;        ///< per quarter and ray: the quarter that it meets, or no_patch
  std::vector<std::uint8_t> seen_as;  ///< likewise: seen_as_quarter, seen_as_whole, or as_point() says
  Eigen::ArrayXd part_of_ray;         ///< per quarter: what part of the mean over its patch one of its rays is
  Eigen::ArrayXd exposed;             ///< per quarter: the area that no solid covers, m^2
  Eigen::ArrayXd seen;                ///< per quarter: the share of its hemisphere in which there are patches
  Eigen::ArrayXd open;                ///< per quarter: the share of it in which there are patches, but none near
};

/// How many rays start at each quarter, a power of two, and the seed that chooses them.
struct RaysOfQuarters {
  int rays = 16;
  std::uint64_t seed = 1;
};

/// Gathers light at the quarters of patches from a solution on the patches: along cosine-distributed rays what is
/// reflected, along as many shadow rays what lamps emit. The quarters of a patch take the same directions, so that
/// little noise is in their differences. A patch is seen from afar where it is farther away than eight times its
/// longest edge, so that its quarters look alike, from patches half of whose hemisphere at least is open: into a niche
/// or a slit only a part of it may be seen. Where a patch meets one of twice its irradiance, closer than that one is
/// long, light is gathered once more at the point that is met, by two rays and two to lamps, put together by the
/// balance heuristic (Veach and Guibas 1995): of a pipe that runs through a wall a patch may lie on both sides, its
/// quarters alike. \throws Cancelled.
GatheredQuarters gather_at_quarters(const SolvedPatches& patches, const RaysOfQuarters& rays, const Observer& observer);

/// How the quarters of patches are looked at.
struct QuarterLook {
  int rays = 16;  ///< from each over the hemisphere, and as many towards lamps, in each half; a power of two
  std::uint64_t seed = 1;
  std::array<Field, 2> direct = {};  ///< per quarter: irradiance by luminaires, sun and sky, W/m^2, found twice with
                                     ///< other rays; empty without these
};

/// The differences behind the means of patches: light that differs inside a patch gets to others from the part that
/// they see. Under a board close over a floor it is dark, however bright the mean of a patch that reaches under it.
struct UnseenDifferences {
  Field error;  ///< of the mean irradiance of each patch, W/m^2
  Field noise;  ///< of which the square is what noise adds to that of the error, as far as sums over many patches tell,
                ///< W/m^2: more than the error where nothing but noise is known
  Field display;            ///< how far the irradiance at a point of a patch is from its mean, root mean square, W/m^2
  Eigen::VectorXd effects;  ///< per patch: the part of its differences in the weighted squares of what all change, to
                            ///< a factor; noise may make it negative
};

/// Found by rays: the irradiance of each quarter is gathered from the patches, its difference from the mean of its
/// patch is gathered again along the same rays, and that is followed through all reflections. Differences inside
/// the quarters are extrapolated (mesh_order). All this twice, with other rays: the product of the two has no bias by
/// their noise, and its mean over the patches around has less of it. `weight` is that of each patch in the error.
/// O(size) rays. \throws Cancelled.
UnseenDifferences unseen_differences(const SolvedPatches& patches, const TransportOperator& transport,
                                     const Eigen::VectorXd& weight, const QuarterLook& look, const Observer& observer);

}  // namespace patchlight
