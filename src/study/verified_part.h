#pragma once

#include "verify/path_tracer.h"

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

}  // namespace patchlight
