#pragma once

#include <CLI/App.hpp>
#include <span>
#include <string>
#include <string_view>

// All texts of the help, the manual pages and the command-line reference stand in help_texts.cpp.
namespace patchlight::cli {

/// The audience of an option. `-h` lists common options; `--help` lists all, with the advanced ones last.
enum class Level { common, usual, advanced };

struct OptionText {
  std::string_view names;     ///< "-o,--output"; "MODEL" for an argument without a dash
  std::string_view commands;  ///< commands that use this text, separated by blanks; empty: all others
  std::string_view group;
  Level level;
  std::string_view value;  ///< "FILE"; empty for a flag
  std::string_view help;   ///< one line of at most 80 characters
  std::string_view more;   ///< paragraphs with details and an example; may be empty
};

struct CommandText {
  std::string_view name;
  std::string_view group;     ///< in the list of commands
  std::string_view help;      ///< one line
  std::string_view usage;     ///< "MODEL... -o RESULT.vtp [OPTIONS]"
  std::string_view more;      ///< paragraphs
  std::string_view examples;  ///< one per line, preceded by "# meaning"
};

/// In the order of the help.
std::span<const CommandText> command_texts();
std::span<const OptionText> option_texts();

/// The text of an option ("--max-edge", "-o,--output", "MODEL") of a command. Every option has one.
const OptionText& option_text(std::string_view command, std::string_view name);

/// Replaces "{solvers}", "{formats}" and other placeholders by lists and numbers.
std::string filled_in(std::string_view text);

/// The grouped list of commands: `patchlight --help`.
std::string tool_help();

/// Usage, examples and common options, at most 50 lines: `patchlight COMMAND -h`.
std::string short_help(const CLI::App& command);

/// All options with details, the advanced ones last: `patchlight COMMAND --help`.
std::string full_help(const CLI::App& command);

/// `patchlight help TOPIC`: help of a command, or a page of the documentation. \throws InputError without such a page.
std::string topic_help(const CLI::App& tool, const std::string& topic);

}  // namespace patchlight::cli
