#pragma once

#include <CLI/App.hpp>
#include <string>

namespace patchlight::cli {

/// Adds an option with one value, which `take` understands or refuses.
template <typename Take>
void add(CLI::App& command, const std::string& name, const std::string& value, const std::string& help, Take take) {
  command.add_option_function<std::string>(name, take, help)->option_text(value);
}

}  // namespace patchlight::cli
