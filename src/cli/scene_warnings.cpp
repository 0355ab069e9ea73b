#include "cli/scene_warnings.h"

#include "cli/messages.h"

namespace patchlight::cli {

void print_scene_warnings(const Scene& scene) {
  for (const std::string& warning : warnings_of(scene)) print_message("warning", scene.file + ": " + warning);
}

}  // namespace patchlight::cli
