#include "input/radiance/radiance_programs.h"

#include "patchlight/base/error.h"

#include "input/round_shapes.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

enum class Edges : std::uint8_t { sharp, bevelled, round };

struct RadianceBox {
  std::string material;
  std::string name;
  Vector size = Vector::Zero();
  double inset = 0;  // from the sides of the box: bevel, or radius of the edges
  Edges edges = Edges::sharp;
  bool is_inward = false;
};

double length_of(const std::string& word, const std::string& where) {
  const std::optional<double> length = finite_number(word);
  if (!length || !(*length > 0)) throw InputError(where, "genbox: found '" + word + "'; expected a length above 0");
  return *length;
}

RadianceBox box_of(std::span<const std::string> words, const std::string& where) {
  if (words.size() < 5) throw InputError(where, "genbox: expected MATERIAL NAME X Y Z and options");
  RadianceBox box{.material = words[0], .name = words[1]};
  for (std::size_t axis = 0; axis < 3; ++axis)
    box.size[static_cast<Eigen::Index>(axis)] = length_of(words[2 + axis], where);
  for (std::size_t k = 5; k < words.size(); ++k) {
    if (words[k] == "-i") {
      box.is_inward = true;
    } else if (words[k] == "-b" || words[k] == "-r") {
      box.edges = words[k] == "-b" ? Edges::bevelled : Edges::round;
      if (++k == words.size()) throw InputError(where, "genbox: a length has to follow " + words[k - 1]);
      box.inset = length_of(words[k], where);
    } else {
      throw InputError(where, "genbox: the option " + words[k] + " is not known; expected -b, -r or -i");
    }
  }
  if (!(2 * box.inset < box.size.minCoeff()))
    throw InputError(where, "genbox: edges of " + std::to_string(box.inset) +
                                " do not fit; expected less than half of the shortest side");
  return box;
}

// A corner of the box; bit k is set at the far end of axis k.
using Corner = unsigned;

bool is_far(Corner corner, Eigen::Index axis) { return (corner >> static_cast<unsigned>(axis) & 1U) != 0; }

// The corner moved inward by the inset along all axes.
Point inner_point(const RadianceBox& box, Corner corner) {
  Point point;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[axis] = is_far(corner, axis) ? box.size[axis] - box.inset : box.inset;
  return point;
}

// The corner moved inward along all axes except `axis`.
Point point_on_side(const RadianceBox& box, Corner corner, Eigen::Index axis) {
  Point point = inner_point(box, corner);
  point[axis] = is_far(corner, axis) ? box.size[axis] : 0;
  return point;
}

class BoxSurfaces {
 public:
  explicit BoxSurfaces(RadianceBox box) : box_(std::move(box)) {}

  void add_polygon(std::vector<Point> corners) {
    // The box is convex: fronts point away from its center.
    const bool looks_outward = area_vector(corners).dot(corners[0] - box_.size / 2) > 0;
    if (looks_outward == box_.is_inward) std::reverse(corners.begin(), corners.end());
    RadiancePrimitive& polygon = add("polygon");
    for (const Point& corner : corners) polygon.numbers.insert(polygon.numbers.end(), corner.begin(), corner.end());
  }

  void add_cylinder(const Point& from, const Point& to) {
    RadiancePrimitive& cylinder = add(box_.is_inward ? "tube" : "cylinder");
    cylinder.numbers = {from.x(), from.y(), from.z(), to.x(), to.y(), to.z(), box_.inset};
  }

  void add_sphere(const Point& centre) {
    add(box_.is_inward ? "bubble" : "sphere").numbers = {centre.x(), centre.y(), centre.z(), box_.inset};
  }

  std::vector<RadiancePrimitive> primitives() && { return std::move(primitives_); }

 private:
  RadiancePrimitive& add(const char* kind) {
    primitives_.push_back({.modifier = box_.material, .kind = kind, .name = box_.name, .words = {}, .numbers = {}});
    return primitives_.back();
  }

