#pragma once

#include <map>
#include <set>
#include <string>

namespace patchlight {

/// Tells objects of the same name apart: "wall", "wall (2)", "wall (3)".
class UniqueNames {
 public:
  /// The name, with a number if it was returned before. O(log n), expected.
  std::string unique(const std::string& name) {
    std::string found = name;
    int& number = last_.emplace(name, 1).first->second;
    while (!taken_.insert(found).second) found = name + " (" + std::to_string(++number) + ")";
    return found;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  ///< number of a name
};

}  // namespace patchlight
