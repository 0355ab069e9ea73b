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

/// How a scene is cut into patches, and which sides of its polygons take part.
struct MeshOptions {
  std::optional<double> max_edge = {};      ///< longest patch edge, metres
  std::optional<std::size_t> patches = {};  ///< or the number of kept patches; left open default_patches, and where
                                            ///< patches are refined first_patches
  Sides sides = Sides::automatic;
  bool contact_lines = true;  ///< patches end where faces touch, cross or end close before them, and at
                              ///< the edges of hard shadows
  std::optional<std::size_t> contact_line_count = {};  ///< so many of the longest; left open those that fit
  bool graded_edges = false;                           ///< patches of grids shrink towards edges where lit faces meet
  std::optional<KeptSides> kept_sides = {};  ///< those that known form factors are of: they are taken, not chosen anew
};

/// How far the answer may be off.
struct AccuracyOptions {
  bool error_bars = false;        ///< of every patch, from mesh, form factors and solver; keeps standard errors
  bool cheap_error_bars = false;  ///< error bars where they take less than half of the run: the plan has them of
                                  ///< reflected light by rows of rays anyway, and with this by up to 5,000 patches in
                                  ///< pairs, or with sensors
  bool local_cuts = false;  ///< by rows of rays without an accuracy: a second mesh, with patches cut and their rays
                            ///< doubled where they err most, where that takes away a third of an error above 2 %.
                            ///< Not where Steps give mesh, form factors
                            ///< or a solver
  std::optional<double> relative_error = {};  ///< of the patches' mean radiosities: patches and samples are refined
                                              ///< until the error bars are below; the mesh and the samples that are
                                              ///< asked for are where it starts
  std::optional<double> seconds = {};         ///< refine for so long instead, or at most
  std::vector<std::string> interest = {};     ///< names of materials, objects or groups, or of a side of theirs, as
                                              ///< "room.inside" and "room.outside": the error is that of their patches;
                                              ///< none: of all
  std::optional<double> solver_part = {};     ///< what the solver may leave of the error of what is of interest: it is
                                              ///< asked for a smaller relative error until it does. Left open: chosen
                                              ///< where the solver's relative error is
};

/// What of the machine a run may take.
struct Resources {
  int threads = 0;                    ///< 0: all processors
  std::optional<double> memory = {};  ///< bytes; without it 0.8 of the machine's memory
};

/// What the user asks for; what is left open the plan fills in.
struct Request {
  MeshOptions mesh = {};
  AssemblyOptions assembly = {};
  EffectOptions effects = {};
  SolverOptions solver = {};  ///< with an accuracy a relative error that is left open is what that takes
  AccuracyOptions accuracy = {};
  Resources resources = {};
};

struct Coverings;
struct Goal;

/// How a scene is going to be solved: the parts of the request with nothing left open, and what was decided in place of
/// mesh and effects.
struct Plan {
  KeptSides sides;
  std::shared_ptr<const Coverings> coverings = {};  ///< kept sides that lie over others; null: none
  ContactLines contacts;                            ///< where patches end besides the outlines of their polygons
  bool graded_edges = false;                        ///< as asked for
  double max_edge = 0;                              ///< metres; by daylight of the enclosed spaces
  std::shared_ptr<const Goal> goal = {};            ///< the surfaces that the run is about; null: all, each by its area
  std::size_t patches_around = 0;                   ///< patches of the surroundings of the goal
  AssemblyOptions assembly;                         ///< stored as asked for, else as pairs, rays or rows of the lamps
  SolverOptions solver;                             ///< of a mesh on the way to an accuracy: its own relative error
  AccuracyOptions accuracy;                         ///< with error bars where patches are refined
  Resources resources;
  std::vector<Decision> decisions;
  Spectrum lamp_colour = {};  ///< of all lights, relative to their brightest band, where one band stands for all; else
                              ///< empty
  Diagnostics notes;          ///< what was asked and cannot be
};

/// What of a run is given, so that it is not found anew.
struct Given {
  bool form_factors = false;
  bool ray_rows = false;  ///< form factors as rows of rays
  bool mesh = false;
  bool solver = false;
};

/// The solver's relative error when none is asked for and rows are of so many rays: about a tenth of what they
/// err, docs/benchmarks/real-models.md.
inline double default_ray_tolerance(int rays) { return 4e-3 / std::sqrt(rays); }

/// The number of patches when nothing is asked for: a few seconds' work on two cores.
inline constexpr std::size_t default_patches = 4000;

/// The number of patches that refining to an accuracy starts from: a tenth of a second's work.
inline constexpr std::size_t first_patches = 500;

/// True when patches are refined until an accuracy is reached, or time is up.
bool refines(const AccuracyOptions& accuracy);

/// True when the patches get error bars: when these are wanted, or patches are refined by them.
bool has_error_bars(const AccuracyOptions& accuracy);

/// The number of patches to begin with, where no edge says how finely faces are cut.
std::size_t patches_asked(const Request& request);

/// The sides that take part: MeshOptions::kept_sides, else those that MeshOptions::sides chooses.
KeptSides sides_for(const Scene& scene, const Request& request);

/// Fills the request's open ends from the facts of the scene. Form factors that are given are a matrix, even where the
/// rows of the lamps would do. Pure, but for what the machine's memory decides where Resources::memory is open.
/// \throws InputError when the scene has no lamp, or none but those that EffectOptions::skip leaves out.
Plan make_plan(const Scene& scene, const Request& request, const Given& given = {});

/// The same for a scene that need not have a lamp, without decisions about light: what form factors take.
Plan plan_form_factors(const Scene& scene, const Request& request);

/// False when the plan has decided to leave the effect out.
bool simulates(const Plan& plan, Effect effect);

}  // namespace patchlight
