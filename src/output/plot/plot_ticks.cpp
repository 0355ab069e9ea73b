#include "output/plot/plot_ticks.h"

#include "base/tolerances.h"

#include <algorithm>
#include <array>
#include <cairo.h>
#include <cassert>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace patchlight {
namespace {

constexpr double largest_shown = 1e200;

// The k for which 10^k <= value < 10^(k + 1).
int decade(double value) { return static_cast<int>(std::floor(std::log10(value) + tolerance_of_shapes)); }

double power_of_ten(double exponent) { return std::pow(10.0, exponent); }

// The smallest of 1, 2 and 5 times a power of ten that divides the span into at most `most` parts.
double nice_step(double span, int most) {
  const double power = power_of_ten(std::floor(std::log10(span / most)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (span <= digit * power * most * (1 + tolerance_of_shapes)) return digit * power;
  }
  return 10 * power;
}

AxisRange linear_range(double lower, double upper, int most) {
  const double size = std::max(std::abs(lower), std::abs(upper));
  if (upper - lower <= std::max(tolerance_of_shapes * size, 1 / largest_shown)) {
    const double margin = size > 1 / largest_shown ? size / 2 : 1;
    lower -= margin;
    upper += margin;
  }
  // The second time the step of the wider range counts; this one has room for it.
  for (int k = 0; k < 2; ++k) {
    const double step = nice_step(upper - lower, most);
    lower = step * std::floor(lower / step + tolerance_of_shapes);
    upper = step * std::ceil(upper / step - tolerance_of_shapes);
  }
  return {lower, upper};
}

AxisRange logarithmic_range(double lower, double upper) {
  const double span = std::log10(upper) - std::log10(lower);
  const double wider = span > tolerance_of_shapes ? 0.03 * span : 0.5;
  return {power_of_ten(std::log10(lower) - wider), power_of_ten(std::log10(upper) + wider)};
}

std::string with_minus_sign(std::string number) {
  if (number.front() == '-') number.replace(0, 1, "\u2212");
  return number;
}

std::string plain_number(double value, int decimals) {
  std::array<char, 350> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, std::max(0, decimals));
  return with_minus_sign({text.data(), end});
}

std::string exponent_text(int exponent) { return with_minus_sign(std::to_string(exponent)); }

std::vector<Tick> linear_ticks(const AxisRange& range, int most) {
  const double step = nice_step(range.upper - range.lower, most);
  const double largest = std::max(std::abs(range.lower), std::abs(range.upper));
  const bool plain = largest >= 1e-3 && largest < 1e6;
  const int exponent = plain ? 0 : decade(largest);
  std::vector<Tick> ticks;
  const double last = std::floor(range.upper / step + tolerance_of_shapes);
  for (double k = std::ceil(range.lower / step - tolerance_of_shapes); k <= last; ++k) {
    const double value = k * step + 0.0;  // -0 becomes 0
    if (value == 0 || plain) {
      ticks.push_back({value, plain_number(value, value == 0 ? 0 : -decade(step)), ""});
    } else {
      const std::string digits = plain_number(value / power_of_ten(exponent), exponent - decade(step));
      ticks.push_back({value, digits + "\u00d710", exponent_text(exponent)});
    }
  }
  return ticks;
}

// digit x 10^exponent.
Tick decimal_tick(int digit, int exponent) {
  const double value = digit * power_of_ten(exponent);
  if (exponent >= -2 && exponent <= 4) return {value, plain_number(value, -exponent), ""};
  return {value, (digit == 1 ? "" : std::to_string(digit) + "\u00d7") + "10", exponent_text(exponent)};
}

// Every multiple 1 ... 9 of the powers of ten; those of 1, 2 and 5 have labels.
std::vector<Tick> digit_ticks(const AxisRange& range) {
  std::vector<Tick> ticks;
  for (int k = decade(range.lower); k <= decade(range.upper); ++k) {
    for (int digit = 1; digit <= 9; ++digit) {
      Tick tick = decimal_tick(digit, k);
      if (tick.value < range.lower * (1 - tolerance_of_shapes) || tick.value > range.upper * (1 + tolerance_of_shapes))
        continue;
      if (digit != 1 && digit != 2 && digit != 5) tick.text.clear(), tick.exponent.clear();
      ticks.push_back(tick);
    }
  }
  return ticks;
}

// Powers of ten; when they are too many, only every second, third, ... has a label. When they are few, the multiples 2
// ... 9 are ticks, too.
std::vector<Tick> decade_ticks(const AxisRange& range, int most) {
  const int count = decade(range.upper) - decade(range.lower) + 1;
  const int stride = (count + most - 1) / most;
  std::vector<Tick> ticks = digit_ticks(range);
  if (count > 6) {
    std::erase_if(ticks, [](const Tick& tick) { return tick.value > 1.5 * power_of_ten(decade(tick.value)); });
  }
  for (Tick& tick : ticks) {
    const int k = decade(tick.value);
    const bool labelled = k % stride == 0 && tick.value < 1.5 * power_of_ten(k);
    tick.text = labelled ? "10" : "";
    tick.exponent = labelled ? exponent_text(k) : "";
  }
  return ticks;
}

std::size_t labels(const std::vector<Tick>& ticks) {
  return static_cast<std::size_t>(
      std::count_if(ticks.begin(), ticks.end(), [](const Tick& tick) { return !tick.text.empty(); }));
}

constexpr double exponent_size = 0.75;

double text_size(cairo_t* cairo) {
  cairo_matrix_t matrix;
  cairo_get_font_matrix(cairo, &matrix);
  return matrix.yy;
}

std::string as_utf8(const std::string& text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

// Without the last character, which may have several bytes.
std::string shorter(std::string text) {
  const auto continues = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; };
  while (text.size() > 1 && continues(text.back())) text.pop_back();
  text.pop_back();
  return text;
}

double shift(double width, Align align) {
  if (align == Align::left) return 0;
  return align == Align::centre ? -width / 2 : -width;
}

}  // namespace

