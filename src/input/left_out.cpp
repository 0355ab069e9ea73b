#include "input/left_out.h"

#include "input/text.h"

#include <algorithm>

namespace patchlight {
namespace {

constexpr std::size_t most_names = 5;

}  // namespace

LeftOut::Sentences LeftOut::with(Sentences sentences, const std::string& sentence, const std::string& name) {
  auto found = std::find_if(sentences.begin(), sentences.end(), [&](const auto& one) { return one.first == sentence; });
  if (found == sentences.end()) found = sentences.insert(found, {sentence, {}});
  Names& names = found->second;
  ++names.count;
  const bool is_known = std::find(names.first.begin(), names.first.end(), name) != names.first.end();
  if (names.first.size() < most_names && !is_known) names.first.push_back(name);
  return sentences;
}

std::string LeftOut::listed_names(const std::string& sentence, const Names& names) {
  const char* const more = names.count > names.first.size() ? ", ..." : "";
  return sentence + ": " + std::to_string(names.count) + " (" + listed(names.first) + more + ")";
}

void LeftOut::add(const std::string& sentence, const std::string& name) {
  remarks_ = with(std::move(remarks_), sentence, name);
}

void LeftOut::lose(const std::string& sentence, const std::string& name) {
  losses_ = with(std::move(losses_), sentence, name);
}

std::vector<std::string> LeftOut::notes() const {
  std::vector<std::string> all;
  for (const auto& [sentence, names] : remarks_) all.push_back(listed_names(sentence, names));
  return all;
}

std::vector<Problem> LeftOut::problems() const {
  std::vector<Problem> all;
  for (const auto& [sentence, names] : losses_)
    all.push_back({ProblemKind::left_out, names.count, listed_names(sentence, names), {}});
  return all;
}

}  // namespace patchlight
