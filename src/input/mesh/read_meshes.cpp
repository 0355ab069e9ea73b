#include "patchlight/base/error.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/read_model.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

namespace patchlight {
namespace {

struct Statement {
  std::uint32_t line = 0;
  std::vector<std::string_view> words;
};

std::vector<Statement> statements_of(const std::vector<TextLine>& lines) {
  std::vector<Statement> statements;
  for (const TextLine& line : lines) {
    Statement statement = {line.number, words_before_comment(line.text)};
    if (!statement.words.empty()) statements.push_back(std::move(statement));
  }
  return statements;
}

// The k-th word, a whole number below `limit`.
std::uint32_t whole_number(const Statement& statement, std::size_t k, std::uint32_t limit, const std::string& file) {
  const std::string_view word = k < statement.words.size() ? statement.words[k] : std::string_view();
  const auto value = whole_number_in<std::uint32_t>(word);
  if (!value || *value >= limit) {
    throw InputError(at_line(file, statement.line), "found '" + std::string(word) + "' as number " +
                                                        std::to_string(k + 1) + "; expected a whole number from 0 to " +
                                                        std::to_string(limit - 1));
  }
  return *value;
}

// Three numbers among the words, starting at `begin`.
Point vertex_of(const std::vector<std::string_view>& words, std::size_t begin, const std::string& where,
                const std::string& expected) {
  Point point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = begin + axis < words.size() ? finite_number(words[begin + axis]) : std::nullopt;
    if (!value) throw InputError(where, "expected three finite numbers" + expected);
    point[static_cast<Eigen::Index>(axis)] = *value;
  }
  return point;
}

Polygon face(const Statement& statement, std::size_t vertices, const std::string& file) {
  const std::uint32_t corners = whole_number(statement, 0, ~std::uint32_t{0}, file);
  if (corners >= statement.words.size()) {
    throw InputError(at_line(file, statement.line),
                     "this face has fewer than the " + std::to_string(corners) + " corners it promises");
  }
  Polygon polygon;
  polygon.line = statement.line;
  for (std::size_t k = 1; k <= corners; ++k) {
    polygon.corners.push_back(whole_number(statement, k, static_cast<std::uint32_t>(vertices), file));
  }
  return polygon;
}

// The statements, without the keyword and the counts of vertices and faces.
struct OffHeader {
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  std::size_t first = 0;  // statement after the header
};

OffHeader header_of(std::vector<Statement>& statements, const std::string& file) {
  const std::string_view key = statements.empty() ? std::string_view() : statements[0].words[0];
  const bool is_off = key == "OFF" || key == "COFF" || key == "NOFF" || key == "CNOFF";
  if (!is_off || (statements[0].words.size() > 1 && statements[0].words[1] == "BINARY")) {
    throw InputError(file,
                     "is not an OFF file in ASCII: expected the word OFF (or COFF, NOFF, CNOFF) at its beginning");
  }
  statements[0].words.erase(statements[0].words.begin());
  OffHeader header;
  header.first = statements[0].words.empty() ? 1 : 0;
  if (header.first >= statements.size())
    throw InputError(file, "ends after the word OFF; expected the numbers of vertices and faces");
  header.vertices = whole_number(statements[header.first], 0, ~std::uint32_t{0}, file);
  header.faces = whole_number(statements[header.first], 1, ~std::uint32_t{0}, file);
  ++header.first;
  const std::size_t lines = statements.size() - header.first;
  if (lines < header.vertices || lines - header.vertices < header.faces) {
    throw InputError(file, "promises " + std::to_string(header.vertices) + " vertices and " +
                               std::to_string(header.faces) + " faces, but has only " + std::to_string(lines) +
                               " lines for them");
  }
  return header;
}

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

using PlyBytes = std::array<char, 8>;

// A type of numbers: its size, and how its bytes are read.
struct PlyType {
  std::size_t size = 0;
  double (*value)(const PlyBytes& bytes) = nullptr;
};

template <typename Number>
constexpr PlyType ply_type = {sizeof(Number), [](const PlyBytes& bytes) {
                                Number value;
                                std::memcpy(&value, bytes.data(), sizeof value);
                                return static_cast<double>(value);
                              }};

struct PlyProperty {
  std::string name;
  PlyType type = {};
  bool is_list = false;
  PlyType count_type = {};  // type of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

// The header of a PLY file.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  // offset of the values
  std::uint32_t lines = 0;
};

PlyType type_named(std::string_view name, const std::string& where) {
  static const std::map<std::string_view, PlyType> types = {
      {"char", ply_type<std::int8_t>},     {"int8", ply_type<std::int8_t>},     {"uchar", ply_type<std::uint8_t>},
      {"uint8", ply_type<std::uint8_t>},   {"short", ply_type<std::int16_t>},   {"int16", ply_type<std::int16_t>},
      {"ushort", ply_type<std::uint16_t>}, {"uint16", ply_type<std::uint16_t>}, {"int", ply_type<std::int32_t>},
      {"int32", ply_type<std::int32_t>},   {"uint", ply_type<std::uint32_t>},   {"uint32", ply_type<std::uint32_t>},
      {"float", ply_type<float>},          {"float32", ply_type<float>},        {"double", ply_type<double>},
      {"float64", ply_type<double>}};
  const auto found = types.find(name);
  if (found == types.end())
    throw InputError(where, "found the type '" + std::string(name) + "'; expected one of PLY's");
  return found->second;
}

PlyEncoding encoding_named(const std::vector<std::string_view>& statement, const std::string& where) {
  const std::string_view name = statement.size() > 1 ? statement[1] : std::string_view();
  if (name == "ascii") return PlyEncoding::ascii;
  if (name == "binary_little_endian") return PlyEncoding::little_endian;
  if (name == "binary_big_endian") return PlyEncoding::big_endian;
  throw InputError(
      where, "found the format '" + std::string(name) + "'; expected ascii, binary_little_endian or binary_big_endian");
}

PlyElement element_of(const std::vector<std::string_view>& statement, const std::string& where) {
  const auto count = statement.size() == 3 ? whole_number_in<std::uint64_t>(statement[2]) : std::nullopt;
  if (!count) throw InputError(where, "expected: element NAME COUNT");
  return {std::string(statement[1]), *count, {}};
}

PlyProperty property_of(const std::vector<std::string_view>& statement, const std::string& where) {
  PlyProperty property;
  property.is_list = statement.size() > 1 && statement[1] == "list";
  if (statement.size() != (property.is_list ? 5U : 3U)) {
    throw InputError(where, "expected: property TYPE NAME, or property list TYPE TYPE NAME");
  }
  if (property.is_list) property.count_type = type_named(statement[2], where);
  property.type = type_named(statement[statement.size() - 2], where);
  property.name = statement.back();
  return property;
}

// The line that starts at `begin`, without its end; advances `begin`.
std::string_view line_at(std::string_view bytes, std::size_t& begin) {
  const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
  std::string_view line = bytes.substr(begin, end - begin);
  begin = std::min(end + 1, bytes.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// Throws InputError naming the line.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file) {
  PlyHeader header;
  if (trimmed(line_at(bytes, header.bytes)) != "ply") {
    throw InputError(file, "is not a PLY file: expected the word ply at its beginning");
  }
  header.lines = 1;
  while (header.bytes < bytes.size()) {
    const std::vector<std::string_view> statement = words(line_at(bytes, header.bytes));
    const std::string where = at_line(file, ++header.lines);
    if (statement.empty() || statement[0] == "comment" || statement[0] == "obj_info") continue;
    if (statement[0] == "end_header") return header;
    if (statement[0] == "format") {
      header.encoding = encoding_named(statement, where);
    } else if (statement[0] == "element") {
      header.elements.push_back(element_of(statement, where));
    } else if (statement[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(property_of(statement, where));
    } else {
      throw InputError(where, "found '" + std::string(statement[0]) + "'; expected element, property or end_header");
    }
  }
  throw InputError(file, "ends within its header; expected end_header");
}

// Reads the values of a PLY file in sequence.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header, std::string file)
      : rest_(bytes.substr(header.bytes)),
        encoding_(header.encoding),
        line_(header.lines + 1),
        file_(std::move(file)) {}

  // The next number of this type. \throws InputError at the end.
  double next(PlyType type) { return encoding_ == PlyEncoding::ascii ? next_word() : next_bytes(type); }

  // All numbers of the next property, a scalar or a list. \throws InputError if numbers are missing.
  std::vector<double> next(const PlyProperty& property) {
    if (!property.is_list) return {next(property.type)};
    const double count = next(property.count_type);
    std::vector<double> values;
    while (static_cast<double>(values.size()) < count) values.push_back(next(property.type));
    return values;
  }

  // The current line of an ASCII file; 0 for binary files.
  std::uint32_t line() const { return encoding_ == PlyEncoding::ascii ? line_ : 0; }

 private:
  double next_word() {
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t begin = std::min(rest_.find_first_not_of(blanks), rest_.size());
    line_ +=
        static_cast<std::uint32_t>(std::count(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(blanks));
    rest_.remove_prefix(word.size());
    if (word.empty()) throw InputError(file_, "ends before all elements that its header promises");
    const std::optional<double> value = finite_number(word);
    if (!value) throw InputError(at_line(file_, line_), "found '" + std::string(word) + "'; expected a finite number");
    return *value;
  }

  double next_bytes(PlyType type) {
    if (rest_.size() < type.size) throw InputError(file_, "ends before all elements that its header promises");
    PlyBytes bytes{};
    std::copy_n(rest_.begin(), type.size, bytes.begin());
    if (encoding_ == PlyEncoding::big_endian)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.size));
    rest_.remove_prefix(type.size);
    return type.value(bytes);
  }

  std::string_view rest_;
  PlyEncoding encoding_;
  std::uint32_t line_;
  std::string file_;
};

// Index of a property in its element; empty if it has none of these names.
std::optional<std::size_t> find(const PlyElement& element, std::initializer_list<std::string_view> names) {
  for (std::size_t k = 0; k < element.properties.size(); ++k) {
    if (std::find(names.begin(), names.end(), element.properties[k].name) != names.end()) return k;
  }
  return std::nullopt;
}

Scene with_vertices(Scene scene, const PlyElement& element, PlyBody& body) {
  const std::optional<std::size_t> x = find(element, {"x"});
  const std::optional<std::size_t> y = find(element, {"y"});
  const std::optional<std::size_t> z = find(element, {"z"});
  if (!x || !y || !z) throw InputError(scene.file, "its vertices lack one of the properties x, y and z");
  for (std::uint64_t v = 0; v < element.count; ++v) {
    Point point = Point::Zero();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const std::vector<double> values = body.next(element.properties[k]);
      if (values.empty()) continue;
      if (k == *x) point.x() = values[0];
      if (k == *y) point.y() = values[0];
      if (k == *z) point.z() = values[0];
    }
    scene.vertices.emplace_back(scene.metres_per_unit * point);
  }
  if (find(element, {"red", "diffuse_red"}))
    scene.diagnostics.push_back({DiagnosticCode::simplified_part, "the colors of the vertices are ignored"});
  return scene;
}

