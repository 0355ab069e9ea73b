#pragma once

#include "patchlight/simulate.h"

#include "verify/path_tracer.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// Irradiances, solved and traced, W/m^2: a row for each patch, room or sensor, a column for each band.
struct SolvedAndTraced {
  Field irradiance;    ///< of the solution
  Field bar;           ///< its standard error, as the solution states it
  PathEstimate paths;  ///< by path tracing
};

/// Statistics of some rows of a comparison. Per band: sums over these rows.
struct VerifiedPart {
  std::string name;  ///< of patches "inside", "outside", "of interest", "others" or "all"; else of a family
  std::vector<Eigen::Index> rows;  ///< of the comparison
  Eigen::ArrayXd dark;             ///< the number of rows without any light, solved and traced, which test nothing
  Eigen::ArrayXd chi_square;       ///< sum of deviations() squared, of the others
  Eigen::ArrayXd mean_difference;  ///< sum of the solved values over the sum of the traced ones, less 1
  Eigen::ArrayXd offset;           ///< the difference of both sums over its standard error: sigma_path^2 31/29 in
                                   ///< quadrature, and the bars as if all were of one sign
  Eigen::ArrayXd error;  ///< typical error of a row: the root of the mean square difference over that of the traced
                         ///< irradiance, with the squares of sigma_path subtracted from both
  Eigen::ArrayXd noise;  ///< root mean square of sigma_path, in the same units: by chance alone the square of `error`
                         ///< is off by that of this times sqrt(2 / rows)
  double width = 0;  ///< bars as a share of the light, worst band: ||bar|| / ||H|| of these rows, traced, or the noise
                     ///< of the sum if that is larger
};

VerifiedPart verify_part(const std::string& name, const SolvedAndTraced& compared, std::vector<Eigen::Index> rows);

/// (solved - traced) / sqrt(sigma_path^2 31/29 + bar^2): 31/29 is the variance of Student's t with path_batches - 1
/// degrees of freedom. If no path has met light, sigma_path is 3 / paths of the brightest traced irradiance, without
/// the 31/29. 0 where nothing differs.
Field deviations(const SolvedAndTraced& compared);

/// z: the same by the noise of the paths alone, (solved - traced) / sigma_path. Not a number if no two batches differ,
/// as no path has met light: the noise is unknown.
Field deviations_by_noise(const SolvedAndTraced& compared);

/// a / b per band; 0 where both are 0.
Eigen::ArrayXd ratio(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b);

/// Agreement means that a right solution would differ by so much or more with at least this probability.
inline constexpr double least_probability = 0.01;

/// A verdict is inconclusive if bars, or the noise of the mean over the paths, exceed this fraction of the light.
inline constexpr double widest_bar = 0.1;

/// The result of a comparison with path tracing.
enum class Verdict : std::uint8_t { agrees, disagrees, inconclusive };

/// "agrees", "disagrees" or "inconclusive".
const char* name_of(Verdict verdict);

/// How much path tracing a verdict rests on.
struct VerifyOptions {
  std::uint32_t paths = 4096;  ///< per patch and sensor; rounded up to path_batches times a power of two
  std::size_t checked = 64;    ///< patches, seven eighths of them in the goal region; sensors and rooms at most
  std::size_t left_out = 0;    ///< sides without patches that must be dark, chosen at random by area
  std::uint64_t seed = 1;
  std::optional<double> relative_bar = {};  ///< of sensors, in place of the standard errors of their readings
};

/// A side without patches, and the light that paths find on it if every side is simulated.
struct LeftOutSide {
  PolygonIndex polygon = 0;
  Side side = Side::front;
  Spectrum irradiance;      ///< W/m^2
  Spectrum standard_error;  ///< W/m^2
  bool is_lit = false;      ///< above three standard errors, and a thousandth of the mean of the checked patches, in a
                            ///< band: nine of 4,096 paths at least, which rounding does not let through
};

/// Rows of one kind beside the patches, which are tested together.
struct VerifiedFamily {
  std::vector<std::string> names;  ///< of the rows: "Level1 A102"; "sensor 3 of 'desk' (room.toml:12)"
  SolvedAndTraced compared;
  VerifiedPart part;  ///< all rows; "rooms" or "sensors"
};

/// Irradiances of some patches, and of rooms and sensors.
struct Verification : SolvedAndTraced {
  std::vector<PatchIndex> patches;  ///< the checked ones, in their order: the rows of the comparison
  std::vector<LeftOutSide> left_out;
  std::vector<VerifiedPart> parts;       ///< of the patches
  std::vector<VerifiedFamily> families;  ///< means of rooms, and sensors if the scene has any
  std::uint32_t first_paths = 0;  ///< per patch of a first comparison that disagreed by the noise of its paths, so that
                                  ///< these are others, and more; 0: there was none
  double probability = 0;  ///< of the least likely chi-square or offset of a part or family and band, or a larger one,
                           ///< in a right solution, times their number
  Verdict verdict = Verdict::inconclusive;  ///< disagrees below least_probability, or where a side that was left out
                                            ///< is lit; else inconclusive where a part is wider than widest_bar
};

/// A bar on the irradiance of every patch, W/m^2: `relative` of it or of the mean by area, whichever is larger, as what
/// leaks into a dark corner comes from bright patches around it; and what the solver leaves where that is known,
/// |dH_i| = |dB_i| / rho_i, for patches that reflect nothing the largest of the others.
Field irradiance_bar(const Simulation& simulation, double relative);

/// Compares a solution with path tracing in `scene`. It tests three things:
/// - Patches. The goal region is accuracy.interest if it names anything, else the enclosed spaces if there are any,
///   else everything. Patches are drawn at random in proportion to area times radiosity, a proxy of their importance.
/// - The mean irradiance of each room, from random points on all of its patches.
/// - The sensors of the scene.
/// Bars are per patch of the simulation and band, one standard deviation each. Chi-square and the common offset are
/// tested for each part and family. Too good an agreement passes. A comparison that disagrees by noise is repeated
/// once on the same rows, with 16 times as many paths, at least 8,192. Noise means: rows whose paths scatter more than
/// a fifth of their bars give most of chi-square. Paths see the scene without the lights and colors that are skipped
/// by force; they simulate every other effect. The result does not depend on the number of threads. \throws Canceled.
Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
