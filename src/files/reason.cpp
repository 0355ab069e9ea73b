#include "files/reason.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace patchlight {

void require_regular_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return;
  const char* const what = std::filesystem::is_directory(status) ? "folder"
                           : std::filesystem::is_fifo(status)    ? "pipe"
                                                                 : "device";
  throw InputError(file.string(), std::string("is a ") + what + "; expected a regular file");
}

namespace {

constexpr const char* too_large = "a size in it needs more memory than there is";

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

// "[json.exception.out_of_range.403] key 'rooms' not found" names the key; other faults have only the text of the
// library.
std::string reason_of_json(const std::string& text) {
  const std::size_t begin = text.find("key '");
  const std::size_t end = begin == std::string::npos ? begin : text.find('\'', begin + 5);
  if (contains(text, "out_of_range.403") && end != std::string::npos)
    return "it has no key " + text.substr(begin + 4, end - begin - 3);
  if (contains(text, ".out_of_range.")) return "a number in it is out of range";
  if (contains(text, ".type_error.")) return "a value in it has the wrong type";
  const std::size_t line = text.find("at line ");
  const std::size_t colon = line == std::string::npos ? line : text.find(':', line);
  if (colon == std::string::npos) return "it is not JSON";
  return "it is not JSON " + text.substr(line, colon - line);
}

}  // namespace

std::string reason_of(const std::exception& error) {
  const bool is_of_size = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                          dynamic_cast<const std::length_error*>(&error) != nullptr;
  return is_of_size ? too_large : reason_of(std::string(error.what()));
}

std::string reason_of(const std::string& library_text) {
  std::string text = library_text;
  while (text.ends_with('\n')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (contains(text, "[json.exception")) return reason_of_json(text);
  if (contains(text, "bad_alloc") || contains(text, "length_error")) return too_large;
  if (contains(text, "::_M_") || contains(text, "__n (which") || contains(text, "out_of_range"))
    return "a number in it refers to nothing";
  return text;
}

}  // namespace patchlight
