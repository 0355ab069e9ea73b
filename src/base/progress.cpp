#include "patchlight/base/progress.h"

#include <array>
#include <cstddef>

namespace patchlight {

const char* name_of(Stage stage) {
  constexpr std::array names = {"read",  "plan",       "mesh",   "form factors", "closure", "direct light",
                                "solve", "error bars", "gather", "trace paths",  "render",  "write"};
  static_assert(names.size() == static_cast<std::size_t>(Stage::write) + 1);
  return names.at(static_cast<std::size_t>(stage));
}

}  // namespace patchlight
