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
  ExchangeOf exchange = {};         ///< reads stored form factors; empty: they are computed
  RayExchangeOf ray_exchange = {};  ///< reads stored rows of rays; empty: they are traced
};

/// Reads the scene from the models, or where there are none from the folder of form factors. Stored form factors bring
/// the options that they were made with. \throws InputError.
SolveInput read_input(const SolveArguments& arguments);

/// Adds the points of --points to the sensors of the scene. \throws InputError.
Scene with_points(Scene scene, const SolveArguments& arguments);

/// The file of the readings: the one that the arguments name, else their default where the scene has sensors. \throws
/// InputError when an output is named but nothing is to be read.
std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene);

/// The folder of --checkpoint, and the fate of its blocks of rows in this run.
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
