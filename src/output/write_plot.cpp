#include "output/write_plot.h"

#include "patchlight/base/error.h"

#include "output/draw_plot.h"
#include "output/write_drawing.h"

namespace patchlight {

void write_plot(const std::filesystem::path& file, const Plot& plot) {
  if (file.extension() != ".svg" && file.extension() != ".png")
    throw OutputError(file.string(), "the extension names no known format of plots; expected .svg or .png");
  write_drawing(file, plot_width, plot_height, [&](cairo_t* cairo) { draw_plot(cairo, plot); });
}

}  // namespace patchlight
