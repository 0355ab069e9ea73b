#pragma once

#include "patchlight/plan/plan.h"

#include <span>
#include <string>
#include <vector>

namespace patchlight::cli {

/// A field of the library, perhaps with its value, and the option that fills it.
struct OptionName {
  std::string field;
  std::string option;
};

/// A message of the library with the options in place of its fields: "--disable sun" for "effects.skip=sun". `other`
/// takes precedence over the names that most commands have.
std::string with_option_names(const std::string& text, std::span<const OptionName> other = {});

/// check() for a command that calls some options otherwise. \throws UsageError.
void check_with_names(const Request& request, std::span<const OptionName> other);

/// A command line in which earlier names of commands and options are replaced by the present ones.
struct PresentNames {
  std::vector<std::string> words;    ///< the program first, as in main()
  std::vector<std::string> remarks;  ///< "--force is now --enable", one for each name that was replaced
};

/// Spellings with "colour" are replaced too, without a remark. Present names stay as they are.
PresentNames with_present_names(int count, const char* const* values);

}  // namespace patchlight::cli
