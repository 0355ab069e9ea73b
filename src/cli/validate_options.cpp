#include "cli/validate_options.h"

#include "cli/parse_value.h"

#include <string>
#include <vector>

namespace patchlight::cli {

struct ValidateOptions {
  ValidateArguments arguments;
};

std::shared_ptr<ValidateOptions> add_validate(CLI::App& tool) {
  auto options = std::make_shared<ValidateOptions>();
  ValidateArguments& to = options->arguments;
  CLI::App& command = *tool.add_subcommand("selftest", "compares results with known answers: is this copy sound?");
  command
      .add_option_function<std::vector<std::string>>(
          "--json",
          [&to](const std::vector<std::string>& values) {
            to.json_on_stdout = values.front().empty();
            to.json = values.front();
            if (!to.json_on_stdout && to.json.extension() != ".json") {
              throw refusal("--json", values.front(), "a name that ends in .json");
            }
          },
          "the table as JSON: into a file (.json), or without FILE on\nstandard output instead of the text")
      ->expected(0, 1)
      ->option_text("[FILE]");
  command
      .add_option_function<std::string>(
          "--threads",
          [&to](const std::string& text) { to.threads = static_cast<int>(whole_number("--threads", text, 0, 1024)); },
          "number of threads; default 0: one per processor")
      ->option_text("N");
  return options;
}

ValidateArguments finish_validate(const ValidateOptions& options) { return options.arguments; }

}  // namespace patchlight::cli
