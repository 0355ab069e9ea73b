#pragma once

#include "cli/help_texts.h"

#include <CLI/App.hpp>
#include <string>
#include <vector>

// Options with the texts of help_texts.h. A name is written as there: "--max-edge" or "-o,--output".
namespace patchlight::cli {

/// Adds an option with one value, which `take` accepts or refuses.
template <typename Take>
CLI::Option* add(CLI::App& command, const std::string& name, Take take) {
  option_text(command.get_name(), name);  // it has one
  return command.add_option_function<std::string>(name, take);
}

/// Adds an option that may be repeated; its values land in `values`.
inline CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<std::string>& values) {
  option_text(command.get_name(), name);
  return command.add_option(name, values)->allow_extra_args(name[0] != '-');
}

/// Adds an option without a value, which calls `given`.
template <typename Given>
CLI::Option* add_flag(CLI::App& command, const std::string& name, Given given) {
  option_text(command.get_name(), name);
  return command.add_flag_callback(name, given);
}

}  // namespace patchlight::cli
