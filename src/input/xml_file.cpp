#include "input/xml_file.h"

#include "patchlight/base/error.h"

#include "input/text.h"

#include <algorithm>
#include <string_view>

namespace patchlight {
namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xC0U | code >> 6U);
  } else if (code < 0x10000) {
    add(0xE0U | code >> 12U);
    add(0x80U | (code >> 6U & 0x3FU));
  } else {
    add(0xF0U | code >> 18U);
    add(0x80U | (code >> 12U & 0x3FU));
    add(0x80U | (code >> 6U & 0x3FU));
  }
  add(0x80U | (code & 0x3FU));
}

// RFC 2781: a pair of 0xD800 to 0xDBFF and 0xDC00 to 0xDFFF encodes one character. Unpaired halves become the
// replacement character.
std::string from_utf16(std::string_view bytes, bool little_endian) {
  const auto unit = [&](std::size_t k) {
    const auto first = static_cast<unsigned char>(bytes[k]);
    const auto second = static_cast<unsigned char>(bytes[k + 1]);
    return static_cast<std::uint32_t>(little_endian ? second << 8U | first : first << 8U | second);
  };
  std::string text;
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
    std::uint32_t code = unit(k);
    const bool is_half = code >= 0xD800 && code < 0xE000;
    const bool is_pair =
        is_half && code < 0xDC00 && k + 3 < bytes.size() && unit(k + 2) >= 0xDC00 && unit(k + 2) < 0xE000;
    if (is_pair) {
      code = 0x10000 + ((code - 0xD800) << 10U) + (unit(k + 2) - 0xDC00);
      k += 2;
    }
    append_utf8(text, is_half && !is_pair ? 0xFFFD : code);
  }
  return text;
}

// Detects the encoding from the byte order mark, or from the zero beside the initial "<".
std::string as_utf8(std::string_view bytes) {
  const auto begins = [&](std::string_view mark) { return bytes.substr(0, mark.size()) == mark; };
  using namespace std::string_view_literals;
  if (begins("\xFF\xFE"sv)) return from_utf16(bytes.substr(2), true);
  if (begins("\xFE\xFF"sv)) return from_utf16(bytes.substr(2), false);
  if (begins("<\0"sv)) return from_utf16(bytes, true);
  if (begins("\0<"sv)) return from_utf16(bytes, false);
  return std::string(begins("\xEF\xBB\xBF"sv) ? bytes.substr(3) : bytes);
}

std::uint32_t line_at_offset(const std::vector<std::size_t>& starts, std::ptrdiff_t offset) {
  const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, offset));
  return static_cast<std::uint32_t>(std::upper_bound(starts.begin(), starts.end(), place) - starts.begin());
}

}  // namespace

XmlFile read_xml_file(const std::filesystem::path& file, const std::string& where) {
  XmlFile xml;
  xml.file = file.string();
  xml.bytes = read_text(file, where, where == file ? "the model file" : file.string());
  const std::string text = as_utf8(xml.bytes);
  xml.line_starts = {0};
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
    xml.line_starts.push_back(at + 1);
  const pugi::xml_parse_result result =
      xml.document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
    throw InputError(at_line(file, line_at_offset(xml.line_starts, result.offset)),
                     "is not valid XML: " + std::string(result.description()) + "\nhint: export it again");
  return xml;
}

std::uint32_t line_of(const XmlFile& file, const pugi::xml_node& node) {
  return line_at_offset(file.line_starts, node.offset_debug());
}

std::string place_of(const XmlFile& file, const pugi::xml_node& node) {
  return at_line(file.file, line_of(file, node));
}

}  // namespace patchlight
