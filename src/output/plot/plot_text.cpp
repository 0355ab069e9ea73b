#include "output/plot/plot_text.h"

#include <nlohmann/json.hpp>

namespace patchlight {
namespace {

constexpr double exponent_size = 0.75;
constexpr double exponent_rise = 0.45;
// Half the height of a digit.
constexpr double half_height = 0.36;

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
  cairo_move_to(cairo, at.x + shift(text_width(cairo, text), align), at.y + half_height * text_size(cairo));
  cairo_show_text(cairo, text.c_str());
  cairo_new_path(cairo);
}

void draw_label(cairo_t* cairo, const Pixel& at, const Tick& tick, Align align) {
  const double left = at.x + shift(label_width(cairo, tick), align);
  draw_text(cairo, {left, at.y}, tick.text, Align::left);
  const double right = left + text_width(cairo, tick.text), size = text_size(cairo);
  cairo_set_font_size(cairo, exponent_size * size);
  draw_text(cairo, {right, at.y - exponent_rise * size}, tick.exponent, Align::left);
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
