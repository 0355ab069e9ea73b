#pragma once

#include "patchlight/simulate.h"

#include <memory>
#include <string>
#include <vector>

namespace patchlight {

/// A solved scene, and what it was solved with.
struct SolvedScene {
  std::shared_ptr<const Scene> scene;
  Request request;
  Simulation simulation;
  std::string command_line;
  std::vector<std::string> changes;  ///< see Provenance
};

}  // namespace patchlight
