#include "cli/messages.h"

#include "patchlight/base/error.h"

#include "cli/option_names.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <iostream>
#include <unistd.h>

namespace patchlight::cli {
namespace {

std::string escaped(const char* format, unsigned code) {
  char text[8];
  std::snprintf(text, sizeof text, format, code);
  return text;
}

// Length of the UTF-8 sequence at the start of the text; 0 if invalid. Unicode 15, table 3-6.
std::size_t sequence_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length > text.size()) return 0;
  const auto is_rest = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80; };
  return std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, length)),
                     is_rest)
             ? length
             : 0;
}

// One character in a form that is safe for a terminal.
std::string visible(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1 && (first < 0x20 || first == 0x7F)) return escaped("\\u%04x", first);
  const bool is_c1 = character.size() == 2 && first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return is_c1 ? escaped("\\u%04x", static_cast<unsigned char>(character[1])) : std::string(character);
}

// Number of UTF-8 characters: continuation bytes do not count.
std::size_t length_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
}

}  // namespace

void print_message(const char* kind, const std::string& text) {
  std::string lines = with_option_names(text);
  for (std::size_t end = lines.find('\n'); end != std::string::npos; end = lines.find('\n', end + 1))
    if (lines.compare(end + 1, 6, "hint: ") != 0) lines[end] = ' ';
  std::cerr << "patchlight: " << kind << ": " << printable(lines) << '\n';
}

void print_diagnostic(const char* kind, const Diagnostic& diagnostic) {
  print_message(kind, name_of(diagnostic.code) + ": " + diagnostic.text);
}

void print_scene_warnings(const Scene& scene) {
  for (const Diagnostic& warning : chosen(scene.diagnostics, makes_results_wrong))
    print_diagnostic("warning", {warning.code, scene.file + ": " + warning.text});
}

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (length > 0) {
      result += text[0] == '\n' ? std::string(1, '\n') : visible(text.substr(0, length));
    } else {
      result += first < 0xA0 ? escaped("\\x%02x", first) : std::string(1, text[0]);
    }
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return result;
}

std::string shown_name(std::string_view name) {
  std::string result;
  for (const char letter : printable(name)) result += letter == '\n' ? std::string("\\u000a") : std::string(1, letter);
  return result;
}

std::string text_table(const std::vector<TextRow>& cells) {
  std::vector<std::size_t> width(cells.front().size());
  std::vector<TextRow> rows = cells;
  for (TextRow& row : rows) {
    for (std::string& cell : row) cell = shown_name(cell);
  }
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column)
      width[column] = std::max(width[column], length_of(row[column]));
  }
  std::string text;
  for (const TextRow& row : rows) {
    for (std::size_t column = 0; column + 1 < row.size(); ++column)
      text += row[column] + std::string(width[column] + 2 - length_of(row[column]), ' ');
    text += row.back() + '\n';
  }
  return text;
}

// Buffers output until it is flushed.
class StandardOutput::Buffer : public std::streambuf {
 public:
  int error_number() const { return error_number_; }

 protected:
  int_type overflow(int_type letter) override {
    if (!traits_type::eq_int_type(letter, traits_type::eof())) text_ += traits_type::to_char_type(letter);
    return traits_type::not_eof(letter);
  }
  std::streamsize xsputn(const char* letters, std::streamsize count) override {
    text_.append(letters, static_cast<std::size_t>(count));
    return count;
  }
  int sync() override {
    const std::string bytes = printable(text_);
    text_.clear();
    std::size_t done = 0;
    while (done < bytes.size() && error_number_ == 0) {
      const ssize_t count = ::write(STDOUT_FILENO, bytes.data() + done, bytes.size() - done);
      if (count >= 0) {
        done += static_cast<std::size_t>(count);
      } else if (errno != EINTR) {
        error_number_ = errno;
      }
    }
    return error_number_ == 0 ? 0 : -1;
  }

 private:
  std::string text_;
  int error_number_ = 0;
};

void open_standard_streams() {
  // In this order, because open() returns the lowest free number. A null device opened for reading refuses writes.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    const int opened = open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != descriptor) close(opened);
  }
}

StandardOutput::StandardOutput() : buffer_(std::make_unique<Buffer>()), before_(std::cout.rdbuf(buffer_.get())) {}

StandardOutput::~StandardOutput() {
  std::cout.flush();
  std::cout.rdbuf(before_);
}

void StandardOutput::finish() {
  std::cout.flush();
  if (buffer_->error_number() == 0) return;
  throw OutputError("standard output", std::string("cannot be written: ") + std::strerror(buffer_->error_number()));
}

}  // namespace patchlight::cli