  RadianceBox box_;
  std::vector<RadiancePrimitive> primitives_;
};

constexpr std::size_t most_copies = 100'000;

// Takes numbers and other words one after another.
class XformWords {
 public:
  XformWords(std::span<const std::string> words, const std::string& where) : words_(words), where_(where) {}

  bool has_option() const { return at_ < words_.size() && words_[at_].size() > 1 && words_[at_][0] == '-'; }
  const std::string& option() { return option_ = words_[at_++]; }
  std::span<const std::string> rest() const { return words_.subspan(at_); }

  const std::string& word() {
    if (at_ == words_.size()) refuse("something has to follow " + option_);
    return words_[at_++];
  }

  double number() {
    const std::string& text = word();
    const std::optional<double> value = finite_number(text);
    if (!value) refuse("found '" + text + "' where " + option_ + " has a number");
    return *value;
  }

  std::size_t count() {
    const double value = number();
    if (!(value >= 0 && value <= 1e6) || std::floor(value) != value)
      refuse(option_ + " has a whole number from 0 to 1,000,000");
    return static_cast<std::size_t>(value);
  }

  [[noreturn]] void refuse(const std::string& message) const { throw InputError(where_, "xform: " + message); }

 private:
  std::span<const std::string> words_;
  const std::string& where_;
  std::size_t at_ = 0;
  std::string option_;
};

// The transformation of an option; empty for other options.
std::optional<Eigen::Affine3d> step_of(const std::string& option, XformWords& words) {
  Eigen::Affine3d step = Eigen::Affine3d::Identity();
  const std::size_t axis = option.size() == 3 ? std::string("xyz").find(option[2]) : std::string::npos;
  const bool has_axis = axis != std::string::npos;
  const auto a = static_cast<Eigen::Index>(has_axis ? axis : 0);
  if (option == "-t") {
    for (Eigen::Index k = 0; k < 3; ++k) step.translation()[k] = words.number();
  } else if (option == "-s") {
    step.linear() *= words.number();
  } else if (option[1] == 's' && has_axis) {
    step.linear()(a, a) = words.number();
  } else if (option[1] == 'm' && has_axis) {
    step.linear()(a, a) = -1;
  } else if (option[1] == 'r' && has_axis) {
    step.linear() = turned_about(Vector::Unit(a), words.number());
  } else {
    return std::nullopt;
  }
  if (step.linear().determinant() == 0)
    words.refuse(option + " makes everything flat; expected a factor that is not 0");
  return step;
}

// A transformation with its count: repeated -i times, or copied 0 to n - 1 times for -a.
struct Block {
  std::size_t count = 1;
  bool is_array = false;
  Eigen::Affine3d step = Eigen::Affine3d::Identity();
};

// Repeated squaring.
Eigen::Affine3d power(Eigen::Affine3d step, std::size_t count) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  for (; count > 0; count /= 2, step = step * step) {
    if (count % 2 == 1) result = step * result;
  }
  return result;
}

// Combines all placements with all steps of the block: the last array varies fastest.
std::vector<Eigen::Affine3d> moved_by(const std::vector<Eigen::Affine3d>& places, const Block& block,
                                      const XformWords& words) {
  if (block.is_array && places.size() * block.count > most_copies)
    words.refuse("makes more than 100,000 copies; expected smaller arrays");
  const Eigen::Affine3d once = power(block.step, block.is_array ? 0 : block.count);
  std::vector<Eigen::Affine3d> moved;
  for (const Eigen::Affine3d& place : places) {
    Eigen::Affine3d next = once * place;
    for (std::size_t k = 1; k < block.count && block.is_array; ++k, next = block.step * next) moved.push_back(next);
    if (block.count > 0 || !block.is_array) moved.push_back(next);
  }
  return moved;
}

