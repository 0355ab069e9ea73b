// Options of the commands that examine methods and results: crosscheck, form-factors, compare-solvers, convergence,
// selftest.
#include "cli/distinct_files.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/output_options.h"
#include "cli/parse_value.h"
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

// So many sides that --sides auto leaves out are checked.
constexpr std::size_t left_out_checked = 16;

// Options that these commands share.
struct ResearchOptions {
  ModelOptions model;
  RequestGiven request;
  std::string output, page;
  bool quiet = false;
};

template <typename To>
void take_common(const ResearchOptions& options, To& arguments) {
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.quiet = options.quiet;
}

void require_model(const ResearchOptions& options, const std::string& command, const std::string& output) {
  if (options.model.models.empty())
    throw UsageError(command + ": no model given\nhint: patchlight " + command + " MODEL" + output);
}

void add_output_option(CLI::App& command, ResearchOptions& to) {
  add(command, "-o,--output", [&to](const std::string& text) { to.output = text; });
}

struct CrosscheckOptions : ResearchOptions {
  VerifyOptions verify;
  std::optional<double> bar;
  std::string json;
};

void add_crosscheck_options(CLI::App& command, CrosscheckOptions& to) {
  add(command, "--paths", [&to](const std::string& text) {
    to.verify.paths = static_cast<std::uint32_t>(whole_number("--paths", text, 1, 1U << 22U));
  });
  add(command, "--sample-patches",
      [&to](const std::string& text) { to.verify.checked = whole_number("--sample-patches", text, 1, 1'000'000'000); });
  add(command, "--margin", [&to](const std::string& text) {
    const std::string digits = text.ends_with('%') ? text.substr(0, text.size() - 1) : text;
    const auto inside = [](double x) { return x >= 0 && x <= 100; };
    to.bar = number("--margin", digits, "a percentage from 0 to 100", inside) / 100;
  });
  add_json_option(command, to.json);
}

CrosscheckArguments finish_crosscheck(const CrosscheckOptions& options) {
  require_model(options, "crosscheck", "");
  CrosscheckArguments arguments;
  take_common(options, arguments);
  arguments.options = options.verify;
  arguments.options.seed = arguments.request.assembly.seed;
  arguments.options.left_out = arguments.request.mesh.sides == Sides::automatic ? left_out_checked : 0;
  arguments.bar = options.bar;
  arguments.options.relative_bar = options.bar;
  arguments.request.accuracy.error_bars = !options.bar;
  Storage& storage = arguments.request.assembly.storage;
  if (options.bar && storage == Storage::rays) {
    throw UsageError(
        "--margin cannot be used with --method rays or --rays: it replaces all errors, but not the sampling error of "
        "rays");
  }
  if (options.bar && storage == Storage::automatic) storage = Storage::tiles;
  arguments.request = with_fitting_solver(std::move(arguments.request), false);
  const OptionName error_bars{"accuracy.error_bars", "the error bars that crosscheck uses without --margin"};
  check_with_names(arguments.request, std::array{error_bars});
  arguments.json = options.json;
  return arguments;
}

struct FormFactorOptions : ResearchOptions {
  std::optional<MatrixFormat> format;
  std::optional<GroupBy> by;
};

void add_form_factor_options(CLI::App& command, FormFactorOptions& to) {
  add_output_option(command, to);
  add(command, "--matrix", [&to](const std::string& text) {
    to.format =
        choice<MatrixFormat>("--matrix", text, {{"npy", MatrixFormat::npy}, {"mtx", MatrixFormat::matrix_market}});
  });
  add(command, "--by", [&to](const std::string& text) {
    to.by = choice<GroupBy>("--by", text, {{"material", GroupBy::material}, {"object", GroupBy::object}});
  });
  option_text("form-factors", "--without");
  const auto switch_off = [&short_cuts = to.request.assembly.short_cuts](const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      short_cuts.*choice<bool ShortCuts::*>(
                      "--without", name,
                      {{"hidden", &ShortCuts::hidden}, {"free", &ShortCuts::free}, {"far", &ShortCuts::far}}) = false;
    }
  };
  command.add_option_function<std::vector<std::string>>("--without", switch_off)->allow_extra_args(false);
}

bool is_by_rays(const FormFactorOptions& options) { return options.request.assembly.storage == Storage::rays; }

// A matrix and tables of groups are of all pairs.
void require_pairs(const FormFactorOptions& options) {
  if (!is_by_rays(options)) return;
  const std::filesystem::path extension = std::filesystem::path(options.output).extension();
  const char* const wanted = options.format                               ? "--matrix"
                             : options.by                                 ? "--by"
                             : extension == ".npy" || extension == ".mtx" ? "-o FILE"
                                                                          : nullptr;
  if (wanted != nullptr)
    throw UsageError(std::string(wanted) + " cannot be used with --method rays\nhint: --method pairs");
}

FormFactorArguments finish_form_factors(const FormFactorOptions& options) {
  FormFactorArguments arguments;
  take_common(options, arguments);
  arguments.output = options.output;
  arguments.format = options.format.value_or(MatrixFormat::npy);
  require_pairs(options);
  if (is_by_rays(options)) arguments.request.solver.solver = Solver::gmres;
  check(arguments.request);
  arguments.by = options.by;
  require_model(options, "form-factors", " -o FOLDER");
  if (arguments.output.empty())
    throw UsageError("form-factors: nothing would be written\nhint: -o FOLDER, or -o FILE.npy for the matrix alone");
  const std::filesystem::path extension = arguments.output.extension();
  if (extension == ".npy" || extension == ".mtx") {
    const auto named = extension == ".npy" ? MatrixFormat::npy : MatrixFormat::matrix_market;
    if (options.format && *options.format != named)
      throw UsageError("--matrix contradicts the extension of -o '" + options.output + "'");
    arguments.format = named;
  } else if (!is_by_rays(options)) {
    arguments.request.assembly.keep_errors = arguments.request.assembly.estimator == Estimator::automatic;
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

// The common end of the commands that write a folder, and a page beside it.
template <typename To>
To finished_folder(const ResearchOptions& options, const std::string& command, To arguments) {
  require_model(options, command, " -o FOLDER");
  take_common(options, arguments);
  arguments.output = options.output;
  arguments.page = options.page;
  if (arguments.output.empty()) throw UsageError(command + ": nothing would be written\nhint: -o FOLDER");
  require_page_elsewhere(arguments.page, arguments.output);
  require_not_read({{"--html", arguments.page}}, arguments.models);
  return arguments;
}

struct ComparisonOptions : ResearchOptions {
  CompareOptions compare;
};

std::vector<Contestant> contestants(const std::string& text) {
  std::vector<std::pair<std::string, Contestant>> allowed;
  for (const Contestant& contestant : all_contestants()) allowed.emplace_back(name_of(contestant), contestant);
  std::vector<Contestant> chosen;
  for (const std::string& word : split(text)) {
    const auto contestant = choice<Contestant>("--solvers", word, allowed);
    const auto is_same = [&](const Contestant& other) { return name_of(other) == name_of(contestant); };
    if (std::any_of(chosen.begin(), chosen.end(), is_same))
      throw refusal("--solvers", text, "every solver once; " + word + " is there twice");
    chosen.push_back(contestant);
  }
  if (chosen.empty()) throw refusal("--solvers", text, "names of solvers with commas in between");
  return chosen;
}

void add_comparison_options(CLI::App& command, ComparisonOptions& to) {
  CompareOptions& compare = to.compare;
  add_output_option(command, to);
  add_page_option(command, to.page);
  add(command, "--solvers", [&compare](const std::string& text) { compare.contestants = contestants(text); });
  add_tolerance_option(command, 1e-9, [&compare](double error) { compare.relative_error = error; });
  add(command, "--max-iterations", [&compare](const std::string& text) {
    compare.max_iterations = static_cast<int>(whole_number("--max-iterations", text, 1, 1'000'000));
  });
  add_flag(command, "--no-series", [&compare] { compare.keep_iterates = false; });
  add_closure_option(command, to.request);
  add_relaxation_option(command, compare.relaxation);
}

ComparisonArguments finish_comparison(const ComparisonOptions& options) {
  ComparisonArguments arguments;
  arguments.options = options.compare;
  arguments = finished_folder(options, "compare-solvers", std::move(arguments));
  check(arguments.request, arguments.options);
  return arguments;
}

struct ConvergenceOptions : ResearchOptions {
  StudyOptions study;
};

void add_convergence_options(CLI::App& command, ConvergenceOptions& to) {
  add_output_option(command, to);
  add_page_option(command, to.page);
  add(command, "--sizes",
      [&to](const std::string& text) { to.study.sizes = static_cast<int>(whole_number("--sizes", text, 2, 8)); });
  add_tolerance_option(command, 1e-10, [&to](double error) { to.request.solver.relative_error = error; });
  add_flag(command, "--no-adaptive", [&to] { to.study.adaptive = false; });
  add_flag(command, "--no-estimators", [&to] { to.study.estimators = false; });
}

ConvergenceArguments finish_convergence(const ConvergenceOptions& options) {
  ConvergenceArguments arguments;
  arguments.options = options.study;
  arguments = finished_folder(options, "convergence", std::move(arguments));
  check_for_study(arguments.request);
  return arguments;
}

}  // namespace

Finish add_crosscheck(CLI::App& tool) {
  auto to = std::make_shared<CrosscheckOptions>();
  CLI::App& command = *tool.add_subcommand("crosscheck");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_effect_options(command, to->request, effects_but({}));
  add_crosscheck_options(command, *to);
  add_patch_options(command, to->request);
  add_graded_option(command, to->request);
  add_refinement_options(command, to->request);
  add_sampling_options(command, to->request);
  add_method_options(command, to->request);
  add_closure_option(command, to->request);
  add_machine_options(command, to->request);
  add_quiet_option(command, to->quiet);
  return [to] { return finish_crosscheck(*to); };
}

Finish add_form_factors(CLI::App& tool) {
  auto to = std::make_shared<FormFactorOptions>();
  CLI::App& command = *tool.add_subcommand("form-factors");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_effect_options(command, to->request, {Effect::reach, Effect::backs});
  add_form_factor_options(command, *to);
  add_closure_option(command, to->request);
  add_patch_options(command, to->request);
  add_graded_option(command, to->request);
  add_stored_method_options(command, to->request);
  add_sampling_options(command, to->request);
  add_machine_options(command, to->request);
  add_quiet_option(command, to->quiet);
  return [to] { return finish_form_factors(*to); };
}

Finish add_compare_solvers(CLI::App& tool) {
  auto to = std::make_shared<ComparisonOptions>();
  CLI::App& command = *tool.add_subcommand("compare-solvers");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_effect_options(command, to->request, effects_but({Effect::interreflection}));
  add_comparison_options(command, *to);
  add_patch_options(command, to->request);
  add_graded_option(command, to->request);
  add_sampling_options(command, to->request);
  add_machine_options(command, to->request);
  add_quiet_option(command, to->quiet);
  return [to] { return finish_comparison(*to); };
}

Finish add_convergence(CLI::App& tool) {
  auto to = std::make_shared<ConvergenceOptions>();
  CLI::App& command = *tool.add_subcommand("convergence");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_effect_options(command, to->request, effects_but({Effect::interreflection}));
  add_convergence_options(command, *to);
  add_patch_options(command, to->request);
  add_sampling_options(command, to->request);
  add_machine_options(command, to->request);
  add_quiet_option(command, to->quiet);
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
