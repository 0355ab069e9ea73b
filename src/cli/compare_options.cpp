#include "cli/compare_options.h"

#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {

struct CompareCommandOptions {
  ModelOptions model;
  MeshOptions mesh;
  std::string output;
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
  add(command, "-o,--output", "FOLDER", "folder for tables, plots and a series for ParaView per solver",
      [&options](const std::string& text) { options.output = text; });
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
  add_equation_options(command, options.mesh.request);
}

}  // namespace

std::shared_ptr<CompareCommandOptions> add_compare(CLI::App& tool) {
  auto options = std::make_shared<CompareCommandOptions>();
  CompareCommandOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("compare", "solves a model with every solver: which converges how fast");
  add_model_options(command, to.model);
  add_sides_option(command, to.mesh);
  add_effect_options(command, to.mesh.request, effects_but({Effect::interreflection}));
  add_compare_options(command, to);
  add_patch_options(command, to.mesh);
  add_sampling_options(command, to.mesh);
  add_machine_options(command, to.mesh.request);
  command.add_flag("-q,--quiet", to.quiet, "says nothing but errors; default: progress and the table");
  return options;
}

CompareArguments finish_compare(const CompareCommandOptions& options) {
  CompareArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = mesh_request(options.mesh, options.model.metres_per_unit);
  arguments.options = options.compare;
  arguments.output = options.output;
  arguments.quiet = options.quiet;
  if (arguments.models.empty()) {
    throw UsageError("compare: found no model; expected: patchlight compare MODEL -o FOLDER");
  }
  if (arguments.output.empty()) throw UsageError("compare: nothing would be written; give -o FOLDER");
  const auto is_sor = [](const Contestant& contestant) { return contestant.solver == Solver::sor; };
  const std::vector<Contestant>& all = arguments.options.contestants;
  if (arguments.request.relaxation && std::none_of(all.begin(), all.end(), is_sor)) {
    throw UsageError("--relaxation needs sor among --solvers");
  }
  require_consistent_effects(arguments.request, {});
  const auto on_demand = [](const Contestant& contestant) { return !keeps_entries(contestant.storage); };
  const std::vector<Contestant>& chosen = arguments.options.contestants;
  if (std::any_of(chosen.begin(), chosen.end(), on_demand) && arguments.request.estimator != Estimator::automatic) {
    throw UsageError(
        "--estimator: rows on demand are found by auto only; leave progressive-on-demand out of --solvers");
  }
  return arguments;
}

}  // namespace patchlight::cli
