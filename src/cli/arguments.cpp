#include "cli/arguments.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/output/write_result.h"

#include "base/near_match.h"
#include "cli/command_options.h"
#include "cli/former_names.h"
#include "cli/help.h"
#include "cli/help_texts.h"
#include "cli/output_options.h"
#include "input/read_model.h"
#include "input/text.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

namespace patchlight::cli {
namespace {

// ": did you mean --max-edge?" if an option is at most two letters away, nothing otherwise.
std::string near_option(const CLI::App& command, const std::string& unknown) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string nearest = near_match(unknown.substr(0, unknown.find('=')), names);
  return nearest.empty() ? "" : ": did you mean " + nearest + "?";
}

// The hint for an option that other commands have.
std::string other_option(const std::string& command, const std::string& unknown) {
  const bool is_picture = command == "render" && (unknown == "--picture" || unknown.starts_with("--picture="));
  return is_picture ? "\nhint: -o VIEW.png names the image of patchlight render" : "";
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
                     (hint.empty() ? "\nhint: patchlight " + name + " --help lists the options" : hint));
  }
  throw UsageError(name + ": unexpected argument '" + left.front() + "'");
}

// The command line as one would type it again.
std::string joined(const std::vector<std::string>& words) {
  std::string line = "patchlight";
  for (std::size_t k = 1; k < words.size(); ++k) line += ' ' + shell_word(words[k]);
  return line;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const CommandText& command : command_texts()) names.emplace_back(command.name);
  return names;
}

bool names_a_model(const std::filesystem::path& file) {
  const std::vector<std::string> formats = readable_formats();
  return file != "-" && std::find(formats.begin(), formats.end(), format_of(file)) != formats.end();
}

// Refuses a file where a command is expected, with the line that may be meant: the words that were given, and without
// options the result that is named after the file.
void refuse_file(const std::vector<std::string>& words) {
  const std::filesystem::path file = words.front();
  std::error_code error;
  const bool is_model = names_a_model(file);
  if (!is_model && !std::filesystem::is_regular_file(file, error)) return;
  std::string line = "patchlight solve";
  for (const std::string& word : words) line += ' ' + shell_word(word);
  if (std::none_of(words.begin(), words.end(), [](const std::string& word) { return word.starts_with('-'); }))
    line += " -o " + shell_word(file.stem().string() + ".vtp");
  throw UsageError("'" + words.front() +
                   "' is a file, not a command\nhint: " + (is_model ? line : "patchlight --help lists the commands"));
}

void require_one_command(const CLI::App& tool) {
  if (tool.get_subcommands().size() == 1) return;
  const std::string list = listed(command_names());
  const std::vector<std::string> left = tool.remaining();
  if (!left.empty() && left.front()[0] == '-')
    throw UsageError("unknown option " + left.front() + "; expected a command: " + list);
  if (!left.empty()) {
    refuse_file(left);
    throw UsageError("unknown command '" + left.front() + "'; expected one of " + list +
                     suggestion(left.front(), command_names()));
  }
  throw UsageError("no command given; expected one of " + list + "\nhint: patchlight --help");
}

// The commands of the tool, each with the way to finish its options.
std::map<std::string, Finish> add_commands(CLI::App& tool) {
  std::map<std::string, Finish> finish = {{"check", add_check(tool)},
                                          {"init", add_init(tool)},
                                          {"solve", add_solve(tool)},
                                          {"render", add_render(tool)},
                                          {"plan", add_plan(tool)},
                                          {"crosscheck", add_crosscheck(tool)},
                                          {"relight", add_relight(tool)},
                                          {"form-factors", add_form_factors(tool)},
                                          {"compare-solvers", add_compare_solvers(tool)},
                                          {"convergence", add_convergence(tool)},
                                          {"selftest", add_selftest(tool)}};
  for (CLI::App* command : tool.get_subcommands({})) command->allow_extras();
  return finish;
}

Arguments parse(CLI::App& tool, const std::map<std::string, Finish>& finish, const std::vector<std::string>& words) {
  std::vector<const char*> c_strings;
  for (const std::string& word : words) c_strings.push_back(word.c_str());
  tool.parse(static_cast<int>(c_strings.size()), c_strings.data());
  require_one_command(tool);
  const CLI::App& command = *tool.get_subcommands().front();
  require_nothing_left(command, command.get_name(), tool.remaining(true));
  // A command that has to be given something shows how, if it is given nothing.
  if (words.size() == 2 && command.get_name() != "selftest") return Information{short_help(command), usage_error};
  Arguments arguments = finish.at(command.get_name())();
  std::visit(
      [&](auto& one) {
        if constexpr (requires { one.command_line; }) one.command_line = joined(words);
      },
      arguments);
  return arguments;
}

}  // namespace

Arguments parse_arguments(int count, const char* const* values) {
  const std::vector<std::string> words = with_present_names(count, values).words;
  CLI::App tool("", "patchlight");
  tool.set_version_flag("--version", std::string("patchlight ") + version());
  tool.set_help_flag("-h");
  tool.set_help_all_flag("--help");
  tool.allow_extras();
  const std::map<std::string, Finish> finish = add_commands(tool);
  if (words.size() > 1 && words[1] == "help")
    return Information{words.size() == 2 ? tool_help() : topic_help(tool, words[2])};
  const auto help = [&](auto&& of_command) {
    return Information{tool.get_subcommands().empty() ? tool_help() : of_command(*tool.get_subcommands().front())};
  };
  // The parsing library speaks through its own exceptions; they end here.
  try {
    return parse(tool, finish, words);
  } catch (const CLI::CallForHelp&) {
    return help(short_help);
  } catch (const CLI::CallForAllHelp&) {
    return help(full_help);
  } catch (const CLI::CallForVersion& call) {
    return Information{std::string(call.what()) + "\n"};
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string message = error.what();
    throw UsageError(message + (message.starts_with("--camera") ? std::string("\nhint: ") + camera_example : ""));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace patchlight::cli
