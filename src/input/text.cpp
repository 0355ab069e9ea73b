#include "input/text.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <istream>

namespace patchlight {
namespace {

constexpr std::string_view blanks = " \t";

// Reads to the end, at most 1 GiB: more than any solvable model needs. `what` names the file in messages.
std::string read_to_end(std::istream& stream, const std::string& where, const std::string& what) {
  std::string text;
  std::vector<char> block(1U << 16U);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() <= std::size_t{1} << 30U) continue;
    throw InputError(where, what + " is longer than 1 GiB; expected a file of a sensible length");
  }
  if (stream.bad()) throw InputError(where, what + " could not be read to its end");
  if (text.empty()) throw InputError(where, what + " is empty");
  return text;
}

std::string read_if(const std::filesystem::path& file, const std::string& where, const std::string& what,
                    bool may_be_pipe) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw InputError(where, what + " does not exist; check the name and the folder");
  }
  if (error) throw InputError(where, what + " cannot be opened: " + error.message());
  if (std::filesystem::is_directory(status)) throw InputError(where, what + " is a folder; expected a file");
  const bool is_pipe = std::filesystem::is_fifo(status);
  if (is_pipe && !may_be_pipe) throw InputError(where, what + " is a pipe; expected a regular file");
  if (!is_pipe && !std::filesystem::is_regular_file(status)) {
    throw InputError(where, what + " is a device; expected a regular file");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(where, what + " cannot be opened for reading; check its permissions");
  return read_to_end(stream, where, what);
}

}  // namespace

std::string read_text(const std::filesystem::path& file, const std::string& where, const std::string& what) {
  return file == "-" ? read_to_end(std::cin, where, what) : read_if(file, where, what, false);
}

std::string read_text_or_pipe(const std::filesystem::path& file, const std::string& what) {
  return read_if(file, file.string(), what, true);
}

void require_within(const std::filesystem::path& confine, const std::filesystem::path& file, const std::string& where) {
  if (confine.empty() || file == "-") return;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::canonical(confine, error);
  if (error)
    throw InputError("read.confine", "there is no folder " + confine.string() + "; expected one that is there");
  const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(file), error);
  const auto [rest, ignored] = std::mismatch(folder.begin(), folder.end(), place.begin(), place.end());
  if (!error && rest == folder.end()) return;
  throw InputError(where, "names '" + file.string() + "', which does not lie in " + confine.string() +
                              "; expected a file in the folder that read.confine allows");
}

std::vector<TextLine> logical_lines(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  std::vector<TextLine> lines;
  std::uint32_t number = 0;
  bool continues = false;
  while (!text.empty()) {
    ++number;
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));

    if (!continues) lines.push_back({number, {}});
    continues = line.ends_with('\\');
    lines.back().text += continues ? line.substr(0, line.size() - 1) : line;
    if (continues) lines.back().text += ' ';
  }
  return lines;
}

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> found;
  std::size_t begin = line.find_first_not_of(blanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    found.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(blanks, end);
  }
  return found;
}

std::vector<std::string_view> words_before_comment(std::string_view line) {
  std::vector<std::string_view> found = words(line);
  std::size_t count = 0;
  while (count < found.size() && !found[count].starts_with('#')) ++count;
  found.resize(count);
  return found;
}

std::string_view after_first_word(std::string_view line) {
  const std::string_view text = trimmed(line);
  const std::size_t end = text.find_first_of(blanks);
  return end == std::string_view::npos ? std::string_view() : trimmed(text.substr(end));
}

std::string_view trimmed(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(blanks) - begin + 1);
}

std::optional<double> finite_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);  // std::from_chars accepts no plus sign
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string_view> between_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace patchlight
