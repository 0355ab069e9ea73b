#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// The options that say how a model is solved. The values land in a request, which must outlive the command.
namespace patchlight::cli {

/// A request while it is being parsed: lengths are in model units, unless they have a unit of their own.
struct RequestGiven : Request {
  bool max_edge_in_metres = false;
};

/// The request that has been parsed, in metres.
Request in_metres(const RequestGiven& given, double metres_per_unit);

/// Adds --sides.
void add_sides_option(CLI::App& command, Request& request);

/// The value of --sides. \throws UsageError for an unknown word.
Sides sides_named(const std::string& text);

/// Adds --max-edge, --patches and --no-contact-lines.
void add_patch_options(CLI::App& command, RequestGiven& request);

/// --graded-edges: not where meshes are halved from one to the next.
void add_graded_option(CLI::App& command, Request& request);

/// Adds --accuracy, --time-limit, --focus and --no-refine.
void add_refinement_options(CLI::App& command, Request& request);

/// The same, --error-bars and --no-error-bars; without either of these there are cheap ones.
void add_accuracy_options(CLI::App& command, Request& request);

/// The note about --accuracy at the beginning of a run, in percent; nothing without it.
std::optional<std::string> note_on_accuracy(const Request& request);

/// Adds --method and --rays.
void add_method_options(CLI::App& command, Request& request);

/// The same for form factors that are stored: pairs or rays.
void add_stored_method_options(CLI::App& command, Request& request);

/// Where no solver is given, one that fits the method; where one is that the ray method does not serve, the pair method
/// unless another method is given.
Request with_fitting_solver(Request request, bool solver_given);

/// Adds --no-closure.
void add_closure_option(CLI::App& command, Request& request);

/// Adds --relaxation, which lands in `relaxation`.
void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation);

/// Adds --tolerance, from `least` (0: above 0) to below 1, which is handed to `take`.
void add_tolerance_option(CLI::App& command, double least, const std::function<void(double)>& take);

/// Adds --samples, --estimator and --seed.
void add_sampling_options(CLI::App& command, Request& request);

/// All effects that a command can enable or disable but these. Closure has an option of its own, --no-closure.
std::vector<Effect> effects_but(const std::vector<Effect>& without);

/// Adds --enable and --disable for these effects.
void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects);

/// Adds --threads alone, and with --memory.
void add_threads_option(CLI::App& command, int& threads);
void add_machine_options(CLI::App& command, Request& request);

/// Adds --quiet.
void add_quiet_option(CLI::App& command, bool& quiet);

}  // namespace patchlight::cli
