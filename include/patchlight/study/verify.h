#pragma once

#include "patchlight/simulate.h"
#include "patchlight/verify/path_tracer.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Agreement means that a right solution would differ by so much or more with at least this probability.
inline constexpr double least_probability = 0.01;

struct VerifyOptions {
  std::uint32_t paths = 4096;  ///< per patch; rounded up to path_batches times a power of two
  std::size_t checked = 64;    ///< patches; all of them when there are fewer
  std::uint64_t seed = 1;
};

/// Irradiances of some patches, solved and traced: a row per patch, a column per band.
struct Verification {
  std::vector<PatchIndex> patches;  ///< those checked, in their order
  Field irradiance;                 ///< of the solution, W/m^2
  Field bar;                        ///< the standard error it is given, W/m^2
  PathEstimate paths;               ///< by path tracing
  Eigen::ArrayXd chi_square;        ///< per band: sum over patches of deviations() squared
  double probability = 0;  ///< of the worst band's chi-square or a larger one in a right solution, times the bands
  bool agrees = false;     ///< probability >= least_probability
};

/// A bar on the irradiance of every patch, W/m^2: `relative` of it or of the mean by area, whichever is larger, as what
/// leaks into a dark corner comes from bright patches around it; and what the solver leaves where that is known,
/// |dH_i| = |dB_i| / rho_i, for patches that reflect nothing the largest of the others.
Field irradiance_bar(const Simulation& simulation, double relative);

/// Compares the irradiance of randomly chosen patches, the larger the likelier, with path tracing in `scene`. Bars are
/// per patch of the simulation and band, one standard deviation each. One-sided: too good an agreement is none the less
/// one. The same bits for any number of threads. \throws Cancelled.
Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options = {}, const Observer& observer = {});

/// (solved - traced) / sqrt(sigma_path^2 31/29 + bar^2): 31/29 is the variance of Student's t with path_batches - 1
/// degrees of freedom. 0 where nothing differs.
Field deviations(const Verification& verification);

/// z: the same by the noise of the paths alone, (solved - traced) / sigma_path. Not a number where no two batches
/// differ, as then the noise is not known: no path has met light.
Field deviations_by_noise(const Verification& verification);

}  // namespace patchlight
