#include "cli/form_factor_options.h"

#include "cli/distinct_files.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"
#include "cli/storage_option.h"
#include "plan/check_request.h"

#include <string>
#include <vector>

namespace patchlight::cli {

struct FormFactorOptions {
  ModelOptions model;
  RequestGiven request;
  std::string output;
  std::optional<MatrixFormat> format;
  std::optional<GroupBy> by;
  bool quiet = false;
};

namespace {

void add_without(CLI::App& command, ShortCuts& short_cuts) {
  command
      .add_option_function<std::vector<std::string>>(
          "--without",
          [&short_cuts](const std::vector<std::string>& names) {
            for (const std::string& name : names) {
              short_cuts.*choice<bool ShortCuts::*>(
                              "--without", name,
                              {{"hidden", &ShortCuts::hidden}, {"free", &ShortCuts::free}, {"far", &ShortCuts::far}}) =
                  false;
            }
          },
          "leaves out a short cut, to see what it saves and errs: clusters\nof patches hidden from each other, or with "
          "nothing between them,\nwithout rays; the coarse rule for far pairs;\nmay be repeated; "
          "default: all are taken")
      ->allow_extra_args(false)
      ->option_text("hidden|free|far");
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
  if (wanted == nullptr) return;
  throw UsageError(std::string(wanted) +
                   ": found with --method rays; it needs --method pairs, the form factors of all pairs");
}

}  // namespace

std::shared_ptr<FormFactorOptions> add_form_factors(CLI::App& tool) {
  auto options = std::make_shared<FormFactorOptions>();
  FormFactorOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("form-factors", "computes the form factors between the patches of a model");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  add_effect_options(command, to.request, {Effect::reach, Effect::backs});
  command.option_defaults()->group("Results");
  command
      .add_option(
          "-o,--output", to.output,
          "folder for the matrix, the areas and the patches, which\npatchlight solve --form-factors takes; or a "
          "file for the\nmatrix alone (.npy, .mtx)")
      ->option_text("FOLDER|FILE");
  command
      .add_option_function<std::string>(
          "--matrix",
          [&to](const std::string& text) {
            to.format = choice<MatrixFormat>("--matrix", text,
                                             {{"npy", MatrixFormat::npy}, {"mtx", MatrixFormat::matrix_market}});
          },
          "format of the matrix in the folder: numpy's, or Matrix Market\ncoordinates; default npy")
      ->option_text("npy|mtx");
  command
      .add_option_function<std::string>(
          "--by",
          [&to](const std::string& text) {
            to.by = choice<GroupBy>("--by", text, {{"material", GroupBy::material}, {"object", GroupBy::object}});
          },
          "prints the form factors between materials or objects, too;\ninto the folder as CSV; default: patches only")
      ->option_text("material|object");
  command.option_defaults()->group("Form factors and equations");
  add_without(command, to.request.assembly.short_cuts);
  add_closure_option(command, to.request);
  add_patch_options(command, to.request);
  add_graded_option(command, to.request);
  add_stored_options(command, to.request);
  add_sampling_options(command, to.request);
  add_machine_options(command, to.request);
  command.add_flag("-q,--quiet", to.quiet, "prints errors and warnings only; default: progress and a summary");
  return options;
}

FormFactorArguments finish_form_factors(const FormFactorOptions& options) {
  FormFactorArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.output = options.output;
  arguments.format = options.format.value_or(MatrixFormat::npy);
  require_pairs(options);
  if (is_by_rays(options)) arguments.request.solver.solver = Solver::gmres;
  check(arguments.request);
  arguments.by = options.by;
  arguments.quiet = options.quiet;
  if (arguments.models.empty()) {
    throw UsageError("form-factors: found no model; expected: patchlight form-factors MODEL -o FOLDER");
  }
  if (arguments.output.empty()) {
    throw UsageError("form-factors: nothing would be written; give -o FOLDER, or -o FILE.npy for the matrix alone");
  }
  const std::filesystem::path extension = arguments.output.extension();
  if (extension == ".npy" || extension == ".mtx") {
    const auto named = extension == ".npy" ? MatrixFormat::npy : MatrixFormat::matrix_market;
    if (options.format && *options.format != named) {
      throw UsageError("--matrix: contradicts -o '" + options.output + "'; give one of them");
    }
    arguments.format = named;
  } else if (!is_by_rays(options)) {
    arguments.request.assembly.keep_errors = arguments.request.assembly.estimator == Estimator::automatic;
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

}  // namespace patchlight::cli
