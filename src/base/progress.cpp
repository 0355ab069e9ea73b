#include "patchlight/base/progress.h"

namespace patchlight {

const char* name_of(Stage stage) {
  switch (stage) {
    case Stage::read:
      return "read";
    case Stage::plan:
      return "plan";
    case Stage::mesh:
      return "mesh";
    case Stage::form_factors:
      return "form factors";
    case Stage::closure:
      return "closure";
    case Stage::direct_light:
      return "direct light";
    case Stage::solve:
      return "solve";
    case Stage::error_bars:
      return "error bars";
    case Stage::gather:
      return "gather";
    case Stage::trace_paths:
      return "trace paths";
    case Stage::render:
      return "render";
    case Stage::write:
      return "write";
  }
  return "";
}

}  // namespace patchlight
