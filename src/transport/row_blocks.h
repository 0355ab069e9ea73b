#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Where blocks of rows are kept while they are traced, so that a run that was stopped goes on where it was: one block
/// for every `patches_of_a_block` patches, the last of them shorter. What stands in a block is known to trace_rows()
/// alone. keep() is called from several threads, for different blocks.
struct RowBlocks {
  static constexpr PatchIndex patches_of_a_block = 4096;

  std::function<std::optional<std::vector<std::int32_t>>(std::size_t block)> read;  ///< nothing: not kept
  std::function<void(std::size_t block, std::span<const std::int32_t> words)> keep;
};

}  // namespace patchlight
