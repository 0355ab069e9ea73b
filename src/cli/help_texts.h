#pragma once

#include <CLI/App.hpp>
#include <span>
#include <string>
#include <string_view>

// All texts of the help, the manual pages and the command-line reference stand in help_texts.cpp.
namespace patchlight::cli {

/// Who needs an option: `-h` shows the common ones, `--help` all, the advanced ones last.
enum class Level { common, usual, advanced };

struct OptionText {
  std::string_view names;     ///< "-o,--output"; "MODEL" for an argument without a dash
  std::string_view commands;  ///< names of the commands that have this text, with blanks in between; empty: all others
  std::string_view group;
  Level level;
  std::string_view value;  ///< "FILE"; empty for a flag
  std::string_view help;   ///< one line of at most 80 characters
  std::string_view more;   ///< paragraphs with details and an example; may be empty
};

struct CommandText {
  std::string_view name;
  std::string_view group;     ///< of the list of commands
  std::string_view help;      ///< one line
  std::string_view usage;     ///< "MODEL... -o RESULT.vtp [OPTIONS]"
  std::string_view more;      ///< paragraphs
  std::string_view examples;  ///< a line for each, "# meaning" before it
};

/// In the order in which the help lists them.
std::span<const CommandText> command_texts();
std::span<const OptionText> option_texts();

/// The text of an option ("--max-edge", "-o,--output", "MODEL") of a command. Every option has one.
const OptionText& option_text(std::string_view command, std::string_view name);

/// "{solvers}", "{formats}" and other names of lists and numbers replaced by these.
std::string filled_in(std::string_view text);

/// The commands in their groups: `patchlight --help`.
std::string tool_help();

/// Usage, examples and the options that most people use, at most 50 lines: `patchlight COMMAND -h`.
std::string short_help(const CLI::App& command);

/// All options with their details, the advanced ones last: `patchlight COMMAND --help`.
std::string full_help(const CLI::App& command);

/// `patchlight help TOPIC`: help of a command, or a page of the documentation. \throws InputError without such a page.
std::string topic_help(const CLI::App& tool, const std::string& topic);

}  // namespace patchlight::cli