// Throws an error that names the line, or only the file if it is binary.
[[noreturn]] void refuse_corner(const std::string& file, std::uint32_t line) {
  throw InputError(line > 0 ? at_line(file, line) : file,
                   "a face has a corner that names no vertex\nhint: export the model again");
}

Polygon polygon_of(const std::vector<double>& corners, std::uint32_t line, const std::string& file) {
  Polygon polygon;
  polygon.line = line;
  for (const double corner : corners) {
    if (!(corner >= 0 && corner < no_polygon)) refuse_corner(file, line);
    polygon.corners.push_back(static_cast<std::uint32_t>(corner));
  }
  return polygon;
}

Scene with_faces(Scene scene, const PlyElement& element, PlyBody& body) {
  LeftOut left_out;
  const std::optional<std::size_t> corners = find(element, {"vertex_indices", "vertex_index"});
  if (!corners) throw InputError(scene.file, "its faces lack the property vertex_indices");
  for (std::uint64_t f = 0; f < element.count; ++f) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const std::vector<double> values = body.next(element.properties[k]);
      if (k != *corners) continue;
      if (values.size() < 3)
        left_out.lose_face(too_few_corners, scene.groups[0], {.line = body.line()});
      else
        scene.polygons.push_back(polygon_of(values, body.line(), scene.file));
    }
  }
  if (find(element, {"red", "diffuse_red"}))
    scene.diagnostics.push_back({DiagnosticCode::simplified_part, "the colors of the faces are ignored"});
  return left_out.on(std::move(scene));
}

