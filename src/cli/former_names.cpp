#include "cli/option_names.h"
#include "cli/parse_value.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace patchlight::cli {
namespace {

// A name of an earlier version; an option may include one of its values.
struct FormerName {
  std::string_view command;  // current name of the command that had it; empty: any
  std::string_view former;
  std::string_view present;  // empty: removed without replacement
};

// Options with a value come before those without. Remove this table with version 0.2.
constexpr std::array former_commands = {
    FormerName{"", "validate", "selftest"},       FormerName{"", "verify", "crosscheck"}, FormerName{"", "new", "init"},
    FormerName{"", "compare", "compare-solvers"}, FormerName{"", "study", "convergence"},
};

constexpr std::array former_options = {
    FormerName{"", "--force closure", ""},
    FormerName{"", "--enable closure", ""},
    FormerName{"", "--skip closure", "--no-closure"},
    FormerName{"", "--disable closure", "--no-closure"},
    FormerName{"", "--force", "--enable"},
    FormerName{"", "--skip", "--disable"},
    FormerName{"", "--storage tiles", "--method pairs"},
    FormerName{"", "--storage", "--method"},
    FormerName{"", "--on-demand", "--method on-demand"},
    FormerName{"form-factors", "--raw", "--no-closure"},
    FormerName{"", "--report", "--json"},
    FormerName{"check", "--vtk", "--problems"},
    FormerName{"", "--keep-mesh", "--no-refine"},
    FormerName{"", "--keep-faces", "--no-merge"},
    FormerName{"", "--leave-out", "--exclude"},
    FormerName{"", "--time", "--time-limit"},
    FormerName{"crosscheck", "--bar", "--margin"},
    FormerName{"crosscheck", "--checked", "--sample-patches"},
    FormerName{"", "--interest", "--focus"},
    FormerName{"", "--detail", "--simplify"},
    FormerName{"", "--quality", "--picture-quality"},
};

// "--skip" and "closure", from one word with "=" or from two words.
struct Typed {
  std::string option;
  std::string value;      // empty if absent
  bool in_one = false;    // "--skip=closure"
  std::size_t words = 1;  // number of words, including the value
};

Typed typed_at(const std::vector<std::string>& words, std::size_t k) {
  const std::size_t sign = words[k].find('=');
  if (sign != std::string::npos) return {words[k].substr(0, sign), words[k].substr(sign + 1), true, 1};
  if (k + 1 == words.size()) return {words[k], "", false, 1};
  return {words[k], words[k + 1], false, 2};
}

const FormerName* former_name(const Typed& typed, const std::string& command) {
  const auto found = std::find_if(former_options.begin(), former_options.end(), [&](const FormerName& name) {
    if (!name.command.empty() && name.command != command) return false;
    return name.former == typed.option || name.former == typed.option + ' ' + typed.value;
  });
  return found == former_options.end() ? nullptr : &*found;
}

std::string with_american_spelling(std::string text) {
  for (std::size_t at = text.find("colour"); at != std::string::npos; at = text.find("colour"))
    text.replace(at, 6, "color");
  return text;
}

// Replaces `colour` in options and names of effects only.
void spell_color(std::vector<std::string>& words, std::size_t k) {
  const std::size_t end = std::min(words[k].find('='), words[k].size());
  words[k] = with_american_spelling(words[k].substr(0, end)) + words[k].substr(end);
  for (const char* option : {"--enable", "--disable", "--force", "--skip"}) {
    if (words[k] == option && k + 1 < words.size() && words[k + 1] == "colour") words[k + 1] = "color";
    if (words[k] == std::string(option) + "=colour") words[k] = std::string(option) + "=color";
  }
}

std::string remark(const FormerName& name) {
  if (name.present.empty()) return std::string(name.former) + " is the default now";
  return std::string(name.former) + " is now " + std::string(name.present);
}

void take_present_name(PresentNames& names, const FormerName& name, const Typed& typed) {
  for (std::string& word : split(std::string(name.present))) names.words.push_back(std::move(word));
  if (typed.in_one && name.former == typed.option) names.words.back() += '=' + typed.value;
}

}  // namespace

PresentNames with_present_names(int count, const char* const* values) {
  std::vector<std::string> given(values, values + count);
  PresentNames names;
  std::string command;
  std::size_t k = 0;
  if (!given.empty()) names.words.push_back(given[k++]);
  while (k < given.size() && given[k] != "--") {
    if (!given[k].starts_with("--")) {
      const auto former = std::find_if(former_commands.begin(), former_commands.end(),
                                       [&](const FormerName& name) { return name.former == given[k]; });
      const bool is_former = command.empty() && former != former_commands.end();
      if (is_former) names.remarks.push_back(remark(*former));
      names.words.push_back(is_former ? std::string(former->present) : given[k]);
      if (command.empty()) command = names.words.back();
      ++k;
      continue;
    }
    spell_color(given, k);
    const Typed typed = typed_at(given, k);
    const FormerName* const former = former_name(typed, command);
    if (former == nullptr) {
      names.words.push_back(given[k++]);
      continue;
    }
    names.remarks.push_back(remark(*former));
    take_present_name(names, *former, typed);
    k += former->former == typed.option ? 1 : typed.words;
  }
  names.words.insert(names.words.end(), given.begin() + static_cast<std::ptrdiff_t>(k), given.end());
  return names;
}

}  // namespace patchlight::cli
