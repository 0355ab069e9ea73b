#include "cli/help.h"

#include "patchlight/base/error.h"

#include "cli/help_texts.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

namespace patchlight::cli {
namespace {

constexpr std::size_t width = 80;

constexpr const char* exit_status =
    "Exit status: 0 success; 1 usage; 2 input; 3 not converged or not accurate enough;\n"
    "4 memory; 5 check failed; 6 output; 130 interrupted. See patchlight help exit-status.\n";

// The text in lines, each after `indent` blanks; the first one begins at the column `begin`.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t begin) {
  std::istringstream words(text);
  std::string result, word;
  std::size_t column = begin;
  while (words >> word) {
    if (column > indent && column + 1 + word.size() > width) {
      result += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += ' ';
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result + '\n';
}

// "-o, --output FILE", "MODEL...".
std::string head(const OptionText& text) {
  std::string names(text.names);
  const std::size_t comma = names.find(',');
  if (comma != names.npos) names.insert(comma + 1, " ");
  if (names == "MODEL") names += "...";
  return names + (text.value.empty() ? "" : ' ' + filled_in(text.value));
}

// The texts of all options of a command, in the order of the table.
std::vector<const OptionText*> texts_of(const CLI::App& command) {
  const auto has = [&](const OptionText& text) {
    const std::string name(text.names.substr(0, text.names.find(',')));
    if (text.names == "-h,--help") return true;
    return command.get_option_no_throw(name) != nullptr && &option_text(command.get_name(), text.names) == &text;
  };
  std::vector<const OptionText*> texts;
  for (const OptionText& text : option_texts())
    if (has(text)) texts.push_back(&text);
  return texts;
}

std::string beside(const std::string& left, const std::string& text, std::size_t column) {
  const std::string line = "  " + left;
  if (line.size() + 2 > column) return line + '\n' + std::string(column, ' ') + wrapped(text, column, column);
  return line + std::string(column - line.size(), ' ') + wrapped(text, column, column);
}

const CommandText& text_of(const CLI::App& command) {
  const auto all = command_texts();
  return *std::find_if(all.begin(), all.end(), [&](const auto& text) { return text.name == command.get_name(); });
}

std::string examples(const CommandText& command) {
  std::istringstream lines{std::string(command.examples)};
  std::string text = "Examples:\n";
  for (std::string line; std::getline(lines, line);) text += "  " + line + '\n';
  return text;
}

std::string beginning(const CommandText& command) {
  return std::string(command.help) + ".\n\nUsage: patchlight " + std::string(command.name) + ' ' +
         std::string(command.usage) + "\n\n";
}

std::string details(const std::vector<const OptionText*>& texts, std::string_view title) {
  std::string result = '\n' + std::string(title) + ":\n";
  for (const OptionText* text : texts) {
    result += "  " + head(*text) + "\n      " + filled_in(text->help) + '\n';
    if (!text->more.empty()) result += "      " + wrapped(filled_in(text->more), 6, 6);
  }
  return result;
}

std::vector<std::string_view> groups_of(const std::vector<const OptionText*>& texts) {
  std::vector<std::string_view> groups;
  for (const OptionText* text : texts)
    if (std::find(groups.begin(), groups.end(), text->group) == groups.end()) groups.push_back(text->group);
  return groups;
}

// Where pages may be: installed beside the program, in a package of their own, or in the sources of a build.
std::vector<std::filesystem::path> folders_of_pages() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const auto documents = program.parent_path() / "share" / "doc";
  return {documents / "patchlight" / "md", documents / "patchlight-doc" / "html",
          program.parent_path().parent_path() / "docs"};
}

// The page whose file has this name, in the first folder that has one; the first by name if there are several.
std::filesystem::path page_named(const std::string& topic) {
  for (const std::filesystem::path& folder : folders_of_pages()) {
    std::error_code error;
    std::vector<std::filesystem::path> found;
    for (std::filesystem::recursive_directory_iterator k(folder, error), end; !error && k != end; k.increment(error)) {
      const std::filesystem::path& file = k->path();
      const bool is_page = file.extension() == ".md" || file.extension() == ".html";
      if (is_page && file.stem() == topic) found.push_back(file);
    }
    if (!found.empty()) return *std::min_element(found.begin(), found.end());
  }
  return {};
}

}  // namespace

std::string tool_help() {
  std::string text =
      "Lighting simulation for rooms and buildings, with an error bar on every value.\n\n"
      "Usage: patchlight COMMAND [ARGUMENTS]\n";
  std::string_view group;
  for (const CommandText& command : command_texts()) {
    if (command.group != group) text += '\n' + std::string(command.group) + ":\n";
    group = command.group;
    text += beside(std::string(command.name), std::string(command.help), 20);
  }
  text += "\nHelp:\n";
  text += beside("COMMAND -h", "Show the common options of a command, with examples", 20);
  text += beside("COMMAND --help", "Show all options of a command", 20);
  text += beside("help TOPIC", "Show a page of the documentation, e.g. daylight", 20);
  text += beside("--version", "Print the version", 20);
  return text + '\n' + exit_status;
}

std::string short_help(const CLI::App& command) {
  const CommandText& about = text_of(command);
  std::string text = beginning(about) + examples(about) + "\nCommon options:\n";
  for (const OptionText* option : texts_of(command)) {
    if (option->level == Level::common && option->names[0] == '-')
      text += beside(head(*option), filled_in(option->help), 26);
  }
  return text + "\npatchlight " + command.get_name() + " --help lists all options.\n";
}

std::string full_help(const CLI::App& command) {
  const CommandText& about = text_of(command);
  std::string text = beginning(about) + wrapped(std::string(about.more), 0, 0) + '\n' + examples(about);
  const std::vector<const OptionText*> all = texts_of(command);
  const auto some = [&](auto&& accepted) {
    std::vector<const OptionText*> chosen;
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), accepted);
    return chosen;
  };
  for (const std::string_view group : groups_of(all)) {
    const auto chosen = some([&](const auto* one) { return one->group == group && one->level != Level::advanced; });
    if (!chosen.empty()) text += details(chosen, group);
  }
  const auto advanced = some([](const auto* one) { return one->level == Level::advanced; });
  if (!advanced.empty()) text += details(advanced, "Advanced");
  return text + '\n' + exit_status;
}

std::string topic_help(const CLI::App& tool, const std::string& topic) {
  for (const CLI::App* command : tool.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == topic) return full_help(*command);
  const std::filesystem::path page = page_named(topic);
  if (page.empty())
    throw InputError("help", "no page '" + topic + "' is installed\nhint: patchlight --help lists the commands");
  if (page.extension() == ".html") return page.string() + '\n';
  std::ostringstream text;
  text << std::ifstream(page, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace patchlight::cli
