#pragma once

#include <string>
#include <vector>

namespace patchlight::cli {

/// A command line in which earlier names of commands and options are replaced by the present ones.
struct PresentNames {
  std::vector<std::string> words;    ///< the program first, as in main()
  std::vector<std::string> remarks;  ///< "--force is now --enable", one for each name that was replaced
};

/// Spellings with "colour" are replaced too, without a remark. Present names stay as they are.
PresentNames with_present_names(int count, const char* const* values);

}  // namespace patchlight::cli
