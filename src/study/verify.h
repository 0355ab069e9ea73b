#pragma once

#include "patchlight/simulate.h"

#include "verify/path_tracer.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// Agreement means that a right solution would differ by so much or more with at least this probability.
inline constexpr double least_probability = 0.01;

/// A verdict says nothing where bars, or what the noise of paths leaves of the mean, are a larger share of the light.
inline constexpr double widest_bar = 0.1;

/// What a comparison with path tracing says.
enum class Verdict : std::uint8_t { agrees, disagrees, inconclusive };

/// "agrees", "disagrees" or "inconclusive".
const char* name_of(Verdict verdict);

/// How much path tracing a verdict rests on.
struct VerifyOptions {
  std::uint32_t paths = 4096;  ///< per patch; rounded up to path_batches times a power of two
  std::size_t checked = 64;    ///< patches, half of them inside where there is an inside and an outside, by
                               ///< daylight as Simulation::enclosed tells, else by closed shells with openings; all
                               ///< when there are fewer
  std::size_t left_out = 0;    ///< sides without patches that must be dark, chosen at random by area
  std::uint64_t seed = 1;
};

/// A side without patches, with the light that paths find on it when every side takes part.
struct LeftOutSide {
  PolygonIndex polygon = 0;
  Side side = Side::front;
  Spectrum irradiance;      ///< W/m^2
  Spectrum standard_error;  ///< W/m^2
  bool is_lit = false;      ///< above three standard errors, and a thousandth of the mean of the checked patches, in a
                            ///< band: nine of 4,096 paths at least, which rounding does not let through
};

/// The checked patches inside, those outside, or all where nothing divides them. Per band: sums
/// over these patches.
struct VerifiedPart {
  std::string name;                ///< "inside", "outside" or "all"
  std::vector<Eigen::Index> rows;  ///< of the verification
  Eigen::ArrayXd dark;             ///< how many of them got no light, solved and traced: these test nothing
  Eigen::ArrayXd chi_square;       ///< sum of deviations() squared, of the others
  Eigen::ArrayXd mean_difference;  ///< sum of what is solved over the sum of what is traced, less 1
  Eigen::ArrayXd offset;           ///< the difference of both sums over its standard error: sigma_path^2 31/29 in
                                   ///< quadrature, and the bars as if all were of one sign
  Eigen::ArrayXd error;  ///< typical error of a patch: the root of the mean square difference over that of the traced
                         ///< irradiance, the squares of sigma_path taken out of both
  Eigen::ArrayXd noise;  ///< root mean square of sigma_path, in the same units: by chance alone the square of `error`
                         ///< is off by that of this times sqrt(2 / patches)
  double width = 0;  ///< bars as a share of the light, worst band: ||bar|| / ||H|| of the checked patches, traced, or
                     ///< of all patches of the part by area, solved, or the noise of the sum, whichever is largest
};

/// Irradiances of some patches, solved and traced: a row per patch, a column per band.
struct Verification {
  std::vector<PatchIndex> patches;  ///< those checked, in their order
  Field irradiance;                 ///< of the solution, W/m^2
  Field bar;                        ///< the standard error it is given, W/m^2
  PathEstimate paths;               ///< by path tracing
  std::vector<LeftOutSide> left_out;
  std::vector<VerifiedPart> parts;
  std::uint32_t first_paths = 0;  ///< per patch of a first comparison that disagreed by the noise of its paths, so that
                                  ///< these are others, and more; 0: there was none
  double probability = 0;  ///< of the least likely chi-square or offset of a part and band, or a larger one, in a right
                           ///< solution, times their number
  Verdict verdict = Verdict::inconclusive;  ///< disagrees below least_probability, or where a side that was left out
                                            ///< is lit; else inconclusive where a part is wider than widest_bar
};

/// A bar on the irradiance of every patch, W/m^2: `relative` of it or of the mean by area, whichever is larger, as what
/// leaks into a dark corner comes from bright patches around it; and what the solver leaves where that is known,
/// |dH_i| = |dB_i| / rho_i, for patches that reflect nothing the largest of the others.
Field irradiance_bar(const Simulation& simulation, double relative);

/// Compares the irradiance of randomly chosen patches, the larger the likelier, with path tracing in `scene`. Bars are
/// per patch of the simulation and band, one standard deviation each. Both their differences and their common offset
/// are tested. Too good an agreement is none the less one. Where they disagree and most of that is of patches whose
/// paths scatter more than their bars are, and these are fewer than 8,192, the comparison is made once more with 16
/// times as many other paths, 8,192 at least, and that one counts: the spread of few paths tells too little of light
/// that few of them meet. Paths see the scene without the lights and the colours that are skipped by force; every other
/// effect they simulate. The same bits for any number of threads. \throws Cancelled.
Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options = {}, const Observer& observer = {});

/// (solved - traced) / sqrt(sigma_path^2 31/29 + bar^2): 31/29 is the variance of Student's t with path_batches - 1
/// degrees of freedom. Where no path has met light sigma_path is 3 / paths of the brightest irradiance that was traced,
/// without the 31/29. 0 where nothing differs.
Field deviations(const Verification& verification);

/// z: the same by the noise of the paths alone, (solved - traced) / sigma_path. Not a number where no two batches
/// differ, as then the noise is not known: no path has met light.
Field deviations_by_noise(const Verification& verification);

}  // namespace patchlight
