#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/year.h"
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace patchlight {

/// Values per hour of the year (row) and sensor (column), lx.
using HourlyValues = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How finely a year is sampled.
struct AnnualOptions {
  int sky_division = 4;     ///< the factor of Reinhart's divisions of the sky: 1 to 145, 2 to 577, 4 to 2,305 parts
  int rays = 8192;          ///< per sensor over the hemisphere, for the patches that it sees
  int sky_samples = 512;    ///< directions of a patch of mean size; a sensor takes 16 times as many
  double tolerance = 1e-4;  ///< relative residual of the adjoint solutions
};

/// The time of one phase.
struct PhaseCost {
  std::string phase;
  double seconds = 0;      ///< wall time
  double cpu_seconds = 0;  ///< all threads
};

/// A year of light at the sensors of a scene.
struct AnnualLight {
  HourlyValues illuminance;                ///< by sun, sky and ground, with all reflections; not a number inside walls
  HourlyValues sunlight;                   ///< the part that comes from the sun without scattering:
                                           ///< straight, through panes and over mirrors
  Eigen::VectorXd daylight_factor;         ///< under a CIE overcast sky, by the coefficients, percent
  Eigen::VectorXd solved_daylight_factor;  ///< the same by the solution for this sky alone
  Eigen::VectorXd relative_error;  ///< standard error of the light of sky, ground and reflections, as that under the
                                   ///< overcast sky: rays, sampling, mesh and solver; common to all hours
  bool converged = true;           ///< the run under the overcast sky and all adjoint solutions
  bool is_accurate = true;         ///< the run's error is not above AccuracyOptions::relative_error
  std::size_t patches = 0;
  std::size_t sun_hours = 0;  ///< with direct sun
  std::size_t sky_hours = 0;  ///< with a sky
  std::vector<PhaseCost> costs;
  Diagnostics notes = {};     ///< of the run under the overcast sky
  Diagnostics warnings = {};  ///< on sensors at doubtful places
};

/// The illuminance at all sensors of a scene in every hour of a year, without electric light:
///
///   E_i(t) = E_sun,i(t) + sum_d D_id L_d(t) + sum_j W_ij H_sun,j(t),   D_id = D_direct,id + sum_j W_ij H_dj
///
/// E_sun and H_sun are the straight light of the sun at sensors and on patches, at the position of each hour. D_id is
/// the illuminance by luminance 1 in the division d of the sky (Tregenza and Waters 1983), 0 being the ground. W_ij is
/// what an irradiance of 1 on patch j adds at sensor i by all reflections: the solution of the adjoint equation W = g
/// (I - R F)^-1 R for the patches g that the sensor sees, as a radiosity of a scene that g lights. One run of
/// simulate() under a CIE overcast sky gives mesh, form factors and errors. O(sensors x (rays + form factors + hours x
/// sunlit patches)). \throws InputError, MemoryError, Canceled.
AnnualLight simulate_year(const Scene& scene, const Year& year, const Request& request = {},
                          const AnnualOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
