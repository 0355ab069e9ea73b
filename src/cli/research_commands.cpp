// Options of the commands that examine methods and results: crosscheck, form-factors, compare-solvers, convergence,
// selftest.
#include "cli/distinct_files.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/output_options.h"
#include "plan/check_request.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

template <typename Arguments>
void add_output_option(CLI::App& command, Arguments& arguments) {
  add(command, "-o,--output", [&arguments](const std::string& text) { arguments.output = text; });
}

using CrosscheckOptions = GivenOptions<CrosscheckArguments>;

CrosscheckArguments finish_crosscheck(const CrosscheckOptions& options) {
  require_model(options.model, "crosscheck", "");
  CrosscheckArguments arguments = options.arguments;
  take_model(options.model, arguments);
  arguments.options.seed = arguments.request.assembly.seed;
  // number of checked sides among those that --sides auto leaves out
  arguments.options.left_out = arguments.request.mesh.sides == Sides::automatic ? 16 : 0;
  arguments.options.relative_bar = arguments.bar;
  arguments.request.accuracy.error_bars = !arguments.bar;
  Storage& storage = arguments.request.assembly.storage;
  if (arguments.bar && storage == Storage::rays) {
    throw UsageError(
        "--margin cannot be used with --method rays or --rays: it replaces all errors, but not the sampling error of "
        "rays");
  }
  if (arguments.bar && storage == Storage::automatic) storage = Storage::tiles;
  arguments.request = with_fitting_solver(std::move(arguments.request), false);
  const OptionName error_bars{"accuracy.error_bars", "the error bars that crosscheck uses without --margin"};
  check_with_names(arguments.request, std::array{error_bars});
  return arguments;
}

struct FormFactorOptions : GivenOptions<FormFactorArguments> {
  std::optional<MatrixFormat> format;
};

// A matrix and tables of groups require the pair method.
void require_pairs(const FormFactorOptions& options) {
  const std::filesystem::path extension = options.arguments.output.extension();
  const char* const wanted = options.format                               ? "--matrix"
                             : options.arguments.by                       ? "--by"
                             : extension == ".npy" || extension == ".mtx" ? "-o FILE"
                                                                          : nullptr;
  if (wanted != nullptr)
    throw UsageError(std::string(wanted) + " cannot be used with --method rays\nhint: --method pairs");
}

