#include "cli/arguments.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "base/words.h"
#include "cli/help_texts.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/output_options.h"
#include "input/read_model.h"
#include "input/text.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>
#include <system_error>

namespace patchlight::cli {
namespace {

constexpr const char* exit_status =
    "Exit status: 0 success; 1 usage; 2 input; 3 not converged or not accurate enough;\n"
    "4 memory; 5 check failed; 6 output; 130 interrupted. See patchlight help exit-status.\n";

// Breaks the text into lines of at most 80 columns, each indented by `indent`; the first line starts at column `begin`.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t begin) {
  std::istringstream words(text);
  std::string result, word;
  std::size_t column = begin;
  while (words >> word) {
    if (column > indent && column + 1 + word.size() > 80) {
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

// The texts of all options of a command, in table order.
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

// Folders that may contain pages: installed beside the program, in a separate package, or in the sources of a build.
std::vector<std::filesystem::path> folders_of_pages() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const auto documents = program.parent_path() / "share" / "doc";
  return {documents / "patchlight" / "md", documents / "patchlight-doc" / "html",
          program.parent_path().parent_path() / "docs"};
}

// The page with this file name, or the index of the folder with this name, in the first folder that has one. If there
// are several, the one in the fewest folders.
std::filesystem::path page_named(const std::string& topic) {
  for (const std::filesystem::path& folder : folders_of_pages()) {
    std::error_code error;
    std::vector<std::filesystem::path> found;
    for (std::filesystem::recursive_directory_iterator k(folder, error), end; !error && k != end; k.increment(error)) {
      const std::filesystem::path& file = k->path();
      const bool is_page = file.extension() == ".md" || file.extension() == ".html";
      const bool is_index = file.stem() == "index" && file.parent_path().filename() == topic;
      if (is_page && (is_index || file.stem() == topic)) found.push_back(file);
    }
    const auto depth = [](const std::filesystem::path& page) { return std::distance(page.begin(), page.end()); };
    const auto is_before = [&](const auto& one, const auto& other) {
      return std::pair(depth(one), one) < std::pair(depth(other), other);
    };
    if (!found.empty()) return *std::min_element(found.begin(), found.end(), is_before);
  }
  return {};
}

// ": did you mean --max-edge?" if an option differs by at most two letters; empty otherwise.
std::string near_option(const CLI::App& command, const std::string& unknown) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string nearest = near_match(unknown.substr(0, unknown.find('=')), names);
  return nearest.empty() ? "" : ": did you mean " + nearest + "?";
}

// The hint for an option of other commands.
std::string other_option(const std::string& command, const std::string& unknown) {
  const bool is_picture = command == "render" && (unknown == "--picture" || unknown.starts_with("--picture="));
  return is_picture ? "\nhint: -o VIEW.png names the image of patchlight render" : "";
}

// Refuses words that no option or positional argument uses; names an unknown option rather than its value.
void require_nothing_left(const CLI::App& command, const std::string& name, std::vector<std::string> left) {
  std::erase(left, "--");  // ends the options
  if (left.empty()) return;
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  const auto unknown = std::find_if(left.begin(), left.end(), is_option);
  if (unknown != left.end()) {
    const std::string other = other_option(name, *unknown);
    const std::string hint = other.empty() ? near_option(command, *unknown) : other;
    throw UsageError(name + ": unknown option " + *unknown +
                     (hint.empty() ? "\nhint: patchlight " + name + " --help lists the options" : hint));
  }
  throw UsageError(name + ": unexpected argument '" + left.front() + "'");
}

// The command line, quoted for a shell.
std::string joined(const std::vector<std::string>& words) {
  std::string line = "patchlight";
  for (std::size_t k = 1; k < words.size(); ++k) line += ' ' + shell_word(words[k]);
  return line;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const CommandText& command : command_texts()) names.emplace_back(command.name);
  return names;
}

bool names_a_model(const std::filesystem::path& file) {
  const std::vector<std::string> formats = readable_formats();
  return file != "-" && std::find(formats.begin(), formats.end(), format_of(file)) != formats.end();
}

// Refuses a file in place of a command. The hint repeats the words with a command and, without options, adds a result
// named after the file.
void refuse_file(const std::vector<std::string>& words) {
  const std::filesystem::path file = words.front();
  std::error_code error;
  const bool is_model = names_a_model(file);
  if (!is_model && !std::filesystem::is_regular_file(file, error)) return;
  std::string line = "patchlight solve";
  for (const std::string& word : words) line += ' ' + shell_word(word);
  if (std::none_of(words.begin(), words.end(), [](const std::string& word) { return word.starts_with('-'); }))
    line += " -o " + shell_word(file.stem().string() + ".vtp");
  throw UsageError("'" + words.front() +
                   "' is a file, not a command\nhint: " + (is_model ? line : "patchlight --help lists the commands"));
}

void require_one_command(const CLI::App& tool) {
  if (tool.get_subcommands().size() == 1) return;
  const std::string list = listed(command_names());
  const std::vector<std::string> left = tool.remaining();
  if (!left.empty() && left.front()[0] == '-')
    throw UsageError("unknown option " + left.front() + "; expected a command: " + list);
  if (!left.empty()) {
    refuse_file(left);
    throw UsageError("unknown command '" + left.front() + "'; expected one of " + list +
                     suggestion(left.front(), command_names()));
  }
  throw UsageError("no command given; expected one of " + list + "\nhint: patchlight --help");
}

// Adds all commands to the tool, and returns their functions to finish parsing.
std::map<std::string, Finish> add_commands(CLI::App& tool) {
  std::map<std::string, Finish> finish = {{"check", add_check(tool)},
                                          {"init", add_init(tool)},
                                          {"solve", add_solve(tool)},
                                          {"render", add_render(tool)},
                                          {"plan", add_plan(tool)},
                                          {"crosscheck", add_crosscheck(tool)},
                                          {"annual", add_annual(tool)},
                                          {"relight", add_relight(tool)},
                                          {"form-factors", add_form_factors(tool)},
                                          {"compare-solvers", add_compare_solvers(tool)},
                                          {"convergence", add_convergence(tool)},
                                          {"selftest", add_selftest(tool)}};
  for (CLI::App* command : tool.get_subcommands({})) command->allow_extras();
  return finish;
}

Arguments parse(CLI::App& tool, const std::map<std::string, Finish>& finish, const std::vector<std::string>& words) {
  std::vector<const char*> c_strings;
  for (const std::string& word : words) c_strings.push_back(word.c_str());
  tool.parse(static_cast<int>(c_strings.size()), c_strings.data());
  require_one_command(tool);
  const CLI::App& command = *tool.get_subcommands().front();
  require_nothing_left(command, command.get_name(), tool.remaining(true));
  // A command that requires arguments prints its short help if it has none.
  if (words.size() == 2 && command.get_name() != "selftest") return Information{short_help(command), usage_error};
  Arguments arguments = finish.at(command.get_name())();
  std::visit(
      [&](auto& one) {
        if constexpr (requires { one.command_line; }) one.command_line = joined(words);
      },
      arguments);
  return arguments;
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
    throw InputError("help", "no page '" + topic + "' is installed\nhint: patchlight help index lists the pages");
  if (page.extension() == ".html") return page.string() + '\n';
  std::ostringstream text;
  text << std::ifstream(page, std::ios::binary).rdbuf();
  return text.str();
}

Arguments parse_arguments(int count, const char* const* values) {
  const std::vector<std::string> words = with_present_names(count, values).words;
  CLI::App tool("", "patchlight");
  tool.set_version_flag("--version", std::string("patchlight ") + version());
  tool.set_help_flag("-h");
  tool.set_help_all_flag("--help");
  tool.allow_extras();
  const std::map<std::string, Finish> finish = add_commands(tool);
  if (words.size() > 1 && words[1] == "help")
    return Information{words.size() == 2 ? tool_help() : topic_help(tool, words[2])};
  const auto help = [&](auto&& of_command) {
    return Information{tool.get_subcommands().empty() ? tool_help() : of_command(*tool.get_subcommands().front())};
  };
  // Exceptions of the parsing library end here.
  try {
    return parse(tool, finish, words);
  } catch (const CLI::CallForHelp&) {
    return help(short_help);
  } catch (const CLI::CallForAllHelp&) {
    return help(full_help);
  } catch (const CLI::CallForVersion& call) {
    return Information{std::string(call.what()) + "\n"};
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string message = error.what();
    throw UsageError(message + (message.starts_with("--camera") ? std::string("\nhint: ") + camera_example : ""));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace patchlight::cli
