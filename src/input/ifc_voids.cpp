#include "input/ifc_voids.h"

#include "input/text.h"

#include <Eigen/Core>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace patchlight {
namespace {

using Id = std::uint64_t;
using Place = Eigen::Vector2d;

// "#12=IFCPOLYLINE((#1,#2));"
struct StepEntity {
  Id id = 0;
  std::string_view keyword = {};
  std::string_view arguments = {};  // with their brackets
  std::size_t begin = 0;            // of the whole in the text
  std::size_t end = 0;              // behind its semicolon
};

// The end of the statement that begins at `begin`: behind the next semicolon outside of strings; npos without one.
std::size_t end_of_statement(std::string_view text, std::size_t begin) {
  bool in_string = false;
  for (std::size_t k = begin; k < text.size(); ++k) {
    if (text[k] == '\'') in_string = !in_string;
    if (text[k] == ';' && !in_string) return k + 1;
  }
  return std::string_view::npos;
}

std::optional<StepEntity> parsed(std::string_view text, std::size_t begin, std::size_t end) {
  const std::size_t hash = text.find_first_not_of(" \t\r\n", begin);
  if (hash >= end || text[hash] != '#') return std::nullopt;
  StepEntity statement{.begin = hash, .end = end};
  const char* const last = text.data() + end;
  const auto [after, error] = std::from_chars(text.data() + hash + 1, last, statement.id);
  if (error != std::errc()) return std::nullopt;
  const std::size_t equals = text.find('=', static_cast<std::size_t>(after - text.data()));
  const std::size_t bracket = equals < end ? text.find('(', equals) : end;
  if (bracket >= end) return std::nullopt;
  statement.keyword = trimmed(text.substr(equals + 1, bracket - equals - 1));
  statement.arguments = text.substr(bracket, end - 1 - bracket);
  return statement;
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

std::optional<Place> place_of(std::string_view arguments) {
  if (!arguments.starts_with("((") || !arguments.ends_with("))")) return std::nullopt;
  const std::string_view inner = arguments.substr(2, arguments.size() - 4);
  const std::size_t comma = inner.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const std::size_t second = std::min(inner.find(',', comma + 1), inner.size());
  // STEP writes 1. where others write 1.0, which reads as the same.
  const auto x = finite_number(trimmed(inner.substr(0, comma)));
  const auto y = finite_number(trimmed(inner.substr(comma + 1, second - comma - 1)));
  if (!x || !y) return std::nullopt;
  return Place(*x, *y);
}

// What profiles are made of, by their numbers.
struct Entities {
  std::unordered_map<Id, Place> points;
  std::unordered_map<Id, std::vector<Id>> polylines;
  std::vector<StepEntity> profiles;
  Id largest = 0;
};

Entities entities_of(std::string_view text) {
  Entities found;
  for (std::size_t begin = 0, end = 0; (end = end_of_statement(text, begin)) != std::string_view::npos; begin = end) {
    const std::optional<StepEntity> statement = parsed(text, begin, end);
    if (!statement) continue;
    found.largest = std::max(found.largest, statement->id);
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
struct Ring {
  std::vector<Id> ids;
  std::vector<Place> places;
};

std::optional<Ring> ring_of(const Entities& entities, Id curve) {
  const auto line = entities.polylines.find(curve);
  if (line == entities.polylines.end()) return std::nullopt;
  Ring ring;
  for (const Id id : line->second) {
    const auto point = entities.points.find(id);
    if (point == entities.points.end()) return std::nullopt;
    ring.ids.push_back(id);
    ring.places.push_back(point->second);
  }
  while (ring.places.size() > 1 && ring.places.back() == ring.places.front()) {
    ring.ids.pop_back();
    ring.places.pop_back();
  }
  if (ring.places.size() < 3) return std::nullopt;
  return ring;
}

double twice_the_area(const Ring& ring) {
  double sum = 0;
  for (std::size_t k = 0; k < ring.places.size(); ++k) {
    const Place& a = ring.places[k];
    const Place& b = ring.places[(k + 1) % ring.places.size()];
    sum += a.x() * b.y() - b.x() * a.y();
  }
  return sum;
}

double turn(const Place& a, const Place& b, const Place& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Does the inner part of the segment from a to b meet an edge of the ring that ends at neither?
bool meets(const Ring& ring, const Place& a, const Place& b) {
  for (std::size_t k = 0; k < ring.places.size(); ++k) {
    const Place& c = ring.places[k];
    const Place& d = ring.places[(k + 1) % ring.places.size()];
    if (c == a || c == b || d == a || d == b) continue;
    if (turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0) return true;
  }
  return false;
}

// The outline, to the void and back along the shortest seam that meets nothing; nothing without such a seam.
std::optional<Ring> with_hole(const Ring& outline, Ring hole, const std::vector<Ring>& others) {
  if (twice_the_area(outline) * twice_the_area(hole) > 0) {
    std::reverse(hole.ids.begin(), hole.ids.end());
    std::reverse(hole.places.begin(), hole.places.end());
  }
  double shortest = std::numeric_limits<double>::infinity();
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < outline.places.size(); ++i) {
    for (std::size_t j = 0; j < hole.places.size(); ++j) {
      const Place& a = outline.places[i];
      const Place& b = hole.places[j];
      if (!((b - a).norm() < shortest) || a == b || meets(outline, a, b) || meets(hole, a, b)) continue;
      if (std::any_of(others.begin(), others.end(), [&](const Ring& other) { return meets(other, a, b); })) continue;
      shortest = (b - a).norm();
      from = i;
      to = j;
    }
  }
  if (!std::isfinite(shortest)) return std::nullopt;
  Ring ring;
  const auto add = [&ring](const Ring& source, std::size_t k) {
    ring.ids.push_back(source.ids[k % source.ids.size()]);
    ring.places.push_back(source.places[k % source.places.size()]);
  };
  for (std::size_t i = 0; i <= from; ++i) add(outline, i);
  for (std::size_t j = 0; j <= hole.ids.size(); ++j) add(hole, to + j);
  for (std::size_t i = from; i < outline.ids.size(); ++i) add(outline, i);
  return ring;
}

// The one ring of a profile: its third argument is the outline, its fourth the list of voids.
std::optional<Ring> ring_of_profile(const Entities& entities, const StepEntity& profile) {
  constexpr std::size_t most_corners = 2000;  // the search for seams takes their square
  const std::vector<Id> curves = references(profile.arguments);
  std::vector<Ring> rings;
  std::size_t corners = 0;
  for (const Id curve : curves) {
    std::optional<Ring> ring = ring_of(entities, curve);
    if (!ring) return std::nullopt;
    corners += ring->ids.size();
    rings.push_back(std::move(*ring));
  }
  if (rings.size() < 2 || corners > most_corners) return std::nullopt;
  std::optional<Ring> all = std::move(rings[0]);
  for (std::size_t k = 1; all && k < rings.size(); ++k)
    all = with_hole(*all, rings[k], std::vector<Ring>(rings.begin() + static_cast<std::ptrdiff_t>(k) + 1, rings.end()));
  return all;
}

}  // namespace

JoinedVoids with_joined_voids(std::string_view text) {
  JoinedVoids result;
  const Entities entities = entities_of(text);
  Id next = entities.largest + 1;
  std::size_t done = 0;
  for (const StepEntity& profile : entities.profiles) {
    const std::optional<Ring> ring = ring_of_profile(entities, profile);
    if (!ring) {
      ++result.left;
      continue;
    }
    ++result.joined;
    // The type and the name of the profile stay; what follows is the first curve.
    const std::string head(profile.arguments.substr(0, profile.arguments.find(",#")));
    std::string points;
    for (const Id id : ring->ids) points += (points.empty() ? "#" : ",#") + std::to_string(id);
    points += ",#" + std::to_string(ring->ids[0]);
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
