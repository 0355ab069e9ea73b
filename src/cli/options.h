#pragma once

#include "patchlight/input/read_scene.h"

#include "cli/arguments.h"
#include "cli/help_texts.h"

#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// The options of commands that say which model is read and how it is solved, with the texts of help_texts.h. A name is
// written as there: "--max-edge" or "-o,--output". Values land in structures that must outlive the command.
namespace patchlight::cli {

/// Adds an option with one value, which `take` accepts or refuses.
template <typename Take>
CLI::Option* add(CLI::App& command, const std::string& name, Take take) {
  option_text(command.get_name(), name);  // it has one
  return command.add_option_function<std::string>(name, take);
}

/// Adds an option that may be repeated; its values land in `values`.
inline CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<std::string>& values) {
  option_text(command.get_name(), name);
  return command.add_option(name, values)->allow_extra_args(name[0] != '-');
}

/// Adds an option without a value, which calls `given`.
template <typename Given>
CLI::Option* add_flag(CLI::App& command, const std::string& name, Given given) {
  option_text(command.get_name(), name);
  return command.add_flag_callback(name, given);
}

/// Checks the options of a command after they were parsed, and returns the request. \throws
/// UsageError, InputError.
using Finish = std::function<Arguments()>;

/// Each adds a command with its options to the tool.
Finish add_check(CLI::App& tool);
Finish add_init(CLI::App& tool);
Finish add_solve(CLI::App& tool);
Finish add_render(CLI::App& tool);
Finish add_plan(CLI::App& tool);
Finish add_crosscheck(CLI::App& tool);
Finish add_relight(CLI::App& tool);
Finish add_form_factors(CLI::App& tool);
Finish add_compare_solvers(CLI::App& tool);
Finish add_convergence(CLI::App& tool);
Finish add_selftest(CLI::App& tool);

/// The options that say which model is read and how, while they are being parsed.
struct ModelOptions {
  std::vector<std::string> models;
  std::string format;
  std::vector<std::string> settings;
  std::optional<double> metres_per_unit;
  std::optional<Vector> up;
  std::vector<std::string> only, leave_out;
  double detail = 0;
  std::optional<double> maintenance_factor;
  bool keep_faces = false;
  DaylightSetting daylight;
  std::string bands;
  std::optional<double> color_error;
  std::string confine;
};

/// Adds the arguments that name the files and their units. The values land in `options`, which must outlive the
/// command; so below.
void add_file_options(CLI::App& command, ModelOptions& options);

/// The same, and the options that change the model: materials, choice of faces, daylight.
void add_model_options(CLI::App& command, ModelOptions& options);

/// Adds --set alone.
void add_set_option(CLI::App& command, std::vector<std::string>& settings);

/// Adds --up alone.
void add_up_option(CLI::App& command, std::optional<Vector>& up);

/// Adds --sky, --sun, --ground and --weather.
void add_daylight_options(CLI::App& command, DaylightSetting& daylight);

/// The model files as paths. \throws UsageError when one is given twice.
std::vector<std::filesystem::path> model_files(const ModelOptions& options);

/// \throws InputError when a --set cannot be understood.
ReadOptions read_options(const ModelOptions& options);

/// \throws InputError when one cannot be understood.
std::vector<MaterialSetting> material_settings(const std::vector<std::string>& texts);

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
