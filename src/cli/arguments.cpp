#include "cli/arguments.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/output/provenance.h"

#include "base/near_match.h"
#include "base/shell_word.h"
#include "cli/check_options.h"
#include "cli/compare_options.h"
#include "cli/form_factor_options.h"
#include "cli/former_names.h"
#include "cli/new_options.h"
#include "cli/plan_options.h"
#include "cli/relight_options.h"
#include "cli/render_options.h"
#include "cli/solution_options.h"
#include "cli/solve_options.h"
#include "cli/study_options.h"
#include "cli/validate_options.h"
#include "cli/verify_options.h"
#include "input/read_model.h"
#include "input/text.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <system_error>

namespace patchlight::cli {
namespace {

constexpr const char* exit_codes =
    "Exit codes: 0 good, 1 usage, 2 input, 3 not converged or not as accurate as asked (results are\n"
    "written), 4 out of memory, 5 a validation or verification failed, 6 output cannot be written,\n"
    "70 internal error, 130 stopped by Ctrl-C, 128 + n by signal n (solve and relight write the results\n"
    "so far unless --discard is given).";

// ": did you mean --max-edge?" when an option is at most two letters away, nothing otherwise.
std::string near_option(const CLI::App& command, const std::string& unknown) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string nearest = near_match(unknown.substr(0, unknown.find('=')), names);
  return nearest.empty() ? "" : ": did you mean " + nearest + "?";
}

// What stands for an option of other commands in this one, or nothing.
std::string other_option(const std::string& command, const std::string& unknown) {
  const bool is_picture = command == "render" && (unknown == "--picture" || unknown.starts_with("--picture="));
  return is_picture ? "; expected -o VIEW.png, which names the picture that patchlight render takes" : "";
}

// Refuses words that no option or positional argument took; an unknown option is named before its value.
void require_nothing_left(const CLI::App& command, const std::string& name, std::vector<std::string> left) {
  std::erase(left, "--");  // ends the options
  if (left.empty()) return;
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  const auto unknown = std::find_if(left.begin(), left.end(), is_option);
  if (unknown != left.end()) {
    const std::string other = other_option(name, *unknown);
    const std::string hint = other.empty() ? near_option(command, *unknown) : other;
    throw UsageError(name + ": unknown option " + *unknown +
                     (hint.empty() ? "; patchlight " + name + (name.empty() ? "" : " ") + "--help lists them" : hint));
  }
  throw UsageError(name + ": unexpected argument '" + left.front() + "'");
}

// The command line as one would type it again.
std::string joined(const std::vector<std::string>& words) {
  std::string line = "patchlight";
  for (std::size_t k = 1; k < words.size(); ++k) line += ' ' + shell_word(words[k]);
  return line;
}

std::vector<std::string> commands(const CLI::App& tool) {
  std::vector<std::string> names;
  for (const CLI::App* command : tool.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> commands_with_a_model(const CLI::App& tool) {
  std::vector<std::string> names = commands(tool);
  std::erase_if(names, [&](const std::string& name) {
    return tool.get_subcommand(name)->get_option_no_throw("MODEL") == nullptr;
  });
  return names;
}

bool names_a_model(const std::filesystem::path& file) {
  const std::vector<std::string> formats = readable_formats();
  return file != "-" && std::find(formats.begin(), formats.end(), format_of(file)) != formats.end();
}

// Refuses a file where a command is expected, with the line that may be meant: what was given, and without options the
// result that is named after the file.
void refuse_file(const CLI::App& tool, const std::vector<std::string>& words) {
  const std::filesystem::path file = words.front();
  std::error_code error;
  const bool is_model = names_a_model(file);
  if (!is_model && !std::filesystem::is_regular_file(file, error)) return;
  std::string line = "patchlight solve";
  for (const std::string& word : words) line += ' ' + shell_word(word);
  if (std::none_of(words.begin(), words.end(), [](const std::string& word) { return word.starts_with('-'); }))
    line += " -o " + shell_word(file.stem().string() + ".vtp");
  throw UsageError("found the file '" + words.front() + "' in place of a command; a model is taken by the commands " +
                   listed(commands_with_a_model(tool)) + (is_model ? ". Did you mean: " + line : ""));
}

void require_one_command(const CLI::App& tool) {
  if (tool.get_subcommands().size() == 1) return;
  const std::vector<std::string> names = commands(tool);
  const std::string list = listed(names);
  const std::vector<std::string> left = tool.remaining();
  if (!left.empty() && left.front()[0] == '-') {
    throw UsageError("unknown option " + left.front() + "; expected a command: " + list);
  }
  if (!left.empty()) {
    refuse_file(tool, left);
    throw UsageError("unknown command '" + left.front() + "'; expected one of " + list +
                     suggestion(left.front(), names));
  }
  throw UsageError("found no command; expected one of " + list + ". patchlight --help tells more");
}

// What the tool says about itself.
void add_information(CLI::App& tool) {
  tool.get_formatter()->column_width(30);
  tool.set_version_flag("--version", std::string("patchlight ") + version(), "prints the version");
  tool.set_help_flag("-h,--help", "prints this help");
  tool.footer(std::string("patchlight COMMAND --help lists the options of a command.\n\n") + exit_codes);
}

}  // namespace

Arguments parse_arguments(int count, const char* const* values) {
  const std::vector<std::string> words = with_present_names(count, values).words;
  CLI::App tool("patchlight: diffuse interreflection of light by finite-element radiosity", "patchlight");
  add_information(tool);
  const std::shared_ptr<SolveOptions> solve_options = add_solve(tool);
  const std::shared_ptr<CheckOptions> check_options = add_check(tool);
  const std::shared_ptr<NewOptions> new_options = add_new(tool);
  const std::shared_ptr<PlanOptions> plan_options = add_plan(tool);
  const std::shared_ptr<FormFactorOptions> form_factor_options = add_form_factors(tool);
  const std::shared_ptr<RelightOptions> relight_options = add_relight(tool);
  const std::shared_ptr<RenderOptionsGiven> render_options = add_render(tool);
  const std::shared_ptr<CompareCommandOptions> compare_options = add_compare(tool);
  const std::shared_ptr<StudyCommandOptions> study_options = add_study(tool);
  const std::shared_ptr<VerifyCommandOptions> verify_options = add_verify(tool);
  const std::shared_ptr<ValidateOptions> validate_options = add_validate(tool);
  tool.allow_extras();
  for (CLI::App* command : tool.get_subcommands({})) {
    command->footer(exit_codes);
    command->allow_extras();
  }

  std::vector<const char*> c_strings;
  for (const std::string& word : words) c_strings.push_back(word.c_str());
  // The parsing library speaks through its own exceptions; they end here.
  try {
    tool.parse(static_cast<int>(c_strings.size()), c_strings.data());
    require_one_command(tool);
    const CLI::App& command = *tool.get_subcommands().front();
    require_nothing_left(command, command.get_name(), tool.remaining(true));
    if (command.get_name() == "check") return finish_check(*check_options);
    if (command.get_name() == "init") return finish_new(*new_options);
    if (command.get_name() == "plan") return finish_plan(*plan_options);
    if (command.get_name() == "render") {
      RenderArguments arguments = finish_render(*render_options);
      arguments.command_line = joined(words);
      return arguments;
    }
    if (command.get_name() == "selftest") return finish_validate(*validate_options);
    if (command.get_name() == "form-factors") {
      FormFactorArguments arguments = finish_form_factors(*form_factor_options);
      arguments.command_line = joined(words);
      return arguments;
    }
    if (command.get_name() == "compare-solvers") {
      CompareArguments arguments = finish_compare(*compare_options);
      arguments.command_line = joined(words);
      return arguments;
    }
    if (command.get_name() == "convergence") {
      StudyArguments arguments = finish_study(*study_options);
      arguments.command_line = joined(words);
      return arguments;
    }
    if (command.get_name() == "crosscheck") {
      VerifyArguments arguments = finish_verify(*verify_options);
      arguments.command_line = joined(words);
      return arguments;
    }
    const bool again = command.get_name() == "relight";
    SolveArguments arguments = again ? finish_relight(*relight_options) : finish_solve(*solve_options);
    arguments.command_line = joined(words);
    return arguments;
  } catch (const CLI::CallForHelp&) {
    return Information{tool.help()};
  } catch (const CLI::CallForVersion& call) {
    return Information{std::string(call.what()) + "\n"};
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string message = error.what();
    throw UsageError(message + (message.starts_with("--camera")
                                    ? std::string("; expected EYE TARGET FOV, as in ") + camera_example
                                    : ""));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace patchlight::cli
