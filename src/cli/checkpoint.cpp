#include "cli/checkpoint.h"

#include "patchlight/base/error.h"

#include <system_error>
#include <utility>

namespace patchlight::cli {

RowBlocksOf row_blocks_kept_in(const std::filesystem::path& folder, const Scene& scene, KeptBlocks& kept) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(folder.string(), "cannot make this folder for --checkpoint: " + error.message());
  return [&, folder](const PatchMesh& mesh, const RayOptions& options, std::span<const float> bright_densities) {
    kept.keys.push_back(row_key(scene, mesh, options, bright_densities));
    RowBlocks blocks = row_blocks_in(folder, kept.keys.back());
    blocks.read = [&, read = std::move(blocks.read)](std::size_t block) {
      auto words = read(block);
      if (words) ++kept.taken;
      return words;
    };
    return blocks;
  };
}

std::string taken_note(const std::filesystem::path& folder, const KeptBlocks& kept) {
  return "--checkpoint: " + std::to_string(kept.taken) + (kept.taken == 1 ? " block of rows" : " blocks of rows") +
         " that an earlier run had kept in " + folder.string();
}

}  // namespace patchlight::cli