FormFactorArguments finish_form_factors(const FormFactorOptions& options) {
  FormFactorArguments arguments = options.arguments;
  take_model(options.model, arguments);
  arguments.format = options.format.value_or(MatrixFormat::npy);
  const bool is_by_rays = arguments.request.assembly.storage == Storage::rays;
  if (is_by_rays) {
    require_pairs(options);
    arguments.request.solver.solver = Solver::gmres;
  }
  check(arguments.request);
  require_model(options.model, "form-factors", " -o FOLDER");
  if (arguments.output.empty())
    throw UsageError("form-factors: nothing would be written\nhint: -o FOLDER, or -o FILE.npy for the matrix alone");
  const std::filesystem::path extension = arguments.output.extension();
  if (extension == ".npy" || extension == ".mtx") {
    const auto named = extension == ".npy" ? MatrixFormat::npy : MatrixFormat::matrix_market;
    if (options.format && *options.format != named)
      throw UsageError("--matrix contradicts the extension of -o '" + arguments.output.string() + "'");
    arguments.format = named;
  } else if (!is_by_rays) {
    arguments.request.assembly.keep_errors = arguments.request.assembly.estimator == Estimator::automatic;
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

// Finishes commands that write a folder and an optional page beside it.
template <typename Arguments>
Arguments finished_folder(const GivenOptions<Arguments>& options, const std::string& command) {
  require_model(options.model, command, " -o FOLDER");
  Arguments arguments = options.arguments;
  take_model(options.model, arguments);
  if (arguments.output.empty()) throw UsageError(command + ": nothing would be written\nhint: -o FOLDER");
  require_page_elsewhere(arguments.page, arguments.output);
  require_not_read({{"--html", arguments.page}}, arguments.models);
  return arguments;
}

using ComparisonOptions = GivenOptions<ComparisonArguments>;

std::vector<Contestant> contestants(const std::string& option, const std::string& text) {
  std::vector<std::pair<std::string, Contestant>> allowed;
  for (const Contestant& contestant : all_contestants()) allowed.emplace_back(name_of(contestant), contestant);
  std::vector<Contestant> chosen;
  for (const std::string& word : split(text)) {
    const auto contestant = choice<Contestant>(option, word, allowed);
    const auto is_same = [&](const Contestant& other) { return name_of(other) == name_of(contestant); };
    if (std::any_of(chosen.begin(), chosen.end(), is_same))
      throw refusal(option, text, "every solver once; " + word + " is there twice");
    chosen.push_back(contestant);
  }
  if (chosen.empty()) throw refusal(option, text, "names of solvers with commas in between");
  return chosen;
}

ComparisonArguments finish_comparison(const ComparisonOptions& options) {
  ComparisonArguments arguments = finished_folder(options, "compare-solvers");
  check(arguments.request, arguments.options);
  return arguments;
}

using ConvergenceOptions = GivenOptions<ConvergenceArguments>;

ConvergenceArguments finish_convergence(const ConvergenceOptions& options) {
  ConvergenceArguments arguments = finished_folder(options, "convergence");
  check_for_study(arguments.request);
  return arguments;
}

}  // namespace

Finish add_crosscheck(CLI::App& tool) {
  auto to = std::make_shared<CrosscheckOptions>();
  CLI::App& command = *tool.add_subcommand("crosscheck");
  auto& arguments = to->arguments;
  Request& request = arguments.request;
  add_run_options(command, to->model, request, effects_but({}));
  add_whole(command, "--paths", arguments.options.paths, 1, 1U << 22U);
  add_whole(command, "--sample-patches", arguments.options.checked, 1, 1'000'000'000);
  add(command, "--margin", [&arguments](const std::string& text) {
    const std::string digits = text.ends_with('%') ? text.substr(0, text.size() - 1) : text;
    const auto inside = [](double x) { return x >= 0 && x <= 100; };
    arguments.bar = number("--margin", digits, "a percentage from 0 to 100", inside) / 100;
  });
  add_json_option(command, arguments.json);
  add_graded_option(command, request);
  add_refinement_options(command, request);
  add_method_options(command, request);
  add_closure_option(command, request);
  add_quiet_option(command, arguments.quiet);
  return [to] { return finish_crosscheck(*to); };
}

Finish add_form_factors(CLI::App& tool) {
  auto to = std::make_shared<FormFactorOptions>();
  CLI::App& command = *tool.add_subcommand("form-factors");
  auto& arguments = to->arguments;
  Request& request = arguments.request;
  add_run_options(command, to->model, request, {Effect::reach, Effect::backs});
  add_output_option(command, arguments);
  add_choice<MatrixFormat>(command, "--matrix", to->format,
                           {{"npy", MatrixFormat::npy}, {"mtx", MatrixFormat::matrix_market}});
  add_choice<GroupBy>(command, "--by", arguments.by, {{"material", GroupBy::material}, {"object", GroupBy::object}});
  option_text("form-factors", "--without");
  const auto switch_off = [&short_cuts = request.assembly.short_cuts](const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      short_cuts.*choice<bool ShortCuts::*>(
                      "--without", name,
                      {{"hidden", &ShortCuts::hidden}, {"free", &ShortCuts::free}, {"far", &ShortCuts::far}}) = false;
    }
  };
  command.add_option_function<std::vector<std::string>>("--without", switch_off)->allow_extra_args(false);
  add_closure_option(command, request);
  add_graded_option(command, request);
  add_method_options(command, request, true);
  add_quiet_option(command, arguments.quiet);
  return [to] { return finish_form_factors(*to); };
}

Finish add_compare_solvers(CLI::App& tool) {
  auto to = std::make_shared<ComparisonOptions>();
  CLI::App& command = *tool.add_subcommand("compare-solvers");
  auto& arguments = to->arguments;
  Request& request = arguments.request;
  add_run_options(command, to->model, request, effects_but({Effect::interreflection}));
  CompareOptions& compare = arguments.options;
  add_output_option(command, arguments);
  add_page_option(command, arguments.page);
  add(command, "--solvers", compare.contestants, contestants);
  add_tolerance_option(command, 1e-9, compare.relative_error);
  add_whole(command, "--max-iterations", compare.max_iterations, 1, 1'000'000);
  add_flag(command, "--no-series", compare.keep_iterates, false);
  add_closure_option(command, request);
  add_relaxation_option(command, compare.relaxation);
  add_graded_option(command, request);
  add_quiet_option(command, arguments.quiet);
  return [to] { return finish_comparison(*to); };
}

Finish add_convergence(CLI::App& tool) {
  auto to = std::make_shared<ConvergenceOptions>();
  CLI::App& command = *tool.add_subcommand("convergence");
  auto& arguments = to->arguments;
  Request& request = arguments.request;
  add_run_options(command, to->model, request, effects_but({Effect::interreflection}));
  add_output_option(command, arguments);
  add_page_option(command, arguments.page);
  add_whole(command, "--sizes", arguments.options.sizes, 2, 8);
  add_tolerance_option(command, 1e-10, request.solver.relative_error);
  add_flag(command, "--no-adaptive", arguments.options.adaptive, false);
  add_flag(command, "--no-estimators", arguments.options.estimators, false);
  add_quiet_option(command, arguments.quiet);
  return [to] { return finish_convergence(*to); };
}

Finish add_selftest(CLI::App& tool) {
  auto to = std::make_shared<SelftestArguments>();
  CLI::App& command = *tool.add_subcommand("selftest");
  option_text("selftest", "--json");
  const auto take = [&to = *to](const std::vector<std::string>& values) {
    to.json_on_stdout = values.front().empty();
    to.json = values.front();
    if (!to.json_on_stdout && to.json.extension() != ".json")
      throw refusal("--json", values.front(), "a name that ends in .json");
  };
  command.add_option_function<std::vector<std::string>>("--json", take)->expected(0, 1);
  add_threads_option(command, to->threads);
  return [to] { return *to; };
}

}  // namespace patchlight::cli
