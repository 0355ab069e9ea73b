#include "input/left_out.h"

#include "input/text.h"

#include <algorithm>

namespace patchlight {
namespace {

constexpr std::size_t most_names = 5;

}  // namespace

void LeftOut::add(const std::string& sentence, const std::string& name) {
  auto found =
      std::find_if(sentences_.begin(), sentences_.end(), [&](const auto& one) { return one.first == sentence; });
  if (found == sentences_.end()) found = sentences_.insert(found, {sentence, {}});
  Names& names = found->second;
  ++names.count;
  const bool is_known = std::find(names.first.begin(), names.first.end(), name) != names.first.end();
  if (names.first.size() < most_names && !is_known) names.first.push_back(name);
}

std::vector<std::string> LeftOut::notes() const {
  std::vector<std::string> all;
  for (const auto& [sentence, names] : sentences_) {
    const char* const more = names.count > names.first.size() ? ", ..." : "";
    all.push_back(sentence + ": " + std::to_string(names.count) + " (" + listed(names.first) + more + ")");
  }
  return all;
}

}  // namespace patchlight