// Combines all placements with each line of a file.
std::vector<Eigen::Affine3d> moved_by_lines(const std::vector<Eigen::Affine3d>& places,
                                            const std::vector<std::vector<std::string>>& lines,
                                            const std::string& where) {
  std::vector<Eigen::Affine3d> moved;
  const auto no_file = [&](const std::string& file) -> std::vector<std::vector<std::string>> {
    throw InputError(where, "xform: -f stands in the file of another -f, " + file);
  };
  for (const std::vector<std::string>& line : lines) {
    if (line.empty()) continue;
    const RadianceXform one = radiance_xform(line, where, no_file);
    if (places.size() * one.copies.size() + moved.size() > most_copies)
      throw InputError(where, "xform: makes more than 100,000 copies; expected smaller arrays");
    for (const Eigen::Affine3d& place : places)
      for (const Eigen::Affine3d& copy : one.copies) moved.push_back(copy * place);
  }
  return moved;
}

}  // namespace

std::vector<RadiancePrimitive> radiance_genbox(std::span<const std::string> arguments, const std::string& where) {
  const RadianceBox box = box_of(arguments, where);
  BoxSurfaces surfaces(box);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Corner along = 1U << static_cast<unsigned>(axis);
    const Corner next = 1U << static_cast<unsigned>((axis + 1) % 3);
    const Corner last = 1U << static_cast<unsigned>((axis + 2) % 3);
    // Sides across this axis
    for (const Corner side : {0U, along}) {
      std::vector<Point> corners;
      for (const Corner corner : {side, side | next, side | next | last, side | last})
        corners.push_back(point_on_side(box, corner, axis));
      surfaces.add_polygon(std::move(corners));
    }
    if (box.edges == Edges::sharp) continue;
    // Edges along this axis
    for (const Corner edge : std::array{0U, next, last, next | last}) {
      if (box.edges == Edges::round) {
        surfaces.add_cylinder(inner_point(box, edge), inner_point(box, edge | along));
        continue;
      }
      const Eigen::Index a = (axis + 1) % 3, b = (axis + 2) % 3;
      surfaces.add_polygon({point_on_side(box, edge, a), point_on_side(box, edge | along, a),
                            point_on_side(box, edge | along, b), point_on_side(box, edge, b)});
    }
  }
  // Corners
  constexpr Corner corners = 8;
  for (Corner corner = 0; corner < corners && box.edges != Edges::sharp; ++corner) {
    if (box.edges == Edges::round)
      surfaces.add_sphere(inner_point(box, corner));
    else
      surfaces.add_polygon(
          {point_on_side(box, corner, 0), point_on_side(box, corner, 1), point_on_side(box, corner, 2)});
  }
  return std::move(surfaces).primitives();
}

RadianceXform radiance_xform(std::span<const std::string> arguments, const std::string& where,
                             const std::function<std::vector<std::vector<std::string>>(const std::string&)>& words_of) {
  RadianceXform result;
  XformWords words(arguments, where);
  Block block;
  const auto end_block = [&] {
    result.copies = moved_by(result.copies, block, words);
    block = Block{};
  };
  while (words.has_option()) {
    const std::string option = words.option();
    if (option == "-n" || option == "-m") {
      (option == "-n" ? result.name : result.modifier) = words.word();
    } else if (option == "-I") {
      result.turns_fronts = true;
    } else if (option == "-i" || option == "-a") {
      end_block();
      block.is_array = option == "-a";
      block.count = words.count();
    } else if (option == "-f") {
      end_block();
      result.copies = moved_by_lines(result.copies, words_of(words.word()), where);
    } else if (option != "-c" && option != "-e" && option != "-l") {
      const std::optional<Eigen::Affine3d> step = step_of(option, words);
      if (!step) words.refuse("the option " + option + " is not known");
      block.step = *step * block.step;
    }
  }
  end_block();
  for (const std::string& file : words.rest()) result.files.push_back(file);
  return result;
}

}  // namespace patchlight
