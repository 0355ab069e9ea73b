#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// A line of a text file after continuation lines were joined.
struct TextLine {
  std::uint32_t number = 0;  ///< of its first line in the file, from 1
  std::string text;          ///< without line end
};

/// The whole content of a regular file; of the standard input for "-". \throws InputError at `where` when it is
/// missing, a folder, a device, a pipe, unreadable, empty or longer than 1 GiB; the message calls it `what`.
std::string read_text(const std::filesystem::path& file, const std::string& where, const std::string& what);

/// The same of a file that the user has named, which may be a pipe: a process can stand for a file.
std::string read_text_or_pipe(const std::filesystem::path& file, const std::string& what);

/// \throws InputError at `where` when `file`, with all links followed, does not lie in the folder `confine`; an empty
/// one stands for no such folder. The message is the same whether there is such a file or not.
void require_within(const std::filesystem::path& confine, const std::filesystem::path& file, const std::string& where);

/// The lines of a text. Lines end in LF, CR LF or CR; a backslash at the end of a line continues it; a byte order mark
/// is left out.
std::vector<TextLine> logical_lines(std::string_view text);

/// The words of a line, separated by spaces and tabs.
std::vector<std::string_view> words(std::string_view line);

/// The words before the first one that begins with #.
std::vector<std::string_view> words_before_comment(std::string_view line);

/// What follows the first word, without spaces and tabs around it.
std::string_view after_first_word(std::string_view line);

/// The line without spaces and tabs around it.
std::string_view trimmed(std::string_view line);

/// The number that the whole word spells; nothing when it is not a finite decimal number.
std::optional<double> finite_number(std::string_view word);

/// "a, b, c".
std::string listed(std::span<const std::string> names);

}  // namespace patchlight
