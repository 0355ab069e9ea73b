#include "cli/checkpoint.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"

#include <system_error>
#include <utility>

namespace patchlight::cli {

Checkpoint::Checkpoint(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  made_ = std::filesystem::create_directories(folder_, error);
  if (error) throw OutputError(folder_.string(), "cannot make this folder for --checkpoint: " + error.message());
  check_writable(folder_ / "rows.npy");
}

RowBlocksOf Checkpoint::blocks(const RowScene& of) {
  if (folder_.empty()) return {};
  return [this, of](const PatchMesh& mesh, const RayOptions& options, std::span<const float> bright_densities) {
    keys_.push_back(row_key(of, mesh, options, bright_densities));
    RowBlocks blocks = row_blocks_in(folder_, keys_.back());
    blocks.read = [this, read = std::move(blocks.read)](std::size_t block) {
      auto words = read(block);
      if (words) ++taken_;
      return words;
    };
    return blocks;
  };
}

void Checkpoint::remove() const {
  if (folder_.empty()) return;
  remove_row_blocks(folder_, keys_);
  std::error_code ignored;
  if ((made_ || taken_ > 0) && !std::filesystem::is_symlink(folder_, ignored))
    std::filesystem::remove(folder_, ignored);
}

Diagnostics Checkpoint::notes() const {
  if (taken_ == 0) return {};
  return {{DiagnosticCode::checkpoint,
           "--checkpoint: " + std::to_string(taken_) + (taken_ == 1 ? " block of rows" : " blocks of rows") +
               " that an earlier run had kept in " + folder_.string(),
           taken_}};
}

}  // namespace patchlight::cli
