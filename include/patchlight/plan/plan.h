#pragma once

#include "patchlight/plan/effects.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/assemble.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// What the user asks for; what is left open the plan fills in.
struct Request {
  std::optional<double> max_edge = {};      ///< longest patch edge, metres
  std::optional<std::size_t> patches = {};  ///< or the number of kept patches
  Sides sides = Sides::automatic;
  std::optional<KeptSides> kept_sides = {};  ///< those that known form factors are of: they are taken, not chosen anew
  Solver solver = Solver::cg;
  std::optional<double> tolerance = {};   ///< the solver's relative error; left open default_tolerance, and with an
                                          ///< accuracy what that takes
  int max_iterations = 1000;              ///< after which the solver gives up
  std::optional<double> max_rows = {};    ///< or, of progressive refinement, after so many rows, as a share of all
  std::optional<double> relaxation = {};  ///< of SOR; without it estimated
  int samples = 8;                        ///< shadow rays of a pair of patches that rays decide
  std::uint64_t seed = 1;
  Estimator estimator = Estimator::automatic;
  ShortCuts short_cuts = {};            ///< of the automatic estimator
  bool close = true;                    ///< correct the form factors so that rows sum up to what is seen
  Storage storage = Storage::tiles;     ///< of form factors; with rows on demand these are not closed
  bool standard_errors = false;         ///< keep one for each entry: a quarter more memory
  bool error_bars = false;              ///< of every patch, from mesh, form factors and solver; keeps standard errors
  std::optional<double> accuracy = {};  ///< relative error of the patches' mean radiosities that is asked for: patches
                                        ///< and samples are refined until the error bars are below. `patches` and
                                        ///< `samples` are where it starts
  std::optional<double> seconds = {};   ///< refine for so long instead, or at most
  std::vector<std::string> interest = {};  ///< names of materials, objects or groups, or of a side of theirs, as
                                           ///< "room.inside" and "room.outside": the accuracy is that of their patches;
                                           ///< none: of all
  int threads = 0;                         ///< 0: all processors
  std::optional<double> memory = {};       ///< bytes that the run may take; without it 0.8 of the machine's memory
  std::vector<Effect> force = {};          ///< effects that are simulated whatever the scene is like
  std::vector<Effect> skip = {};           ///< effects that are left out; none that is forced
};

/// How a scene is going to be solved.
struct Plan {
  KeptSides sides;
  double max_edge = 0;        ///< metres
  int samples = 8;            ///< shadow rays of a pair that rays decide, more where its form factor is large
  int lost_share_rays = 256;  ///< hemisphere rays per patch
  std::uint64_t seed = 1;
  Estimator estimator = Estimator::automatic;
  ShortCuts short_cuts = {};
  bool close = true;
  Storage storage = Storage::tiles;  ///< as asked for, or on demand where the rows of the lamps are enough
  bool standard_errors = false;
  bool error_bars = false;
  std::optional<double> accuracy;
  std::optional<double> seconds;
  std::vector<std::string> interest;
  SolverOptions solver;
  std::optional<double> solver_part = {};  ///< what the solver may leave of the error of what is of interest: it is
                                           ///< asked for a smaller relative error until it does
  std::vector<Decision> decisions;
  Spectrum lamp_colour = {};  ///< of all lights, relative to their brightest band, where one band stands for all; else
                              ///< empty
  std::vector<std::string> notes;  ///< what was asked and cannot be
};

/// The solver's relative error when none is asked for.
inline constexpr double default_tolerance = 1e-6;

/// The number of patches when nothing is asked for: a few seconds' work on two cores.
inline constexpr std::size_t default_patches = 4000;

/// The number of patches that refining to an accuracy starts from: a tenth of a second's work.
inline constexpr std::size_t first_patches = 500;

/// True when patches are refined until an accuracy is reached, or time is up.
bool refines(const Request& request);

/// The sides that take part: Request::kept_sides, else those that Request::sides chooses.
KeptSides sides_for(const Scene& scene, const Request& request);

/// Fills the request's open ends from the facts of the scene. Pure.
/// \throws InputError when the scene has no lamp, or none but those that Request::skip leaves out.
Plan make_plan(const Scene& scene, const Request& request);

/// The same for a scene that need not have a lamp, without decisions about light: what form factors take.
Plan plan_form_factors(const Scene& scene, const Request& request);

/// False when the plan has decided to leave the effect out.
bool simulates(const Plan& plan, Effect effect);

/// What the plan says about form factors.
AssemblyOptions assembly_options(const Plan& plan);

}  // namespace patchlight
