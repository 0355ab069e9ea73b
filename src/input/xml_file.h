#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace patchlight {

/// An XML file. It owns its nodes.
struct XmlFile {
  std::string file;
  std::string bytes;                     ///< for the checksum
  std::vector<std::size_t> line_starts;  ///< offsets in its UTF-8 text
  pugi::xml_document document;
};

/// Reads a file in UTF-8 or UTF-16. \throws InputError at `where` when it cannot be read, or with file and line for
/// invalid XML.
XmlFile read_xml_file(const std::filesystem::path& file, const std::string& where);

/// The line of a node of the file, from 1.
std::uint32_t line_of(const XmlFile& file, const pugi::xml_node& node);

/// "house.xml:12".
std::string place_of(const XmlFile& file, const pugi::xml_node& node);

}  // namespace patchlight
