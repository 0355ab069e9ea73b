#include "cli/compare_options.h"

#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/page_option.h"
#include "cli/parse_value.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {

struct CompareCommandOptions {
  ModelOptions model;
  RequestGiven request;
  std::string output, page;
  CompareOptions compare;
  bool quiet = false;
};

namespace {

std::vector<Contestant> contestants(const std::string& text) {
  std::vector<std::pair<std::string, Contestant>> allowed;
  for (const Contestant& contestant : all_contestants()) allowed.emplace_back(name_of(contestant), contestant);
  std::vector<Contestant> chosen;
  for (const std::string& word : split(text)) {
    const auto contestant = choice<Contestant>("--solvers", word, allowed);
    const auto is_same = [&](const Contestant& other) { return name_of(other) == name_of(contestant); };
    if (std::any_of(chosen.begin(), chosen.end(), is_same)) {
      throw refusal("--solvers", text, "every solver once; " + word + " is there twice");
    }
    chosen.push_back(contestant);
  }
  if (chosen.empty()) throw refusal("--solvers", text, "names of solvers with commas in between");
  return chosen;
}

void add_compare_options(CLI::App& command, CompareCommandOptions& options) {
  CompareOptions& compare = options.compare;
  command.option_defaults()->group("Results");
  add(command, "-o,--output", "FOLDER", "folder for tables, plots and a series for ParaView per solver",
      [&options](const std::string& text) { options.output = text; });
  add_page_option(command, options.page);
  add(command, "--solvers", "A,B,...",
      "which solvers take part, and in which order: any of\n" + solver_names(", ") +
          ", and\nprogressive-on-demand, whose rows are computed when it shoots;\ndefault: all",
      [&compare](const std::string& text) { compare.contestants = contestants(text); });
  add(command, "--tolerance", "NUMBER", "true relative error that every solver has to reach; default 1e-6",
      [&compare](const std::string& text) {
        const auto inside = [](double x) { return x >= 1e-9 && x < 1; };
        compare.relative_error = number("--tolerance", text, "a number from 1e-9 to below 1", inside);
      });
  add(command, "--max-iterations", "N",
      "a solver gives up after so many iterations, on demand after as\nmany shots as there are patches; default 10000",
      [&compare](const std::string& text) {
        compare.max_iterations = static_cast<int>(whole_number("--max-iterations", text, 1, 1'000'000));
      });
  command.add_flag_callback(
      "--no-series", [&compare] { compare.keep_iterates = false; }, "no series for ParaView; default: one per solver");
  add_closure_option(command, options.request);
  add_relaxation_option(command, compare.relaxation);
}

}  // namespace

std::shared_ptr<CompareCommandOptions> add_compare(CLI::App& tool) {
  auto options = std::make_shared<CompareCommandOptions>();
  CompareCommandOptions& to = *options;
  CLI::App& command =
      *tool.add_subcommand("compare-solvers", "solves a model with every solver: which converges how fast");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  add_effect_options(command, to.request, effects_but({Effect::interreflection}));
  add_compare_options(command, to);
  add_patch_options(command, to.request);
  add_graded_option(command, to.request);
  add_sampling_options(command, to.request);
  add_machine_options(command, to.request);
  command.option_defaults()->group("The run");
  command.add_flag("-q,--quiet", to.quiet, "prints errors and warnings only; default: progress and the table");
  return options;
}

CompareArguments finish_compare(const CompareCommandOptions& options) {
  CompareArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.options = options.compare;
  arguments.output = options.output;
  arguments.page = options.page;
  arguments.quiet = options.quiet;
  if (arguments.models.empty()) {
    throw UsageError("compare-solvers: found no model; expected: patchlight compare-solvers MODEL -o FOLDER");
  }
  if (arguments.output.empty()) throw UsageError("compare-solvers: nothing would be written; give -o FOLDER");
  require_page_elsewhere(arguments.page, arguments.output);
  require_not_read({{"--html", arguments.page}}, arguments.models);
  check(arguments.request, arguments.options);
  return arguments;
}

}  // namespace patchlight::cli
