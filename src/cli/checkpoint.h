#pragma once

#include "patchlight/simulate.h"

#include "archive/row_block_files.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// What was kept of a run with --checkpoint.
struct KeptBlocks {
  std::vector<std::string> keys;  ///< of all rows that were traced, row_key()
  std::size_t taken = 0;          ///< blocks that an earlier run had kept
};

/// The blocks of rows in a folder, which is made if it is not there. Adds to `kept` what becomes of them; both
/// references must outlive it. \throws OutputError.
RowBlocksOf row_blocks_kept_in(const std::filesystem::path& folder, const Scene& scene, KeptBlocks& kept);

/// Says how many blocks came from the folder.
std::string taken_note(const std::filesystem::path& folder, const KeptBlocks& kept);

}  // namespace patchlight::cli
