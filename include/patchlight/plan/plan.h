#pragma once

#include "patchlight/plan/effects.h"
#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/assemble.h"

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// How a scene is cut into patches, and which sides of its polygons are included.
struct MeshOptions {
  std::optional<double> max_edge = {};  ///< longest patch edge, meters
  /// The number of kept patches, instead of max_edge. Default: default_patches, or first_patches where patches are
  /// refined.
  std::optional<std::size_t> patches = {};
  Sides sides = Sides::automatic;
  /// Patches end where faces touch, cross or nearly touch, and at the edges of hard shadows.
  bool contact_lines = true;
  std::optional<std::size_t> contact_line_count = {};  ///< the number of lines, longest first; default: as many as fit
  bool graded_edges = false;                 ///< patches of grids get smaller towards edges where lit faces meet
  std::optional<KeptSides> kept_sides = {};  ///< the sides of given form factors, which are used as they are
};

/// The accuracy that a run aims at.
struct AccuracyOptions {
  bool error_bars = false;  ///< error bars of every patch, by mesh, form factors and solver; keeps standard errors
  /// Error bars where they take less than half of the run. Reflected light by rows of rays has them in any case; this
  /// adds up to 5,000 patches in pairs, and scenes with sensors.
  bool cheap_error_bars = false;
  bool local_cuts = false;  ///< with rows of rays and no relative_error: a second mesh, with patches split and rays
                            ///< doubled where the error is largest. Made if that removes a third of an error above 2 %.
                            ///< Not if Steps give a mesh, form factors or a solver
  /// The relative error of the patches' mean radiosities. Patches and samples are refined until the error bars are
  /// below it, starting from the requested mesh and samples.
  std::optional<double> relative_error = {};
  std::optional<double> seconds = {};  ///< time limit of the refinement, alone or beside relative_error
  /// Names of materials, objects or groups, or of one of their sides, e.g. "room.inside" and "room.outside". The error
  /// is that of their patches; empty: of all patches.
  std::vector<std::string> interest = {};
  /// The largest part of the error of the patches of interest that may come from the solver. The solver's relative
  /// error is reduced until this holds. Default: chosen, unless the request sets the solver's relative error.
  std::optional<double> solver_part = {};
};

/// The resources that a run may use.
struct Resources {
  int threads = 0;                    ///< 0: all processors
  std::optional<double> memory = {};  ///< bytes; default: 0.8 of the machine's memory
};

/// The user's request. The plan fills in the parts that are left open.
struct Request {
  MeshOptions mesh = {};
  AssemblyOptions assembly = {};
  EffectOptions effects = {};
  SolverOptions solver = {};  ///< with an accuracy, an open relative error follows from it
  AccuracyOptions accuracy = {};
  Resources resources = {};
};

struct Coverings;
struct Goal;

/// The plan of a solve: the parts of the request with nothing left open, and the decisions in place of mesh and
/// effects.
struct Plan {
  KeptSides sides;
  std::shared_ptr<const Coverings> coverings = {};  ///< kept sides that lie over others; null: none
  ContactLines contacts;                            ///< lines where patches end, besides the outlines of their polygons
  bool graded_edges = false;                        ///< as asked for
  double max_edge = 0;                              ///< meters; by daylight that of the enclosed spaces
  std::shared_ptr<const Goal> goal = {};            ///< the surfaces of interest; null: all, each by its area
  std::size_t patches_around = 0;                   ///< patches of the surroundings of the goal
  AssemblyOptions assembly;  ///< with the requested storage, else pairs, rays or rows of the lamps
  SolverOptions solver;      ///< each mesh on the way to an accuracy has its own relative error
  AccuracyOptions accuracy;  ///< with error bars where patches are refined
  Resources resources;
  std::vector<Decision> decisions;
  /// The spectrum of all lights, relative to their brightest band, if one band stands for all; else empty.
  Spectrum lamp_colour = {};
  Diagnostics notes;  ///< the parts of the request that are impossible
};

/// The parts of a run that are given, so that they need not be computed.
struct Given {
  bool form_factors = false;
  bool ray_rows = false;  ///< form factors as rows of rays
  bool mesh = false;
  bool solver = false;
};

/// The default relative error of the solver for rows of `rays` rays: about a tenth of the sampling error of the rows.
/// docs/benchmarks/real-models.md.
inline double default_ray_tolerance(int rays) { return 4e-3 / std::sqrt(rays); }

/// The default number of patches.
inline constexpr std::size_t default_patches = 4000;

/// The number of patches at the start of a refinement to an accuracy.
inline constexpr std::size_t first_patches = 500;

/// True when patches are refined until an accuracy is reached, or time is up.
bool refines(const AccuracyOptions& accuracy);

/// True when the patches get error bars: when the request has them, or when they guide the refinement.
bool has_error_bars(const AccuracyOptions& accuracy);

/// The initial number of patches, if no edge length sets the size of patches.
std::size_t patches_asked(const Request& request);

/// The included sides: MeshOptions::kept_sides, or those that MeshOptions::sides chooses.
KeptSides sides_for(const Scene& scene, const Request& request);

/// Fills in the open parts of the request from the facts of the scene. Given form factors are a matrix, even where the
/// rows of the lamps would be enough. Pure, except that the machine's memory matters where Resources::memory is open.
/// \throws InputError when the scene has no lamp, or when EffectOptions::skip excludes all lamps.
Plan make_plan(const Scene& scene, const Request& request, const Given& given = {});

/// The plan of a form-factor computation: no decisions about light, and the scene needs no lamp.
Plan plan_form_factors(const Scene& scene, const Request& request);

/// False when the plan has decided to leave the effect out.
bool simulates(const Plan& plan, Effect effect);

}  // namespace patchlight
