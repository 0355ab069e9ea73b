#include "patchlight/base/progress.h"

#include <array>

namespace patchlight {

const char* name_of(Stage stage) {
  constexpr std::array names = {"read",  "plan",       "mesh",   "form factors", "closure", "direct light",
                                "solve", "error bars", "gather", "trace paths",  "render",  "write"};
  return names.at(static_cast<std::size_t>(stage));
}

}  // namespace patchlight
