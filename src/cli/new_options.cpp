#include "cli/new_options.h"

#include "cli/add_option.h"
#include "cli/distinct_files.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"

namespace patchlight::cli {

struct NewOptions {
  ModelOptions model;
  std::string output;
};

std::shared_ptr<NewOptions> add_new(CLI::App& tool) {
  auto options = std::make_shared<NewOptions>();
  NewOptions& to = *options;
  CLI::App& command = *tool.add_subcommand(
      "init", "writes a commented scene file for a model: sky, glass, sensors in its rooms, views from inside");
  add_file_options(command, to.model);
  command.option_defaults()->group("Results");
  add(command, "-o,--output", "SCENE.toml", "the scene file, which must not be there yet",
      [&to](const std::string& text) {
        if (!text.ends_with(".toml")) throw refusal("-o", text, "a name that ends in .toml");
        to.output = text;
      });
  return options;
}

NewArguments finish_new(const NewOptions& options) {
  if (options.model.models.empty() || options.output.empty())
    throw UsageError(std::string("init: found no ") + (options.model.models.empty() ? "model" : "-o SCENE.toml") +
                     "; expected: patchlight init MODEL -o SCENE.toml");
  NewArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.output = options.output;
  for (const std::filesystem::path& model : arguments.models) {
    if (model == "-" || model.extension() == ".toml")
      throw UsageError("init: found '" + model.string() + "'; expected model files, which a scene file can name");
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

}  // namespace patchlight::cli
