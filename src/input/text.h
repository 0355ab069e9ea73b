#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace patchlight {

/// A line of a text file after continuation lines are joined.
struct TextLine {
  std::uint32_t number = 0;  ///< number of its first line in the file, from 1
  std::string text;          ///< without line end
};

/// The content of a regular file, or of the standard input for "-". \throws InputError at `where` when the file is
/// missing, a folder, a device, a pipe, unreadable, empty or longer than 1 GiB. Messages call it `what`.
std::string read_text(const std::filesystem::path& file, const std::string& where, const std::string& what);

/// The same for a file on the command line, which may be a pipe (process substitution).
std::string read_text_or_pipe(const std::filesystem::path& file, const std::string& what);

/// \throws InputError at `where` when `file`, with links resolved, lies outside the folder `confine`; an empty
/// `confine` allows all. The message does not depend on whether the file exists.
void require_within(const std::filesystem::path& confine, const std::filesystem::path& file, const std::string& where);

/// The lines of a text, ended by LF, CR LF or CR. A backslash at the end continues a line. A byte order mark is
/// skipped.
std::vector<TextLine> logical_lines(std::string_view text);

/// The words of a line, separated by spaces and tabs.
std::vector<std::string_view> words(std::string_view line);

/// The words before the first one that begins with #.
std::vector<std::string_view> words_before_comment(std::string_view line);

/// The line behind its first word, without spaces and tabs around it.
std::string_view after_first_word(std::string_view line);

/// The line without spaces and tabs around it.
std::string_view trimmed(std::string_view line);

/// The value of a word that is a finite decimal number; empty otherwise.
std::optional<double> finite_number(std::string_view word);

/// The value of a word that is a whole number; empty otherwise.
template <class Number>
std::optional<Number> whole_number_in(std::string_view word) {
  Number value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The parts of a text between commas, at least one.
std::vector<std::string_view> between_commas(std::string_view text);

/// "room.obj:12".
inline std::string at_line(const std::filesystem::path& file, std::uint32_t line) {
  return file.string() + ":" + std::to_string(line);
}

/// Limits for one model and all files that it names: a small file can demand a lot of work. Readers throw InputError
/// when a file exceeds one of them.
namespace reading_limits {

inline constexpr std::size_t polygons = 10'000'000;    ///< including copies; a million take about 1 GB to solve
inline constexpr std::size_t copies = 1'000'000;       ///< objects visited within instances, with or without faces
inline constexpr std::size_t files = 200'000;          ///< files read, including copies
inline constexpr std::size_t nesting = 64;             ///< nested objects, tables or files: parsers recurse
inline constexpr std::size_t values = 1'000'000;       ///< values of a scene file, 700 bytes each
inline constexpr std::size_t key_length = 200;         ///< characters of a key of a scene file, kept with each value
inline constexpr std::size_t variable_length = 4096;   ///< characters of a variable; the length of the longest file
                                                       ///< name
inline constexpr std::size_t text_length = 1'000'000;  ///< characters of a text after expansion of variables

}  // namespace reading_limits

}  // namespace patchlight
