#include "cli/verify_options.h"

#include "cli/accuracy_options.h"
#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/option_names.h"
#include "cli/parse_value.h"
#include "cli/storage_option.h"

#include <array>
#include <string>
#include <utility>

namespace patchlight::cli {

// So many sides that --sides auto leaves out are looked at.
constexpr std::size_t left_out_checked = 16;

struct VerifyCommandOptions {
  ModelOptions model;
  RequestGiven request;
  VerifyOptions verify;
  std::optional<double> bar;
  std::string json;
  bool quiet = false;
};

namespace {

void add_verify_options(CLI::App& command, VerifyCommandOptions& options) {
  command.option_defaults()->group("The check");
  add(command, "--paths", "N",
      "paths per patch and sensor, rounded up to 32 times a power of two; the noise\nof the check falls as their root; "
      "default "
      "4096",
      [&options](const std::string& text) {
        options.verify.paths = static_cast<std::uint32_t>(whole_number("--paths", text, 1, 1U << 22U));
      });
  add(command, "--sample-patches", "N",
      "how many patches are checked, seven eighths of them inside or of\ninterest, and how many sensors and rooms at "
      "most; default 64",
      [&options](const std::string& text) {
        options.verify.checked = whole_number("--sample-patches", text, 1, 1'000'000'000);
      });
  add(command, "--margin", "PERCENT",
      "standard error that each patch's irradiance is granted instead of\nits error bars, in percent of it, or of the "
      "mean where that is\nlarger, e.g. 2%; default: error bars from mesh, form factors and\nsolver",
      [&options](const std::string& text) {
        const std::string digits = text.ends_with('%') ? text.substr(0, text.size() - 1) : text;
        const auto inside = [](double x) { return x >= 0 && x <= 100; };
        options.bar = number("--margin", digits, "a percentage from 0 to 100", inside) / 100;
      });
  add(command, "--json", "FILE", "the verdict and every patch that was checked (.json)",
      [&options](const std::string& text) {
        if (!text.ends_with(".json")) throw refusal("--json", text, "a name that ends in .json");
        options.json = text;
      });
}

}  // namespace

std::shared_ptr<VerifyCommandOptions> add_verify(CLI::App& tool) {
  auto options = std::make_shared<VerifyCommandOptions>();
  VerifyCommandOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("crosscheck", "solves a model and checks the answer by path tracing");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  add_effect_options(command, to.request, effects_but({}));
  add_verify_options(command, to);
  add_patch_options(command, to.request);
  add_graded_option(command, to.request);
  add_refinement_options(command, to.request);
  add_sampling_options(command, to.request);
  add_storage_options(command, to.request);
  add_closure_option(command, to.request);
  add_machine_options(command, to.request);
  command.option_defaults()->group("The run");
  command.add_flag("-q,--quiet", to.quiet,
                   "says nothing but errors, and the verdict unless it agrees;\ndefault: progress and the figures");
  return options;
}

VerifyArguments finish_verify(const VerifyCommandOptions& options) {
  if (options.model.models.empty()) {
    throw UsageError("crosscheck: found no model; expected: patchlight crosscheck MODEL");
  }
  VerifyArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.options = options.verify;
  arguments.options.seed = arguments.request.assembly.seed;
  arguments.options.left_out = arguments.request.mesh.sides == Sides::automatic ? left_out_checked : 0;
  arguments.bar = options.bar;
  arguments.options.relative_bar = options.bar;
  arguments.quiet = options.quiet;
  arguments.request.accuracy.error_bars = !options.bar;
  Storage& storage = arguments.request.assembly.storage;
  if (options.bar && storage == Storage::rays) {
    throw UsageError(
        "--margin: found with --method rays or --rays; it takes the place of all errors, and what rays err "
        "is in none that is given. Give one of them");
  }
  if (options.bar && storage == Storage::automatic) storage = Storage::tiles;
  arguments.request = with_fitting_solver(std::move(arguments.request), false);
  const OptionName error_bars{"accuracy.error_bars", "the error bars that crosscheck takes without --margin PERCENT"};
  check_with_names(arguments.request, std::array{error_bars});
  arguments.json = options.json;
  return arguments;
}

}  // namespace patchlight::cli
