#pragma once

#include "patchlight/simulate.h"

#include "archive/ray_row_files.h"
#include "cli/arguments.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The scene to solve, with its request.
struct SolveInput {
  Scene scene;
  Request request;
  ExchangeOf exchange = {};         ///< reads stored form factors; empty: computed
  RayExchangeOf ray_exchange = {};  ///< reads stored rows of the ray method; empty: traced
};

/// Reads the scene from the models, or without models from the folder of form factors. Stored form factors override the
/// options that they depend on. \throws InputError.
SolveInput read_input(const SolveArguments& arguments);

/// Adds the points of --points to the sensors of the scene. \throws InputError.
Scene with_points(Scene scene, const SolveArguments& arguments);

/// The named files for readings, else the default file if the scene has sensors. \throws InputError when a file is
/// named but there are no sensors.
std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene);

/// The folder of --checkpoint, and its blocks of rows in this run.
class Checkpoint {
 public:
  Checkpoint() = default;
  /// Creates a missing folder. \throws OutputError when it is not writable.
  explicit Checkpoint(std::filesystem::path folder);

  /// Its blocks; empty without a folder. The checkpoint and the scene must outlive them.
  RowBlocksOf blocks(const RowScene& of);

  /// Removes the blocks of this run, and the folder if this run created it and it is empty.
  void remove() const;

  /// Notes the number of blocks kept by an earlier run; empty if there are none.
  Diagnostics notes() const;

 private:
  std::filesystem::path folder_;
  bool made_ = false;
  std::vector<std::string> keys_;
  std::size_t taken_ = 0;
};

}  // namespace patchlight::cli
