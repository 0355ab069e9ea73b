#include "cli/study_options.h"

#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/page_option.h"
#include "cli/parse_value.h"

#include <string>

namespace patchlight::cli {

struct StudyCommandOptions {
  ModelOptions model;
  RequestGiven request;
  StudyOptions study;
  std::string output, page;
  bool quiet = false;
};

namespace {

void add_study_options(CLI::App& command, StudyCommandOptions& options) {
  command.option_defaults()->group("Results");
  add(command, "-o,--output", "FOLDER", "folder for the table, the facts and the plots",
      [&options](const std::string& text) { options.output = text; });
  add_page_option(command, options.page);
  add(command, "--sizes", "N",
      "how many sizes of patches at most, up to --patches or down to\n--max-edge; each has edges half as long as the "
      "one before, so about\nfour times the patches; default 4",
      [&options](const std::string& text) {
        options.study.sizes = static_cast<int>(whole_number("--sizes", text, 2, 8));
      });
  add(command, "--tolerance", "NUMBER", "the smallest relative error of the solver; default 1e-6",
      [&options](const std::string& text) {
        const auto inside = [](double x) { return x >= 1e-10 && x < 1; };
        options.request.solver.relative_error = number("--tolerance", text, "a number from 1e-10 to below 1", inside);
      });
  command.add_flag_callback(
      "--no-adaptive", [&options] { options.study.adaptive = false; },
      "no solving to accuracies, with patches refined where it pays;\ndefault: 10, 3, 1 and 0.3 %, as far as "
      "--patches");
  command.add_flag_callback(
      "--no-estimators", [&options] { options.study.estimators = false; },
      "the estimators of form factors are not compared; default: they\nare, with a sixteenth of the patches");
}

}  // namespace

std::shared_ptr<StudyCommandOptions> add_study(CLI::App& tool) {
  auto options = std::make_shared<StudyCommandOptions>();
  StudyCommandOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("convergence", "solves a model in many ways: what accuracy costs");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  add_effect_options(command, to.request, effects_but({Effect::interreflection}));
  add_study_options(command, to);
  add_patch_options(command, to.request);
  add_sampling_options(command, to.request);
  add_machine_options(command, to.request);
  command.option_defaults()->group("The run");
  command.add_flag("-q,--quiet", to.quiet, "prints errors and warnings only; default: progress and the table");
  return options;
}

StudyArguments finish_study(const StudyCommandOptions& options) {
  StudyArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.options = options.study;
  arguments.output = options.output;
  arguments.page = options.page;
  arguments.quiet = options.quiet;
  if (arguments.models.empty())
    throw UsageError("convergence: found no model; expected: patchlight convergence MODEL -o FOLDER");
  if (arguments.output.empty()) throw UsageError("convergence: nothing would be written; give -o FOLDER");
  require_page_elsewhere(arguments.page, arguments.output);
  require_not_read({{"--html", arguments.page}}, arguments.models);
  check_for_study(arguments.request);
  return arguments;
}

}  // namespace patchlight::cli
