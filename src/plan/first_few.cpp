#include "plan/first_few.h"

#include <algorithm>

namespace patchlight {

std::string first_few(std::span<const std::string> names) {
  constexpr std::size_t few = 8;
  std::string list;
  for (std::size_t k = 0; k < std::min(few, names.size()); ++k) list += (k > 0 ? ", " : "") + names[k];
  return names.size() > few ? list + " and " + std::to_string(names.size() - few) + " more" : list;
}

}  // namespace patchlight
