#pragma once

#include "patchlight/scene/problem.h"

#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// Things of a file that a reader leaves out or simplifies: sentences, each with the names of the objects concerned.
class LeftOut {
 public:
  /// A remark: the file means it so, or the result hardly changes.
  void add(const std::string& sentence, const std::string& name);

  /// A loss: the scene lacks a whole object or light source of the file.
  void lose(const std::string& sentence, const std::string& name);

  /// The remarks, "sentence: 7 (a, b, c, ...)", with the first five names, each once; in the order of the first add().
  std::vector<std::string> notes() const;

  /// The losses in the same words, as problems of the kind left_out.
  std::vector<Problem> problems() const;

 private:
  struct Names {
    std::size_t count = 0;
    std::vector<std::string> first;
  };
  using Sentences = std::vector<std::pair<std::string, Names>>;

  static Sentences with(Sentences sentences, const std::string& sentence, const std::string& name);
  static std::string listed_names(const std::string& sentence, const Names& names);

  Sentences remarks_;
  Sentences losses_;
};

}  // namespace patchlight
