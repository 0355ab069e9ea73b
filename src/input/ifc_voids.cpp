#include "input/ifc_voids.h"

#include "input/joined_rings.h"
#include "input/text.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace patchlight {
namespace {

using Id = std::uint64_t;
using Place2d = Eigen::Vector2d;

// "#12=IFCPOLYLINE((#1,#2));"
struct StepEntity {
  Id id = 0;
  std::string_view keyword = {};
  std::string_view arguments = {};  // with their brackets
  std::size_t begin = 0;            // of the whole in the text
  std::size_t end = 0;              // behind its semicolon
};

// Behind the comment that begins at `begin`; the last letter without an end.
std::size_t behind_comment(std::string_view text, std::size_t begin) {
  const std::size_t end = text.find("*/", begin + 2);
  return end == std::string_view::npos ? text.size() : end + 2;
}

// The first letter from `begin` on that is neither space nor of a comment.
std::size_t first_letter(std::string_view text, std::size_t begin) {
  std::size_t at = text.find_first_not_of(" \t\r\n", begin);
  while (at != std::string_view::npos && text.substr(at, 2) == "/*")
    at = text.find_first_not_of(" \t\r\n", behind_comment(text, at));
  return at;
}

// The end of the statement that begins at `begin`: behind the next semicolon outside of strings; npos without one.
std::size_t end_of_statement(std::string_view text, std::size_t begin) {
  bool in_string = false;
  for (std::size_t k = begin; k < text.size(); ++k) {
    if (!in_string && text.substr(k, 2) == "/*") k = behind_comment(text, k) - 1;
    if (text[k] == '\'') in_string = !in_string;
    if (text[k] == ';' && !in_string) return k + 1;
  }
  return std::string_view::npos;
}

std::optional<StepEntity> parsed(std::string_view text, std::size_t begin, std::size_t end) {
  const std::size_t hash = first_letter(text, begin);
  if (hash >= end || text[hash] != '#') return std::nullopt;
  StepEntity statement{.begin = hash, .end = end};
  const char* const last = text.data() + end;
  const auto [after, error] = std::from_chars(text.data() + hash + 1, last, statement.id);
  if (error != std::errc()) return std::nullopt;
  const std::string_view whole = text.substr(0, end);
  const std::size_t equals = whole.find('=', static_cast<std::size_t>(after - text.data()));
  const std::size_t bracket = equals < end ? whole.find('(', equals) : end;
  if (bracket >= end) return std::nullopt;
  statement.keyword = trimmed(text.substr(equals + 1, bracket - equals - 1));
  statement.arguments = text.substr(bracket, end - 1 - bracket);
  return statement;
}

// The arguments between the outer brackets, at commas outside of strings and of inner brackets.
std::vector<std::string_view> arguments_of(std::string_view arguments) {
  std::vector<std::string_view> parts;
  const std::string_view inner = trimmed(arguments);
  if (inner.size() < 2 || inner.back() != ')') return parts;
  int depth = 0;
  bool in_string = false;
  std::size_t begin = 1;
  for (std::size_t k = 1; k < inner.size(); ++k) {
    const char letter = inner[k];
    if (letter == '\'') in_string = !in_string;
    if (in_string) continue;
    const bool is_end = k + 1 == inner.size();
    if ((letter == ',' && depth == 0) || is_end) {
      parts.push_back(trimmed(inner.substr(begin, k - begin)));
      begin = k + 1;
    }
    depth += letter == '(' ? 1 : letter == ')' ? -1 : 0;
  }
  return parts;
}

// The numbers behind each # of a text.
std::vector<Id> references(std::string_view text) {
  std::vector<Id> ids;
  for (std::size_t hash = text.find('#'); hash != std::string_view::npos; hash = text.find('#', hash + 1)) {
    Id id = 0;
    if (std::from_chars(text.data() + hash + 1, text.data() + text.size(), id).ec == std::errc()) ids.push_back(id);
  }
  return ids;
}

std::optional<Place2d> place_of(std::string_view arguments) {
  if (!arguments.starts_with("((") || !arguments.ends_with("))")) return std::nullopt;
  const std::string_view inner = arguments.substr(2, arguments.size() - 4);
  const std::size_t comma = inner.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const std::size_t second = std::min(inner.find(',', comma + 1), inner.size());
  // STEP writes 1. where others write 1.0, which reads as the same.
  const auto x = finite_number(trimmed(inner.substr(0, comma)));
  const auto y = finite_number(trimmed(inner.substr(comma + 1, second - comma - 1)));
  if (!x || !y) return std::nullopt;
  return Place2d(*x, *y);
}

// What profiles are made of, by their numbers.
struct Entities {
  std::unordered_map<Id, Place2d> points;
  std::unordered_map<Id, std::vector<Id>> polylines;
  std::vector<StepEntity> profiles;
  Id largest = 0;
};

Entities entities_of(std::string_view text) {
  Entities found;
  // A number that stands anywhere is taken, in comments, too.
  for (const Id id : references(text)) found.largest = std::max(found.largest, id);
  if (found.largest >= std::numeric_limits<Id>::max() / 2) return found;
  for (std::size_t begin = 0, end = 0; (end = end_of_statement(text, begin)) != std::string_view::npos; begin = end) {
    const std::optional<StepEntity> statement = parsed(text, begin, end);
    if (!statement) continue;
    if (statement->keyword == "IFCCARTESIANPOINT") {
      if (const auto place = place_of(statement->arguments)) found.points.emplace(statement->id, *place);
    } else if (statement->keyword == "IFCPOLYLINE") {
      found.polylines.emplace(statement->id, references(statement->arguments));
    } else if (statement->keyword == "IFCARBITRARYPROFILEDEFWITHVOIDS") {
      found.profiles.push_back(*statement);
    }
  }
  return found;
}

// A closed curve as points, the last of which is not the first once more; nothing when it is no polyline.
struct ClosedCurve {
  std::vector<Id> ids;
  std::vector<Place2d> places;
};

std::optional<ClosedCurve> curve_of(const Entities& entities, Id curve) {
  const auto line = entities.polylines.find(curve);
  if (line == entities.polylines.end()) return std::nullopt;
  ClosedCurve closed;
  for (const Id id : line->second) {
    const auto point = entities.points.find(id);
    if (point == entities.points.end()) return std::nullopt;
    closed.ids.push_back(id);
    closed.places.push_back(point->second);
  }
  while (closed.places.size() > 1 && closed.places.back() == closed.places.front()) {
    closed.ids.pop_back();
    closed.places.pop_back();
  }
  return closed;
}

// The points of the one walk over all curves of a profile: its third argument is the outline, its fourth the voids.
std::vector<Id> walk_of(const Entities& entities, const StepEntity& profile) {
  const std::vector<std::string_view> arguments = arguments_of(profile.arguments);
  if (arguments.size() != 4) return {};
  std::vector<std::vector<Id>> ids;
  std::vector<std::vector<Place2d>> rings;
  for (const Id id : references(std::string(arguments[2]) + "," + std::string(arguments[3]))) {
    std::optional<ClosedCurve> curve = curve_of(entities, id);
    if (!curve) return {};
    ids.push_back(std::move(curve->ids));
    rings.push_back(std::move(curve->places));
  }
  const auto walk = rings.size() < 2 ? std::nullopt : joined_rings(rings);
  if (!walk) return {};
  std::vector<Id> points;
  for (const auto& [ring, corner] : *walk) points.push_back(ids[ring][corner]);
  return points;
}

}  // namespace

JoinedVoids with_joined_voids(std::string_view text) {
  JoinedVoids result;
  const Entities entities = entities_of(text);
  Id next = entities.largest + 1;
  std::size_t done = 0;
  for (const StepEntity& profile : entities.profiles) {
    const std::vector<Id> walk = walk_of(entities, profile);
    if (walk.empty()) {
      ++result.left;
      continue;
    }
    ++result.joined;
    // The type and the name of the profile stay; what follows is the first curve.
    const std::vector<std::string_view> arguments = arguments_of(profile.arguments);
    const std::string head = "(" + std::string(arguments[0]) + "," + std::string(arguments[1]);
    std::string points;
    for (const Id id : walk) points += (points.empty() ? "#" : ",#") + std::to_string(id);
    points += ",#" + std::to_string(walk[0]);
    result.text += text.substr(done, profile.begin - done);
    result.text += "#" + std::to_string(next) + "=IFCPOLYLINE((" + points + "));\n#" + std::to_string(profile.id) +
                   "=IFCARBITRARYCLOSEDPROFILEDEF" + head + ",#" + std::to_string(next) + ");";
    ++next;
    done = profile.end;
  }
  result.text += text.substr(done);
  return result;
}

}  // namespace patchlight
