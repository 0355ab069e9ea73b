#pragma once

#include "patchlight/plan/plan.h"

#include <span>
#include <string>

namespace patchlight::cli {

/// What the library calls a field, perhaps with its value, and the option that fills it.
struct OptionName {
  std::string field;
  std::string option;
};

/// A message of the library with the options in place of its fields: "--disable sun" for "effects.skip=sun". `other`
/// takes precedence over the names that most commands have.
std::string with_option_names(const std::string& text, std::span<const OptionName> other = {});

/// check() for a command that calls some options otherwise. \throws UsageError.
void check_with_names(const Request& request, std::span<const OptionName> other);

}  // namespace patchlight::cli
