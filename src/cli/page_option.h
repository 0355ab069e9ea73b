#pragma once

#include "cli/distinct_files.h"

#include <CLI/App.hpp>
#include <string>

namespace patchlight::cli {

/// Adds --html, which lands in `page`; it must outlive the command.
void add_page_option(CLI::App& command, std::string& page);

/// \throws UsageError when the page would lie in the folder that the command replaces as a whole.
void require_page_elsewhere(const std::filesystem::path& page, const std::filesystem::path& folder);

}  // namespace patchlight::cli
