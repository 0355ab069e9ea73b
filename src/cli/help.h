#pragma once

#include <CLI/App.hpp>
#include <string>

namespace patchlight::cli {

/// The commands in their groups: `patchlight --help`.
std::string tool_help();

/// Usage, examples and the options that most people use, at most 50 lines: `patchlight COMMAND -h`.
std::string short_help(const CLI::App& command);

/// All options with their details, the advanced ones last: `patchlight COMMAND --help`.
std::string full_help(const CLI::App& command);

/// `patchlight help TOPIC`: help of a command, or a page of the documentation. \throws InputError without such a page.
std::string topic_help(const CLI::App& tool, const std::string& topic);

}  // namespace patchlight::cli
