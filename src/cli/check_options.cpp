#include "cli/check_options.h"

#include "cli/add_option.h"
#include "cli/distinct_files.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"
#include "cli/picture_options.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {
namespace {

constexpr int most_models = 1'000'000;

}  // namespace

struct CheckOptions {
  ModelOptions model;
  std::optional<Sides> sides;
  std::string problems, json;
  PictureGiven picture;
  std::optional<double> ambient_distance;
  bool wants_json = false;
  bool all = false;
};

std::shared_ptr<CheckOptions> add_check(CLI::App& tool) {
  auto options = std::make_shared<CheckOptions>();
  CheckOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("check", "tells what a model holds and what is wrong with it");
  add_model_options(command, to.model);
  command.option_defaults()->group("Results");
  add(command, "--sides", "auto|front|both",
      "counts the sides of the polygons that take part in a solve with\nthis option; default: they are not counted",
      [&to](const std::string& text) { to.sides = sides_named(text); });
  command.add_flag("--all", to.all,
                   "lists every object, material and problem; default: the largest\nand the worst, on one screen");
  command
      .add_option_function<std::vector<std::string>>(
          "--json",
          [&to](const std::vector<std::string>& values) {
            // In "check --json room.obj" the word after --json is the model.
            to.wants_json = true;
            for (const std::string& value : values) {
              if (std::filesystem::path(value).extension() == ".json") {
                to.json = value;
              } else if (!value.empty()) {
                to.model.models.push_back(value);
              }
            }
          },
          "all of it as JSON: into a file (.json), or without FILE on\nstandard output instead of the text")
      ->expected(0, most_models)
      ->option_text("[FILE]");
  command
      .add_option_function<std::string>(
          "--problems", [&to](const std::string& text) { to.problems = text; },
          "the model with its bad faces marked, for ParaView (.vtp):\ncell array problem_kind")
      ->option_text("FILE");
  add(command, "--picture", "FILE",
      "a picture of the model as it is, without light (.png, .hdr): its\ncolors, darker where faces are near to each "
      "other",
      [&to](const std::string& text) { to.picture.file = text; });
  add_view_options(command, to.picture);
  add(command, "--ambient-occlusion", "LENGTH",
      "how near, with its unit, as in 2m; default: a tenth of the model's\nmean extent",
      [&to](const std::string& text) { to.ambient_distance = length("--ambient-occlusion", text); });
  return options;
}

CheckArguments finish_check(const CheckOptions& options) {
  CheckArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.sides = options.sides;
  arguments.all = options.all;
  arguments.json = options.json;
  arguments.json_on_stdout = options.wants_json && arguments.json.empty();
  arguments.problems = options.problems;
  if (arguments.models.empty()) throw UsageError("check: found no model; expected: patchlight check MODEL");
  if (!arguments.problems.empty() && arguments.problems.extension() != ".vtp") {
    throw UsageError("--problems: found '" + options.problems + "'; expected a name that ends in .vtp");
  }
  const std::string& picture = options.picture.file;
  if (!picture.empty() && !picture.ends_with(".png") && !picture.ends_with(".hdr"))
    throw UsageError("--picture: found '" + picture + "'; expected a name that ends in .png or .hdr");
  arguments.picture = picture_settings(options.picture, "--picture", PictureQuality::draft);
  if (arguments.picture.views.size() > 1) throw UsageError("--view: found several; expected one for check --picture");
  arguments.ambient_distance = options.ambient_distance;
  if (options.ambient_distance && picture.empty()) throw UsageError("--ambient-occlusion needs --picture FILE");
  const std::vector<OutputFile> outputs = {
      {"--json", arguments.json}, {"--problems", arguments.problems}, {"--picture", arguments.picture.file}};
  require_distinct(outputs);
  require_not_read(outputs, arguments.models);
  return arguments;
}

}  // namespace patchlight::cli
