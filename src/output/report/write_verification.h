#pragma once

#include "patchlight/output/provenance.h"

#include "study/verify.h"

#include <filesystem>

namespace patchlight {

/// The outcome of a verification as a JSON file; docs/reference/outputs/report-json.md lists the keys. \throws
/// OutputError.
void write_verification(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Verification& verification, const Provenance& provenance);

}  // namespace patchlight
