#include "output/plot/write_drawing.h"

#include "patchlight/base/error.h"

#include "output/file/write_bytes.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <memory>

namespace patchlight {
namespace {

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};
struct Drawing {
  int width, height;
  const std::function<void(cairo_t*)>& draw;
};

using Surface = std::unique_ptr<cairo_surface_t, Destroy>;

cairo_status_t append(void* bytes, const unsigned char* more, unsigned int count) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(more), count);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status, const std::filesystem::path& file) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw OutputError(file.string(), std::string("the drawing cannot be drawn: ") + cairo_status_to_string(status));
}

void draw_on(const Surface& surface, const Drawing& drawing, const std::filesystem::path& file) {
  const std::unique_ptr<cairo_t, Destroy> cairo(cairo_create(surface.get()));
  drawing.draw(cairo.get());
  check(cairo_status(cairo.get()), file);
}

std::string png_bytes(const Drawing& drawing, const std::filesystem::path& file) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, drawing.width, drawing.height));
  draw_on(surface, drawing, file);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), file);
  return bytes;
}

// cairo names the outermost group after a number that counts the surfaces of the process: it would differ from file to
// file.
std::string without_surface_number(std::string svg) {
  const std::string name = "id=\"surface";
  const std::size_t begin = svg.find(name);
  if (begin == std::string::npos) return svg;
  const std::size_t number = begin + name.size();
  return svg.erase(number, svg.find('"', number) - number);
}

std::string svg_bytes(const Drawing& drawing, const std::filesystem::path& file) {
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, drawing.width, drawing.height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  draw_on(surface, drawing, file);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), file);
  return without_surface_number(std::move(bytes));
}

}  // namespace

void write_drawing(const std::filesystem::path& file, int width, int height,
                   const std::function<void(cairo_t*)>& draw) {
  const Drawing drawing{width, height, draw};
  const std::string extension = file.extension().string();
  if (extension == ".svg") return write_bytes(file, svg_bytes(drawing, file));
  if (extension == ".png") return write_bytes(file, png_bytes(drawing, file));
  throw OutputError(file.string(), "the extension names no known format of drawings; expected .svg or .png");
}

}  // namespace patchlight
