#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/tables/read_tables.h"
#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {
namespace {

// Allowed deviation of the table's end angles from those of the standard, degrees.
constexpr double angle_tolerance = 0.01;

// Larger counts and numbers are errors.
constexpr double many = 1e4;
constexpr double huge = 1e12;

struct Word {
  std::string text;
  std::uint32_t line = 0;
};

// The text after TILT=, as words separated by spaces and commas; the first word follows the equals sign.
struct Words {
  std::string file;
  std::vector<Word> words;
  std::size_t next = 0;

  [[noreturn]] void refuse(const std::string& message) const {
    const std::uint32_t line = words[std::min(next > 0 ? next - 1 : 0, words.size() - 1)].line;
    throw InputError(file + ":" + std::to_string(line), message);
  }

  double number(const std::string& what) {
    if (next == words.size()) {
      refuse("the file ends before " + what + "; expected as many numbers as its counts of angles promise");
    }
    const Word& word = words[next++];
    const std::optional<double> value = finite_number(word.text);
    if (!value) refuse("found '" + word.text + "' for " + what + "; expected a number");
    return *value;
  }

  double number_from(const std::string& what, double least, double most) {
    const double value = number(what);
    if (value < least || value > most) {
      refuse("found " + shortest(value) + " for " + what + "; expected a number from " + shortest(least) + " to " +
             shortest(most));
    }
    return value;
  }

  std::size_t count(const std::string& what, double least, double most) {
    const double value = number_from(what, least, most);
    if (value != std::floor(value)) refuse("found " + shortest(value) + " for " + what + "; expected a whole number");
    return static_cast<std::size_t>(value);
  }

  std::vector<double> numbers(std::size_t count, const std::string& what) {
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) values.push_back(number(what));
    return values;
  }

  std::vector<double> ascending(std::size_t count, const std::string& what) {
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) {
      values.push_back(number(what));
      if (k > 0 && !(values[k] > values[k - 1])) {
        refuse("found " + shortest(values[k]) + " after " + shortest(values[k - 1]) + " in " + what +
               "; expected ascending angles");
      }
    }
    return values;
  }
};

Words words_after_tilt(const std::string& text, const std::string& file) {
  Words found{file, {}, 0};
  bool in_numbers = false;
  std::uint32_t last_line = 1;
  for (const TextLine& line : logical_lines(text)) {
    last_line = line.number;
    std::string content = line.text;
    if (!in_numbers) {
      if (content.rfind("TILT=", 0) != 0) continue;
      in_numbers = true;
      content = content.substr(5);
      std::replace(content.begin(), content.end(), ',', ' ');
      if (trimmed(content).empty()) content = "nothing";
    }
    std::replace(content.begin(), content.end(), ',', ' ');
    for (const std::string_view word : words(content)) found.words.push_back({std::string(word), line.number});
  }
  if (!in_numbers) {
    throw InputError(file + ":" + std::to_string(last_line),
                     "found no line that begins with TILT=; expected a photometric file of the format IES LM-63");
  }
  return found;
}

struct Tilt {
  std::vector<double> angles;
  std::vector<double> factors;
};

Tilt read_tilt(Words& words) {
  const Word word = words.words[words.next++];
  if (word.text == "NONE") return {};
  if (word.text != "INCLUDE") {
    words.refuse("found TILT=" + word.text + "; expected TILT=NONE, or TILT=INCLUDE with the table in this file");
  }
  words.count("the lamp's position in the luminaire", 1, 3);
  const std::size_t angles = words.count("the number of tilt angles", 1, 1000);
  Tilt tilt;
  tilt.angles = words.ascending(angles, "the tilt angles");
  tilt.factors = words.numbers(angles, "the tilt factors");
  return tilt;
}

bool is_near(double angle, double expected) { return std::abs(angle - expected) < angle_tolerance; }

// The end angles define the directions of the table; the standard allows few.
void check_vertical(const PhotometricWeb& web, const Words& words) {
  const double first = web.vertical.front();
  const double last = web.vertical.back();
  const double lowest = web.type == PhotometricType::c ? 0 : -90;
  const double highest = web.type == PhotometricType::c ? 180 : 90;
  const bool whole = first >= lowest - angle_tolerance && last <= highest + angle_tolerance;
  const double middle = (lowest + highest) / 2;
  if (whole && (is_near(first, lowest) || is_near(first, middle)) && (is_near(last, highest) || is_near(last, middle)))
    return;
  words.refuse("found vertical angles from " + shortest(first) + " to " + shortest(last) +
               "; expected them to begin at " + shortest(lowest) + " or " + shortest(middle) + " and to end at " +
               shortest(middle) + " or " + shortest(highest));
}

