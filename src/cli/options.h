#pragma once

#include "cli/arguments.h"
#include "cli/help_texts.h"
#include "cli/parse_value.h"

#include <CLI/App.hpp>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Options for reading and solving a model, with the texts of help_texts.h. Names have the form "--max-edge" or
// "-o,--output". The target variables must outlive the command.
namespace patchlight::cli {

/// Adds an option with one value, which `take` parses.
template <typename Take>
CLI::Option* add(CLI::App& command, const std::string& name, Take take) {
  option_text(command.get_name(), name);  // it has one
  return command.add_option_function<std::string>(name, take);
}

/// Adds an option whose value is stored in `to`. The function parses the text and gets the short name of the option,
/// e.g. length().
template <typename To, typename Parse>
CLI::Option* add(CLI::App& command, const std::string& name, To& to, Parse parse) {
  return add(command, name, [&to, option = name.substr(0, name.find(',')), parse](const std::string& text) {
    to = parse(option, text);
  });
}

/// Adds an option for a whole number from `lower` to `upper`.
template <typename To>
CLI::Option* add_whole(CLI::App& command, const std::string& name, To& to, std::uint64_t lower, std::uint64_t upper) {
  return add(command, name, to, [lower, upper](const std::string& option, const std::string& text) {
    return static_cast<To>(whole_number(option, text, lower, upper));
  });
}

/// Adds an option with one of several words; each maps to a value.
template <typename Value, typename To>
CLI::Option* add_choice(CLI::App& command, const std::string& name, To& to,
                        const std::vector<std::pair<std::string, Value>>& allowed) {
  return add(command, name, to, [allowed](const std::string& option, const std::string& text) {
    return choice<Value>(option, text, allowed);
  });
}

/// Adds an option with a name that must not be empty: `expected` is "the name of a file" or of a folder.
template <typename To>
CLI::Option* add_name(CLI::App& command, const std::string& name, To& to, const std::string& expected) {
  return add(command, name, to, [expected](const std::string& option, const std::string& text) {
    if (text.empty()) throw refusal(option, text, expected);
    return text;
  });
}

/// Adds an option that can be repeated; its values are appended to `values`.
inline CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<std::string>& values) {
  option_text(command.get_name(), name);
  return command.add_option(name, values)->allow_extra_args(name[0] != '-');
}

/// Adds a flag that sets `to` to `value`.
inline CLI::Option* add_flag(CLI::App& command, const std::string& name, bool& to, bool value = true) {
  option_text(command.get_name(), name);
  return command.add_flag_callback(name, [&to, value] { to = value; });
}

/// Checks the parsed options of a command and returns the request. \throws UsageError, InputError.
using Finish = std::function<Arguments()>;

/// Each function adds a command with its options to the tool.
Finish add_check(CLI::App& tool);
Finish add_init(CLI::App& tool);
Finish add_solve(CLI::App& tool);
Finish add_render(CLI::App& tool);
Finish add_plan(CLI::App& tool);
Finish add_annual(CLI::App& tool);
Finish add_crosscheck(CLI::App& tool);
Finish add_relight(CLI::App& tool);
Finish add_form_factors(CLI::App& tool);
Finish add_compare_solvers(CLI::App& tool);
Finish add_convergence(CLI::App& tool);
Finish add_selftest(CLI::App& tool);

/// The options for reading a model, during parsing.
struct ModelOptions {
  std::vector<std::string> models, settings;
  std::string bands;
  std::optional<double> color_error;
  ReadOptions read;                 ///< without settings and bands
  bool max_edge_in_metres = false;  ///< --max-edge has its own unit; otherwise it uses the unit of the model
};

/// The options of a command during parsing: its model, and its arguments without the model.
template <typename Arguments>
struct GivenOptions {
  ModelOptions model;
  Arguments arguments;
};

/// \throws UsageError when a command got no model; `rest` completes its usage in the hint.
void require_model(const ModelOptions& options, const std::string& command, const std::string& rest);

/// Adds the arguments for files and units.
void add_file_options(CLI::App& command, ModelOptions& options);

/// The same, and the options that change the model: materials, choice of faces, daylight.
void add_model_options(CLI::App& command, ModelOptions& options);

/// The options for files, units, choice of faces and materials, and --ground: all but those of an hour's light.
void add_model_options_without_light(CLI::App& command, ModelOptions& options);

/// Adds --set, --up, --sky, --sun, --ground and --weather.
void add_light_options(CLI::App& command, ModelOptions& options);

/// Copies the model files and reading options. \throws UsageError when a model occurs twice, InputError for an invalid
/// --set.
void take_model(const ModelOptions& options, ModelArguments& arguments);

/// The same, with the longest edge in meters.
void take_model(const ModelOptions& options, RunArguments& arguments);

/// Adds --sides.
template <typename To>
void add_sides_option(CLI::App& command, To& sides) {
  add_choice<Sides>(command, "--sides", sides,
                    {{"auto", Sides::automatic}, {"front", Sides::front}, {"both", Sides::both}});
}

/// Adds the options that all commands with a mesh share: those of the model, --sides, --enable and --disable of these
/// effects, patches, samples, and the machine.
void add_run_options(CLI::App& command, ModelOptions& options, Request& request, const std::vector<Effect>& effects);

void add_patch_options(CLI::App& command, ModelOptions& options, Request& request);  ///< --max-edge, --patches, ...
void add_graded_option(CLI::App& command, Request& request);       ///< not if meshes are halved in sequence
void add_refinement_options(CLI::App& command, Request& request);  ///< --accuracy, --time-limit, --focus, --no-refine
void add_accuracy_options(CLI::App& command, Request& request);    ///< the same and error bars; default: cheap ones
/// Adds --method and --rays. Stored form factors require the pair or ray method.
void add_method_options(CLI::App& command, Request& request, bool stored = false);

/// Chooses a default solver for the method. If the given solver does not support the ray method, the default becomes
/// the pair method.
Request with_fitting_solver(Request request, bool solver_given);

void add_closure_option(CLI::App& command, Request& request);
void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation);

/// Adds --tolerance, from `least` (0: above 0) to below 1.
template <typename To>
void add_tolerance_option(CLI::App& command, double least, To& to) {
  add(command, "--tolerance", to,
      [least](const std::string& option, const std::string& text) { return tolerance(option, text, least); });
}

void add_sampling_options(CLI::App& command, Request& request);  ///< --samples, --estimator and --seed

/// All effects except these that a command can enable or disable. Closure has its own option, --no-closure.
std::vector<Effect> effects_but(const std::vector<Effect>& without);

/// Adds --enable and --disable for these effects.
void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects);

void add_threads_option(CLI::App& command, int& threads);
void add_machine_options(CLI::App& command, Request& request);  ///< --threads and --memory
void add_quiet_option(CLI::App& command, bool& quiet);

}  // namespace patchlight::cli
