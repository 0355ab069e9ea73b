#include "input/obj/scan_obj.h"

#include "patchlight/base/error.h"

#include "input/at_line.h"
#include "input/text.h"

#include <charconv>
#include <limits>
#include <map>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// tinyobjloader counts the corners of a face in one byte.
constexpr std::size_t most_counted_corners = 255;

// The largest vertex number a face uses, to be compared with the number of vertices when the file has been read: a face
// may stand above its vertices.
struct HighestVertex {
  std::int64_t number = 0;
  std::uint32_t line = 0;
};

std::string quoted(std::string_view word) { return std::string("'").append(word).append("'"); }

Point obj_vertex(const std::vector<std::string_view>& statement, const std::string& where) {
  if (statement.size() < 4) {
    throw InputError(where, "this vertex has " + std::to_string(statement.size() - 1) +
                                " coordinates; expected three numbers after v");
  }
  Point point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = finite_number(statement[axis + 1]);
    if (!value) {
      throw InputError(where, "the coordinate " + quoted(statement[axis + 1]) +
                                  " is not a finite number; expected three numbers such as 1.25 after v");
    }
    point[axis] = *value;
  }
  return point;
}

// The vertex number of a corner such as 7, 7/2, 7//3 or -1/2/3, from 1. A negative number counts back from the last
// vertex above.
std::int64_t vertex_number(std::string_view corner, std::size_t vertices_above, const std::string& where) {
  const std::string_view digits = corner.substr(0, corner.find('/'));
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number == 0) {
    throw InputError(where, "the corner " + quoted(corner) +
                                " names no vertex; expected a whole number other than 0, such as 7, 7/2 or 7//3");
  }
  if (number > 0) return number;
  const std::int64_t counted = static_cast<std::int64_t>(vertices_above) + 1 + number;
  if (counted < 1) {
    throw InputError(where, "the corner " + quoted(corner) + " counts back beyond the first of the " +
                                std::to_string(vertices_above) + " vertices above it");
  }
  return counted;
}

// The vertex numbers of a face.
std::vector<std::int64_t> face_corners(const std::vector<std::string_view>& statement, std::size_t vertices_above,
                                       const std::string& where) {
  std::vector<std::int64_t> corners;
  for (std::size_t k = 1; k < statement.size(); ++k)
    corners.push_back(vertex_number(statement[k], vertices_above, where));
  return corners;
}

// A vt statement, v being 0 where it has one number; not a number where it has none.
Eigen::Vector2d picture_point(const std::vector<std::string_view>& statement) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector2d point(unknown, unknown);
  for (std::size_t k = 0; k < 2 && k + 1 < statement.size(); ++k)
    point[static_cast<Eigen::Index>(k)] = finite_number(statement[k + 1]).value_or(unknown);
  if (statement.size() == 2) point[1] = 0;
  return point;
}

// The picture point of a corner such as 7/2 or -1/-2/3, from 0; no_place where there is none.
std::uint32_t place_of(std::string_view corner, std::size_t points_above) {
  const std::size_t slash = corner.find('/');
  if (slash == std::string_view::npos) return no_place;
  const std::string_view digits = corner.substr(slash + 1, corner.find('/', slash + 1) - slash - 1);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number == 0) return no_place;
  const std::int64_t place = number > 0 ? number - 1 : static_cast<std::int64_t>(points_above) + number;
  return place >= 0 && place < std::int64_t{no_place} ? static_cast<std::uint32_t>(place) : no_place;
}

std::string face_statement(std::span<const std::int64_t> corners) {
  std::string statement = "f";
  for (const std::int64_t corner : corners) statement.append(" ").append(std::to_string(corner));
  return statement + "\n";
}

// The scan with one more face of at least three corners.
ObjScan with_face(ObjScan scan, ObjFace face, std::span<const std::int64_t> corners) {
  if (corners.size() <= most_counted_corners) {
    scan.geometry += face_statement(corners);
  } else {
    scan.geometry += face_statement(corners.first(3));
    for (const std::int64_t corner : corners) face.corners.push_back(static_cast<std::uint32_t>(corner - 1));
  }
  scan.faces.push_back(std::move(face));
  return scan;
}

void check_vertices_exist(const HighestVertex& highest, std::size_t vertices, const std::string& file) {
  if (highest.number <= static_cast<std::int64_t>(vertices)) return;
  throw InputError(at_line(file, highest.line), "this face uses vertex " + std::to_string(highest.number) +
                                                    ", but there are " + std::to_string(vertices) +
                                                    " vertices in the file; fix the index");
}

}  // namespace

ObjScan scan_obj(std::string_view text, const std::string& file) {
  ObjScan scan;
  std::map<std::string, std::uint32_t, std::less<>> known;  // usemtl names
  std::uint32_t material = no_material;
  std::string object;  // or group
  HighestVertex highest;
  for (const TextLine& line : logical_lines(text)) {
    const std::vector<std::string_view> statement = words_before_comment(line.text);
    if (statement.empty()) continue;
    const std::string_view keyword = statement[0];
    if (keyword == "v") {
      scan.vertices.push_back(obj_vertex(statement, at_line(file, line.number)));
      scan.geometry += line.text + "\n";
      scan.colored_vertices += statement.size() == 7;  // x y z r g b
    } else if (keyword == "f") {
      const auto corners = face_corners(statement, scan.vertices.size(), at_line(file, line.number));
      for (const std::int64_t corner : corners) {
        if (corner > highest.number) highest = {corner, line.number};
      }
      if (corners.size() < 3) {
        scan.left_out.lose_face(too_few_corners, object, {.line = line.number});
        continue;
      }
      const std::size_t first_place = scan.places.size();
      scan = with_face(std::move(scan), {line.number, material, {}, first_place}, corners);
      for (std::size_t k = 1; k < statement.size(); ++k)
        scan.places.push_back(place_of(statement[k], scan.picture_points.size()));
    } else if (keyword == "vt") {
      scan.picture_points.push_back(picture_point(statement));
    } else if (keyword == "g" || keyword == "o") {
      object = after_first_word(line.text);
      scan.geometry += line.text + "\n";
    } else if (keyword == "usemtl") {
      const auto name = std::string(after_first_word(line.text));
      material = no_material;
      if (name.empty()) continue;
      const auto [entry, is_new] = known.emplace(name, static_cast<std::uint32_t>(scan.materials.size()));
      if (is_new) scan.materials.push_back({name, line.number});
      material = entry->second;
    } else if (keyword == "mtllib") {
      scan.libraries.push_back({std::string(after_first_word(line.text)), line.number});
    } else if (keyword == "l" || keyword == "p") {
      scan.left_out.lose_without_area(keyword == "l" ? "lines (l), left out" : "points (p), left out", object);
    } else if (keyword == "surf") {
      scan.left_out.lose("free-form surfaces (surf), left out", object);
    }
  }
  check_vertices_exist(highest, scan.vertices.size(), file);
  return scan;
}

}  // namespace patchlight
