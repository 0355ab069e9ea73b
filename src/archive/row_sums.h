#pragma once

#include "archive/form_factor_files.h"

#include <filesystem>

namespace patchlight {

/// Stored form factors have the row sums that were stored with them, or those that closure makes of them.
/// \throws InputError that names the file and the first row where it is not so.
void require_row_sums(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh,
                      const Exchange& exchange);

}  // namespace patchlight