bool on_axis(double value, Scale scale) {
  if (!(std::abs(value) <= largest_shown)) return false;
  return scale == Scale::linear || value >= 1 / largest_shown;
}

AxisRange axis_range(const std::vector<double>& values, Scale scale, int most) {
  if (values.empty()) return scale == Scale::linear ? AxisRange{0, 1} : AxisRange{0.1, 10};
  const auto [lower, upper] = std::minmax_element(values.begin(), values.end());
  assert(on_axis(*lower, scale) && on_axis(*upper, scale));
  return scale == Scale::linear ? linear_range(*lower, *upper, most) : logarithmic_range(*lower, *upper);
}

std::vector<Tick> axis_ticks(const AxisRange& range, Scale scale, int most) {
  assert(range.lower < range.upper && most >= 2);
  if (scale == Scale::linear) return linear_ticks(range, most);
  const std::vector<Tick> decades = decade_ticks(range, most), digits = digit_ticks(range);
  const auto limit = static_cast<std::size_t>(most);
  if (labels(decades) > 2 || (labels(decades) == 2 && labels(digits) > limit)) return decades;
  return labels(digits) >= 2 ? digits : linear_ticks(range, most);
}

double place_on_axis(double value, const AxisRange& range, Scale scale) {
  if (scale == Scale::linear) return (value - range.lower) / (range.upper - range.lower);
  const double lower = std::log10(range.lower);
  return (std::log10(value) - lower) / (std::log10(range.upper) - lower);
}

void set_grey(cairo_t* cairo, double grey) { cairo_set_source_rgb(cairo, grey, grey, grey); }

void add_line(cairo_t* cairo, const Pixel& from, const Pixel& to) {
  cairo_move_to(cairo, from.x, from.y);
  cairo_line_to(cairo, to.x, to.y);
}

void set_text_size(cairo_t* cairo, double size) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  // Exact shapes and widths, whatever this machine's settings for its screen are.
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

double text_width(cairo_t* cairo, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  return extents.x_advance;
}

std::string fitting_text(cairo_t* cairo, const std::string& text, double width) {
  std::string fitting = as_utf8(text);
  if (text_width(cairo, fitting) <= width) return fitting;
  while (!fitting.empty() && text_width(cairo, fitting + "...") > width) fitting = shorter(std::move(fitting));
  return fitting + "...";
}

void draw_text(cairo_t* cairo, const Pixel& at, const std::string& text, Align align) {
  // Digits are 0.72 of the size high.
  cairo_move_to(cairo, at.x + shift(text_width(cairo, text), align), at.y + 0.36 * text_size(cairo));
  cairo_show_text(cairo, text.c_str());
  cairo_new_path(cairo);
}

void draw_label(cairo_t* cairo, const Pixel& at, const Tick& tick, Align align) {
  const double left = at.x + shift(label_width(cairo, tick), align);
  draw_text(cairo, {left, at.y}, tick.text, Align::left);
  const double right = left + text_width(cairo, tick.text), size = text_size(cairo);
  cairo_set_font_size(cairo, exponent_size * size);
  draw_text(cairo, {right, at.y - 0.45 * size}, tick.exponent, Align::left);
  cairo_set_font_size(cairo, size);
}

double label_width(cairo_t* cairo, const Tick& tick) {
  const double size = text_size(cairo), width = text_width(cairo, tick.text);
  cairo_set_font_size(cairo, exponent_size * size);
  const double raised = text_width(cairo, tick.exponent);
  cairo_set_font_size(cairo, size);
  return width + raised;
}

}  // namespace patchlight
