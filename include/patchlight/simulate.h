#pragma once

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/solve/problem.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/exchange.h"
#include "patchlight/transport/transport_operator.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The time of one stage.
struct StageCost {
  Stage stage = Stage::read;
  double seconds = 0;      ///< wall time
  double cpu_seconds = 0;  ///< all threads
};

/// Facts about the form factors before and after closure.
struct TransportFacts {
  Eigen::VectorXd raw_row_sum;  ///< sum_j F_ij before closure; empty with rows on demand
  Eigen::VectorXd row_sum;      ///< after; empty as well
  LostShare lost;
  AssemblyCounts counts;            ///< zero with rows on demand
  double bare_rays_per_second = 0;  ///< shadow rays alone between patches that face each other, on all threads; 0 when
                                    ///< few rays were traced, or with error bars
  std::string closure;              ///< which method closed the rows
};

/// One mesh of a run that refines, with its errors. Errors are relative: the error of the radiosity in the norm of the
/// areas as a share of the reflected radiosity, ||dB||_A / ||B - E||_A, of the worst band.
struct AccuracyStep {
  PatchIndex patches = 0;
  PatchIndex new_patches = 0;  ///< those not in the mesh before
  int samples = 0;             ///< per pair; with Storage::rays the mean number per patch, doubled ones included
  double mesh = 0;
  double form_factor = 0;
  double solver = 0;
  double total = 0;    ///< the three in quadrature
  double display = 0;  ///< of the radiosity at the points of patches, which are drawn with their means
  double seconds = 0;  ///< since the start
  double cpu_seconds = 0;
  bool inside = false;  ///< of Simulation::enclosed alone: the default by daylight
};

/// The relative errors of the patches inside, or outside, each as a share of the light that these patches reflect.
struct SpaceErrors {
  std::string space;    ///< "inside" or "outside"
  AccuracyStep errors;  ///< with the number of patches; no seconds
};

/// The light between patches, H = F B, as a run has solved it in some bands: for views that need its adjoint. Areas are
/// those for which F is reciprocal, the part of each patch that holds light from all directions alike.
struct SolvedTransport {
  std::vector<Eigen::Index> bands;                 ///< columns of RadiosityProblem that it is for
  std::shared_ptr<const TransportOperator> light;  ///< F
  Scattering scattering;                           ///< R of these bands
  Eigen::VectorXd area;                            ///< m^2
};

struct RayExchange;
struct RayOptions;
struct RowBlocks;
class World;

/// A solved scene.
struct Simulation {
  Plan plan;
  PatchMesh mesh;
  TransportFacts transport;
  RadiosityProblem problem;
  Solution solution;
  EnergyBalance balance;
  std::optional<ErrorBars> error_bars;   ///< when asked for
  std::vector<AccuracyStep> accuracy;    ///< with error bars: every mesh, the last one is this one
  std::vector<SpaceErrors> spaces = {};  ///< with error bars, where there is an inside and an outside among the
                                         ///< patches: by daylight the enclosed and the others, else as closed shells
                                         ///< with openings divide the patches of interest; else empty
  Eigen::VectorXd enclosed = {};         ///< by daylight 1 for each patch of a space that keeps most of its light,
                                         ///< e.g. a room with windows, else 0; empty without sky and sun
  std::vector<StageCost> costs;
  Diagnostics notes = {};            ///< of the plan, and on doubtful places of the scene
  Field direct_standard_error = {};  ///< of RadiosityProblem::direct_irradiance, W/m^2; empty with it
  Field ray_standard_error = {};  ///< of the irradiance by Storage::rays, W/m^2, by sampling alone: without the errors
                                  ///< of mesh and solver; else empty
  std::vector<Field> correlated_errors = {};  ///< equally likely draws of the sampling error of the irradiance that
                                              ///< patches have in common, W/m^2: their mean square is part of the
                                              ///< square of the sampling error. Sums over many patches need them, as
                                              ///< in a room the level of the light is common to all. Empty where none
                                              ///< are known
  bool unfinished = false;                    ///< stopped by the observer, with Steps::keeps_unfinished
  std::vector<SolvedTransport> transports = {};  ///< with Steps::keeps_transport, one for each color that panes and
                                                 ///< mirrors distinguish
  std::shared_ptr<const World> world = {};       ///< the scene with its rays and lights, which views share; never
                                                 ///< null after simulate()
};

/// The exchange between the patches of a mesh where it is known already.
using ExchangeOf = std::function<Exchange(const PatchMesh& mesh)>;

/// Rows of rays between the patches of a mesh where they are known already.
using RayExchangeOf = std::function<RayExchange(const PatchMesh& mesh)>;

/// Where rows of rays are kept while they are traced, for a run that is stopped to go on there.
using RowBlocksOf =
    std::function<RowBlocks(const PatchMesh& mesh, const RayOptions& options, std::span<const float> bright_densities)>;

/// The mesh where it is known already.
using MeshOf = std::function<PatchMesh()>;

/// A solver; solve() is one.
using SolveWith = std::function<Solution(const RowTransport& transport, const RadiosityProblem& problem,
                                         const SolverOptions& options, const Observer& observer)>;

/// Called with every mesh of a run that refines or has AccuracyOptions::local_cuts.
using LookAt = std::function<void(const Simulation& simulation)>;

/// Steps of simulate() that a caller may replace.
struct Steps {
  ExchangeOf exchange = {};         ///< empty: form factors are computed
  RayExchangeOf ray_exchange = {};  ///< with Storage::rays, without error bars of the mesh; empty: rays are traced
  RowBlocksOf row_blocks = {};      ///< with Storage::rays; empty: nothing is kept
  SolveWith solve = {};             ///< empty: patchlight::solve()
  LookAt look = {};
  MeshOf mesh = {};  ///< without error bars; empty: the scene is tessellated
  /// If set, a run that the observer stops returns its last solved mesh, or else the last iterate of its solver, with
  /// Simulation::unfinished. Without either it throws Canceled. Called when there is a first result to return, and
  /// after each better one.
  std::function<void()> keeps_unfinished = {};
  bool keeps_transport = false;  ///< fills Simulation::transports
};

/// From a scene to converged radiosities: the whole program.
/// \throws InputError, MemoryError, Canceled, and the exceptions of the steps.
Simulation simulate(const Scene& scene, const Request& request = {}, const Observer& observer = {},
                    const Steps& with = {});

/// The same without a copy of the scene, which Simulation::world keeps.
Simulation simulate(std::shared_ptr<const Scene> scene, const Request& request = {}, const Observer& observer = {},
                    const Steps& with = {});

}  // namespace patchlight
