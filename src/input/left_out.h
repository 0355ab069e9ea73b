#pragma once

#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// What a reader leaves out or simplifies: sentences, and the names of what each is true of.
class LeftOut {
 public:
  void add(const std::string& sentence, const std::string& name);

  /// "sentence: 7 (a, b, c, ...)", with the first five names, each once; in the order in which the sentences came.
  std::vector<std::string> notes() const;

 private:
  struct Names {
    std::size_t count = 0;
    std::vector<std::string> first;
  };
  std::vector<std::pair<std::string, Names>> sentences_;
};

}  // namespace patchlight
