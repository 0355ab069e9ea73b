#include "cli/check_options.h"

#include "cli/parse_value.h"

#include <string>
#include <vector>

namespace patchlight::cli {

struct CheckOptions {
  std::string model, problems, json;
  std::vector<std::string> settings;
  double metres_per_unit = 1;
  bool wants_json = false;
};

std::shared_ptr<CheckOptions> add_check(CLI::App& tool) {
  auto options = std::make_shared<CheckOptions>();
  CheckOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("check", "tells what a model holds and what is wrong with it");
  command.add_option("MODEL", to.model, "the model (.obj with .mtl)")->option_text(" ");
  command
      .add_option_function<std::string>(
          "--unit", [&to](const std::string& text) { to.metres_per_unit = unit_length(text); },
          "length of one model unit; default m")
      ->option_text("m|cm|mm|in|ft");
  command.add_option("--set", to.settings, "changes a material before the check, as in solve; may be\nrepeated")
      ->allow_extra_args(false)
      ->option_text("MATERIAL.reflectance|exitance|radiance=R,G,B");
  command
      .add_option_function<std::vector<std::string>>(
          "--json",
          [&to](const std::vector<std::string>& values) {
            to.wants_json = true;
            if (!values.empty()) to.json = values.front();
          },
          "all of it as JSON: into a file, or without FILE on standard\noutput instead of the text")
      ->expected(0, 1)
      ->option_text("[FILE]");
  command
      .add_option_function<std::string>(
          "--vtk", [&to](const std::string& text) { to.problems = text; },
          "the model with its bad faces marked, for ParaView (.vtp):\ncell array problem_kind")
      ->option_text("FILE");
  return options;
}

CheckArguments finish_check(const CheckOptions& options) {
  CheckArguments arguments;
  // In "check --json room.obj" the word after --json is the model.
  const bool json_took_the_model = options.model.empty() && !options.json.empty();
  arguments.model = json_took_the_model ? options.json : options.model;
  arguments.json = json_took_the_model ? "" : options.json;
  arguments.json_on_stdout = options.wants_json && arguments.json.empty();
  arguments.problems = options.problems;
  arguments.read.metres_per_unit = options.metres_per_unit;
  for (const std::string& setting : options.settings) {
    arguments.read.settings.push_back(parse_material_setting(setting));
  }
  if (arguments.model.empty()) throw UsageError("check: found no model; expected: patchlight check MODEL");
  if (!arguments.problems.empty() && arguments.problems.extension() != ".vtp") {
    throw UsageError("--vtk: found '" + options.problems + "'; expected a name that ends in .vtp");
  }
  for (const auto* output : {&arguments.json, &arguments.problems}) {
    if (output->empty() || weakly_canonical(*output) != weakly_canonical(arguments.model)) continue;
    throw UsageError("check: '" + output->string() + "' is the model; expected another file for the result");
  }
  if (!arguments.json.empty() && weakly_canonical(arguments.json) == weakly_canonical(arguments.problems)) {
    throw UsageError("--vtk: '" + options.problems + "' is also --json; expected different files");
  }
  return arguments;
}

}  // namespace patchlight::cli
