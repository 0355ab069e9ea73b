#include "input/mesh/read_off.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/at_line.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/text.h"

#include <charconv>

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

// The k-th word as a whole number below `limit`.
std::uint32_t whole_number(const Statement& statement, std::size_t k, std::uint32_t limit, const std::string& file) {
  const std::string_view word = k < statement.words.size() ? statement.words[k] : std::string_view();
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size() || value >= limit) {
    throw InputError(at_line(file, statement.line), "found '" + std::string(word) + "' as number " +
                                                        std::to_string(k + 1) + "; expected a whole number from 0 to " +
                                                        std::to_string(limit - 1));
  }
  return value;
}

Point off_vertex(const Statement& statement, const std::string& file) {
  Point point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = axis < statement.words.size() ? finite_number(statement.words[axis]) : std::nullopt;
    if (!value) throw InputError(at_line(file, statement.line), "expected three finite numbers: a vertex x y z");
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

// The statements without the key word, and the numbers of vertices and faces taken off the first of the rest.
struct OffHeader {
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  std::size_t first = 0;  // statement after the header
};

OffHeader header_of(std::vector<Statement>& statements, const std::string& file) {
  constexpr std::uint32_t most = ~std::uint32_t{0};
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
  header.vertices = whole_number(statements[header.first], 0, most, file);
  header.faces = whole_number(statements[header.first], 1, most, file);
  ++header.first;
  const std::size_t lines = statements.size() - header.first;
  if (lines < header.vertices || lines - header.vertices < header.faces) {
    throw InputError(file, "promises " + std::to_string(header.vertices) + " vertices and " +
                               std::to_string(header.faces) + " faces, but has only " + std::to_string(lines) +
                               " lines for them");
  }
  return header;
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
    scene.vertices.emplace_back(metres_per_unit * off_vertex(statements[header.first + k], file.string()));
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

}  // namespace patchlight
