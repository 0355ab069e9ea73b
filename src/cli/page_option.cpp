#include "cli/page_option.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"

namespace patchlight::cli {

void add_page_option(CLI::App& command, std::string& page) {
  add(command, "--html", "FILE",
      "one page for any browser, which needs no other file: the model\nto turn around, values, tables, pictures "
      "(.html); default: none",
      [&page](const std::string& text) {
        if (std::filesystem::path(text).extension() != ".html")
          throw refusal("--html", text, "a name that ends in .html");
        page = text;
      });
}

void require_page_elsewhere(const std::filesystem::path& page, const std::filesystem::path& folder) {
  if (page.empty()) return;
  const auto folder_of = [](const std::filesystem::path& file) {
    std::error_code error;
    return weakly_canonical(absolute(file), error).parent_path();
  };
  // The folder need not be there yet.
  if (folder_of(page) != folder_of(folder / "file")) return;
  throw UsageError("--html: '" + page.string() + "' lies in the folder of -o; expected a file elsewhere");
}

}  // namespace patchlight::cli
