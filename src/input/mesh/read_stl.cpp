#include "input/mesh/read_stl.h"

#include "patchlight/base/error.h"

#include "base/near_match.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/text.h"

#include <array>
#include <cstring>

namespace patchlight {
namespace {

// A binary file: 80 bytes of comment, the number of triangles, and for each its normal, three corners (all floats) and
// two bytes more. Numbers are little-endian, as on the machines this runs on.
constexpr std::size_t header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;
constexpr std::size_t normal_bytes = 12;

std::size_t triangles_promised(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + header_bytes - sizeof count, sizeof count);
  return count;
}

// Binary files may begin with "solid" too; their length tells. Some writers use capitals.
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
    std::memcpy(values.data(), bytes.data() + header_bytes + triangle_bytes * t + normal_bytes, sizeof values);
    for (std::size_t k = 0; k < 9; k += 3) {
      scene.vertices.emplace_back(scene.metres_per_unit * Point(values[k], values[k + 1], values[k + 2]));
    }
  }
  return scene;
}

Point stl_vertex(const std::vector<std::string_view>& statement, const std::string& where) {
  Point point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = axis + 1 < statement.size() ? finite_number(statement[axis + 1]) : std::nullopt;
    if (!value) throw InputError(where, "expected three finite numbers after vertex");
    point[static_cast<Eigen::Index>(axis)] = *value;
  }
  return point;
}

Scene with_ascii(Scene scene, const std::string& text) {
  std::size_t first = 0;    // vertex of the loop at hand
  std::uint32_t begin = 0;  // its line
  bool is_whole = true;
  LeftOut left_out;
  for (const TextLine& line : logical_lines(text)) {
    const std::vector<std::string_view> statement = words(line.text);
    if (statement.empty()) continue;
    const std::string where = scene.file + ":" + std::to_string(line.number);
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
      scene.vertices.emplace_back(scene.metres_per_unit * stl_vertex(statement, where));
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
  if (!is_whole) throw InputError(scene.file + ":" + std::to_string(begin), "the file ends within this facet");
  return left_out.on(std::move(scene));
}

}  // namespace

Scene read_stl(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  Scene scene = scene_without_materials(file.string(), metres_per_unit);
  scene = is_binary(bytes) ? with_binary(std::move(scene), bytes) : with_ascii(std::move(scene), bytes);
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
