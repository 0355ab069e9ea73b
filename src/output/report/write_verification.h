#pragma once

#include "patchlight/output/provenance.h"

#include "study/verify.h"
#include "validate/validate.h"

#include <filesystem>
#include <span>
#include <string>

namespace patchlight {

/// The outcome of a validation as JSON. docs/reference/outputs/report-json.md lists the keys.
std::string validation_json(std::span<const ValidationResult> results);

/// The same as a file. \throws OutputError.
void write_validation(const std::filesystem::path& file, std::span<const ValidationResult> results);

/// The outcome of a verification as a JSON file; docs/reference/outputs/report-json.md lists the keys. \throws
/// OutputError.
void write_verification(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Verification& verification, const Provenance& provenance);

}  // namespace patchlight
