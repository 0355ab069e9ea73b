#pragma once

#include "patchlight/simulate.h"

#include "archive/ray_row_files.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The folder of --checkpoint, and what became of its blocks of rows in this run.
class Checkpoint {
 public:
  Checkpoint() = default;
  /// Makes the folder if it is not there. \throws OutputError when it cannot be written into.
  explicit Checkpoint(std::filesystem::path folder);

  /// Its blocks; empty without a folder. This and the scene must outlive them.
  RowBlocksOf blocks(const RowScene& of);

  /// Removes the blocks of this run, and the folder when this has made it and nothing else is in it.
  void remove() const;

  /// Says how many blocks an earlier run had kept; empty: none.
  Diagnostics notes() const;

 private:
  std::filesystem::path folder_;
  bool made_ = false;
  std::vector<std::string> keys_;
  std::size_t taken_ = 0;
};

}  // namespace patchlight::cli