Scene without(Scene scene, const PlyElement& element, PlyBody& body) {
  if (element.properties.empty()) return scene;
  for (std::uint64_t k = 0; k < element.count; ++k) {
    for (const PlyProperty& property : element.properties) body.next(property);
  }
  // Lists contain vertices, e.g. triangle strips.
  const bool has_faces = std::any_of(element.properties.begin(), element.properties.end(),
                                     [](const PlyProperty& property) { return property.is_list; });
  LeftOut left_out;
  if (has_faces && element.count > 0)
    left_out.lose("elements that hold lists and are not faces, left out", element.name);
  else
    left_out.lose_without_area("elements that are neither vertices nor faces, left out", element.name, element.count);
  return left_out.on(std::move(scene));
}

// A binary file: 80 bytes of comment, the number of triangles, and for each its normal, three corners (all floats) and
// two more bytes. Numbers are little-endian, like the supported machines.
constexpr std::size_t header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;

std::size_t triangles_promised(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + header_bytes - sizeof count, sizeof count);
  return count;
}

// Some binary files begin with "solid" too; the length decides. Some writers use capitals.
bool is_binary(std::string_view bytes) {
  if (bytes.size() < header_bytes) return false;
  return bytes.size() == header_bytes + triangle_bytes * triangles_promised(bytes) ||
         !in_lower_case(std::string(trimmed(bytes.substr(0, header_bytes)))).starts_with("solid");
}

Polygon polygon_of(std::uint32_t first, std::uint32_t corners, std::uint32_t group, std::uint32_t line) {
  Polygon polygon;
  for (std::uint32_t k = 0; k < corners; ++k) polygon.corners.push_back(first + k);
  polygon.group = group;
  polygon.line = line;
  return polygon;
}

