#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <span>
#include <string>
#include <vector>

namespace patchlight::cli {

/// A field of the library, optionally with its value, and the corresponding option.
struct OptionName {
  std::string field;
  std::string option;
};

/// Replaces library fields in a message by options: "effects.skip=sun" becomes "--disable sun". `other` has precedence
/// over the usual names.
std::string with_option_names(const std::string& text, std::span<const OptionName> other = {});

/// The same in all texts of these, so that reports and pages name options as messages do.
Diagnostics with_option_names(Diagnostics diagnostics);
Scene with_option_names(Scene scene);
Plan with_option_names(Plan plan);
Simulation with_option_names(Simulation simulation);

/// check() for a command with other option names. \throws UsageError.
void check_with_names(const Request& request, std::span<const OptionName> other);

/// A command line with former names of commands and options replaced by the current ones.
struct PresentNames {
  std::vector<std::string> words;    ///< including the program, as in main()
  std::vector<std::string> remarks;  ///< "--force is now --enable", one for each replaced name
};

/// Also replaces British spellings of "color" without a remark. Current names stay unchanged.
PresentNames with_present_names(int count, const char* const* values);

}  // namespace patchlight::cli
