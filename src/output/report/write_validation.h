#pragma once

#include "validate/validate.h"

#include <filesystem>
#include <span>
#include <string>

namespace patchlight {

/// The outcome of a validation as JSON. docs/reference/outputs/report-json.md lists the keys.
std::string validation_json(std::span<const ValidationResult> results);

/// The same as a file. \throws OutputError.
void write_validation(const std::filesystem::path& file, std::span<const ValidationResult> results);

}  // namespace patchlight