Scene with_binary(Scene scene, std::string_view bytes) {
  const std::size_t count = triangles_promised(bytes);
  if ((bytes.size() - header_bytes) / triangle_bytes < count) {
    throw InputError(scene.file, "promises " + std::to_string(count) + " triangles, but ends after " +
                                     std::to_string((bytes.size() - header_bytes) / triangle_bytes));
  }
  scene.groups.emplace_back("solid");
  for (std::size_t t = 0; t < count; ++t) {
    scene.polygons.push_back(polygon_of(static_cast<std::uint32_t>(scene.vertices.size()), 3, 0, 0));
    std::array<float, 9> values{};
    std::memcpy(values.data(), bytes.data() + header_bytes + triangle_bytes * t + 12, sizeof values);
    for (std::size_t k = 0; k < 9; k += 3) {
      scene.vertices.emplace_back(scene.metres_per_unit * Point(values[k], values[k + 1], values[k + 2]));
    }
  }
  return scene;
}

Scene with_ascii(Scene scene, const std::string& text) {
  std::size_t first = 0;    // first vertex of the current loop
  std::uint32_t begin = 0;  // its line
  bool is_whole = true;
  LeftOut left_out;
  for (const TextLine& line : logical_lines(text)) {
    const std::vector<std::string_view> statement = words(line.text);
    if (statement.empty()) continue;
    const std::string where = at_line(scene.file, line.number);
    const std::string word = in_lower_case(std::string(statement[0]));
    if (word == "solid") {
      scene.groups.emplace_back(after_first_word(line.text));
    } else if (scene.groups.empty()) {
      throw InputError(where, "is not an STL file: expected the word solid at its beginning");
    } else if (word == "outer") {
      first = scene.vertices.size();
      begin = line.number;
      is_whole = false;
    } else if (word == "vertex") {
      scene.vertices.emplace_back(scene.metres_per_unit * vertex_of(statement, 1, where, " after vertex"));
    } else if (word == "endloop") {
      const auto corners = static_cast<std::uint32_t>(scene.vertices.size() - first);
      const auto group = static_cast<std::uint32_t>(scene.groups.size() - 1);
      if (corners < 3)
        left_out.lose_face(too_few_corners, scene.groups.back(), {.line = begin});
      else
        scene.polygons.push_back(polygon_of(static_cast<std::uint32_t>(first), corners, group, begin));
      first = scene.vertices.size();
      is_whole = true;
    }
  }
  if (!is_whole) throw InputError(at_line(scene.file, begin), "the file ends within this facet");
  return left_out.on(std::move(scene));
}

}  // namespace

Scene read_off(const std::filesystem::path& file, double metres_per_unit) {
  const std::string text = read_text(file, file.string(), "the model file");
  const std::vector<TextLine> lines = logical_lines(text);
  std::vector<Statement> statements = statements_of(lines);
  const OffHeader header = header_of(statements, file.string());

  Scene scene = scene_without_materials(file.string(), metres_per_unit);
  scene.groups.push_back(file.stem().string());
  for (std::size_t k = 0; k < header.vertices; ++k) {
    const Statement& statement = statements[header.first + k];
    scene.vertices.emplace_back(metres_per_unit *
                                vertex_of(statement.words, 0, at_line(file, statement.line), ": a vertex x y z"));
  }
  LeftOut left_out;
  for (std::size_t k = 0; k < header.faces; ++k) {
    Polygon polygon = face(statements[header.first + header.vertices + k], header.vertices, file.string());
    if (polygon.corners.size() < 3)
      left_out.lose_face(too_few_corners, scene.groups[0], {.line = polygon.line});
    else
      scene.polygons.push_back(std::move(polygon));
  }
  scene = left_out.on(std::move(scene));
  scene.sha256 = sha256({&text, 1});
  return scene;
}

Scene read_ply(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  const PlyHeader header = read_ply_header(bytes, file.string());
  PlyBody body(bytes, header, file.string());
  Scene scene = scene_without_materials(file.string(), metres_per_unit);
  scene.groups.push_back(file.stem().string());
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      scene = with_vertices(std::move(scene), element, body);
    } else if (element.name == "face") {
      scene = with_faces(std::move(scene), element, body);
    } else {
      scene = without(std::move(scene), element, body);
    }
  }
  for (const Polygon& polygon : scene.polygons) {
    if (*std::max_element(polygon.corners.begin(), polygon.corners.end()) >= scene.vertices.size())
      refuse_corner(scene.file, polygon.line);
  }
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

Scene read_stl(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  Scene scene = scene_without_materials(file.string(), metres_per_unit);
  scene = is_binary(bytes) ? with_binary(std::move(scene), bytes) : with_ascii(std::move(scene), bytes);
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