void check_horizontal(const PhotometricWeb& web, const Words& words) {
  const double first = web.horizontal.front();
  const double last = web.horizontal.back();
  const std::string found = "found horizontal angles from " + shortest(first) + " to " + shortest(last);
  if (web.type != PhotometricType::c) {
    if ((is_near(first, 0) || is_near(first, -90)) && is_near(last, 90)) return;
    words.refuse(found + "; expected 0 to 90 or -90 to 90 with photometric type A or B");
  }
  if (is_near(first, 0) && (is_near(last, 0) || is_near(last, 90) || is_near(last, 180) || is_near(last, 360))) return;
  if (is_near(first, 90) && is_near(last, 270)) return;
  words.refuse(found + "; expected 0 alone, or 0 to 90, 180 or 360, or 90 to 270 with photometric type C");
}

PhotometricType type_of(std::size_t number) {
  if (number == 1) return PhotometricType::c;
  return number == 2 ? PhotometricType::b : PhotometricType::a;
}

// The two lines of single numbers after the tilt.
struct IesHeader {
  double lamp_lumens = 0;
  double factor = 1;  // of the candela values
  std::size_t vertical = 0;
  std::size_t horizontal = 0;
  PhotometricType type = PhotometricType::c;
  Vector opening = Vector::Zero();
  OpeningShape shape = OpeningShape::box;
  double watts = 0;
};

// IES LM-63-02, table 1.
OpeningShape shape_of(const Vector& stated) {
  const bool width = stated[0] < 0, length = stated[1] < 0, height = stated[2] < 0;
  if (width && length) return height ? OpeningShape::ellipsoid : OpeningShape::upright_cylinder;
  if (height && width) return OpeningShape::cylinder_by_length;
  if (height && length) return OpeningShape::cylinder_by_width;
  return OpeningShape::box;
}

IesHeader read_header(Words& words) {
  IesHeader header;
  const auto lamps = static_cast<double>(words.count("the number of lamps", 1, many));
  const double lumens = words.number("the lumens per lamp");
  if (lumens < 0 && lumens != -1) {
    words.refuse("found " + shortest(lumens) + " lumens per lamp; expected 0 or more, or -1 for absolute photometry");
  }
  header.lamp_lumens = lumens < 0 ? 0 : lamps * lumens;
  header.factor = words.number_from("the candela multiplier", 0, huge);
  header.vertical = words.count("the number of vertical angles", 2, many);
  header.horizontal = words.count("the number of horizontal angles", 1, many);
  header.type = type_of(words.count("the photometric type", 1, 3));
  const double unit = words.count("the units type", 1, 2) == 1 ? 0.3048 : 1;  // feet or meters
  Vector stated;                                                              // width, length, height
  for (int axis = 0; axis < 3; ++axis) stated[axis] = words.number("the luminous opening");
  // LM-63 of 1991 and 1995 give circles, vertical cylinders and spheres without a length.
  if (stated[0] < 0 && stated[1] == 0) stated[1] = stated[0];
  header.opening = unit * stated.cwiseAbs();
  header.shape = shape_of(stated);
  header.factor *= words.number_from("the ballast factor", 0, huge);
  header.factor *= words.number_from("the ballast-lamp factor", 0, huge);
  header.watts = words.number("the input watts");
  return header;
}

}  // namespace

PhotometricWeb parse_ies(const std::string& text, const std::string& file) {
  Words words = words_after_tilt(text, file);
  const Tilt tilt = read_tilt(words);
  const IesHeader header = read_header(words);
  PhotometricWeb web{.file = file,
                     .type = header.type,
                     .opening = header.opening,
                     .shape = header.shape,
                     .lamp_lumens = header.lamp_lumens,
                     .watts = header.watts,
                     .tilt = tilt.angles,
                     .tilt_factor = tilt.factors};
  web.vertical = words.ascending(header.vertical, "the vertical angles");
  check_vertical(web, words);
  web.horizontal = words.ascending(header.horizontal, "the horizontal angles");
  check_horizontal(web, words);
  for (std::size_t k = 0; k < header.vertical * header.horizontal; ++k)
    web.candela.push_back(header.factor * words.number_from("the candela values", 0, huge));
  if (words.next == words.words.size()) return web;
  const std::string& left = words.words[words.next++].text;
  words.refuse("found '" + left + "' after the last candela value; expected the end of the file. Are its counts of " +
               "angles right?");
}

PhotometricWeb read_ies(const std::filesystem::path& file) {
  return parse_ies(read_text(file, file.string(), "photometric file"), file.string());
}

}  // namespace patchlight
