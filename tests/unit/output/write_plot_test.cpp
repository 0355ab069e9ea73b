#include "output/plot/write_plot.h"

#include "patchlight/base/error.h"

#include "temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

namespace patchlight::write_plot_test {
namespace {

constexpr int width = 900;
constexpr int height = 600;

using Colour = std::array<int, 3>;

// The colors of the first curves.
constexpr std::array<Colour, 5> colours = {
    {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}, {230, 159, 0}}};

struct Picture {
  std::vector<Colour> pixels;  // rows from the top

  const Colour& at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
};

Picture read_png(const std::filesystem::path& file) {
  const vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* const read = reader->GetOutput();
  if (read->GetDimensions()[0] != width || read->GetDimensions()[1] != height) return {};
  Picture picture;
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) {
      const auto* const rgb = static_cast<const std::uint8_t*>(read->GetScalarPointer(x, y, 0));
      picture.pixels.push_back({rgb[0], rgb[1], rgb[2]});
    }
  }
  return picture;
}

bool alike(const Colour& a, const Colour& b) {
  return std::abs(a[0] - b[0]) < 40 && std::abs(a[1] - b[1]) < 40 && std::abs(a[2] - b[2]) < 40;
}

// The mean position of the pixels of this color within columns and rows.
struct Spot {
  double x = 0;
  double y = 0;
  int pixels = 0;
};

Spot spot(const Picture& picture, const Colour& colour, int first_column, int end_column) {
  Spot found;
  for (int y = 0; y < height; ++y) {
    for (int x = first_column; x < end_column; ++x) {
      if (alike(picture.at(x, y), colour)) ++found.pixels, found.x += x, found.y += y;
    }
  }
  found.x /= found.pixels;
  found.y /= found.pixels;
  return found;
}

Plot convergence() {
  Plot plot{"room", {"iterations", Scale::linear}, {"relative error", Scale::logarithmic}, {}};
  for (int solver = 0; solver < 11; ++solver) {
    Curve& curve = plot.curves.emplace_back();
    curve.name = "solver " + std::to_string(solver);
    const int iterations = 3 + 19 * solver;
    for (int k = 0; k <= iterations; ++k) curve.points.push_back({double(k), std::pow(10, -8.0 * k / iterations)});
  }
  return plot;
}

TEST(WritePlot, WritesAWholePng) {
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", convergence());
  EXPECT_EQ(folder.entries(), 1U);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_EQ(picture.pixels.size(), static_cast<std::size_t>(width * height));
  for (const Colour& colour : colours) EXPECT_GT(spot(picture, colour, 0, width).pixels, 100);
}

TEST(WritePlot, WritesAWholeSvg) {
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.svg", convergence());
  EXPECT_EQ(folder.entries(), 1U);
  const std::string svg = content_of(folder.path() / "plot.svg");
  EXPECT_TRUE(svg.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "));
  EXPECT_NE(svg.find("width=\"900px\" height=\"600px\""), std::string::npos);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

TEST(WritePlot, GivesTheSameBytesForTheSamePlot) {
  for (const std::string extension : {".svg", ".png"}) {
    const TemporaryFolder folder;
    write_plot(folder.path() / ("a" + extension), convergence());
    write_plot(folder.path() / ("other" + extension), {});
    write_plot(folder.path() / ("b" + extension), convergence());
    const std::string bytes = content_of(folder.path() / ("a" + extension));
    EXPECT_EQ(bytes, content_of(folder.path() / ("b" + extension)));
    EXPECT_NE(bytes, content_of(folder.path() / ("other" + extension)));
  }
}

// Four single points at the corners of a rectangle of data and one in its middle, the middle of the axis.
void expect_markers_at_their_places(Scale scale, double low, double middle, double high) {
  const Plot plot{"",
                  {"x", scale},
                  {"y", scale},
                  {{"a", {{low, low}}},
                   {"b", {{high, low}}},
                   {"c", {{low, high}}},
                   {"d", {{high, high}}},
                   {"e", {{middle, middle}}}}};
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", plot);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_FALSE(picture.pixels.empty());
  // The legend, with one-letter names, starts after column 828.
  std::array<Spot, 5> spots;
  for (std::size_t k = 0; k < 5; ++k) {
    spots[k] = spot(picture, colours[k], 0, 828);
    // Only shapes about 8 pixels across.
    EXPECT_GT(spots[k].pixels, 15);
    EXPECT_LT(spots[k].pixels, 100);
  }
  // The shapes' centroids are the points. Pixels at the edge move them by half a pixel at most.
  const double pixel = 1;
  const auto& [a, b, c, d, e] = spots;
  EXPECT_NEAR(a.y, b.y, pixel);
  EXPECT_NEAR(c.y, d.y, pixel);
  EXPECT_NEAR(a.x, c.x, pixel);
  EXPECT_NEAR(b.x, d.x, pixel);
  EXPECT_GT(b.x - a.x, 600);
  EXPECT_GT(a.y - c.y, 400);
  EXPECT_NEAR(e.x, (a.x + b.x) / 2, pixel);
  EXPECT_NEAR(e.y, (a.y + c.y) / 2, pixel);
}

TEST(WritePlot, PutsPointsWhereTheDataSay) {
  expect_markers_at_their_places(Scale::linear, -10, 0, 10);
  expect_markers_at_their_places(Scale::logarithmic, 1e-4, 1e-1, 1e2);
}

TEST(WritePlot, GeometricConvergenceIsAStraightLineOfEqualSteps) {
  Plot plot{"", {"x", Scale::linear}, {"y", Scale::logarithmic}, {}};
  for (int k = 0; k < 5; ++k) plot.curves.push_back({"a", {{double(k), std::pow(0.03, k)}}});
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", plot);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_FALSE(picture.pixels.empty());
  std::array<Spot, 5> spots;
  for (std::size_t k = 0; k < 5; ++k) spots[k] = spot(picture, colours[k], 0, 828);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_NEAR(spots[k].x, (spots[k - 1].x + spots[k + 1].x) / 2, 1);
    EXPECT_NEAR(spots[k].y, (spots[k - 1].y + spots[k + 1].y) / 2, 1);
  }
}

TEST(WritePlot, LinesJoinThePoints) {
  // A line from one single point to another.
  const Plot plot{"",
                  {"x", Scale::linear},
                  {"y", Scale::logarithmic},
                  {{"a", {{0.5, 1}, {7, 1e-8}}}, {"b", {{0.5, 1}}}, {"c", {{7, 1e-8}}}}};
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", plot);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_FALSE(picture.pixels.empty());
  const Spot from = spot(picture, colours[1], 0, 828), to = spot(picture, colours[2], 0, 828);
  const double slope = (to.y - from.y) / (to.x - from.x);
  EXPECT_GT(slope, 0.4);  // downward, over most of the 600 rows
  // Markers are less than 10 pixels wide. The few pixels of the line in a column and the markers each have an error of
  // half a pixel at most.
  for (int column = static_cast<int>(from.x) + 10; column < to.x - 10; ++column) {
    EXPECT_NEAR(spot(picture, colours[0], column, column + 1).y, from.y + slope * (column - from.x), 1) << column;
  }
}

TEST(WritePlot, TwelveCurvesHaveTwelveLooks) {
  Plot plot{"title", {}, {}, {}};
  for (int k = 0; k < 12; ++k) plot.curves.push_back({"a", {}});
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", plot);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_FALSE(picture.pixels.empty());
  // Below the title, from row 40, the legend has 22 rows per curve. Its samples of lines end before column 870.
  const auto sample = [&](int curve) {
    std::vector<Colour> pixels;
    for (int y = 40 + 22 * curve; y < 62 + 22 * curve; ++y) {
      for (int x = 828; x < 870; ++x) pixels.push_back(picture.at(x, y));
    }
    return pixels;
  };
  const std::vector<Colour> white(22 * 42, {255, 255, 255});
  for (int a = 0; a < 12; ++a) {
    EXPECT_NE(sample(a), white);
    for (int b = 0; b < a; ++b) EXPECT_NE(sample(a), sample(b)) << a << ' ' << b;
  }
}

TEST(WritePlot, LeavesOutPointsThatAnAxisCannotShow) {
  const Plot clean = convergence();
  Plot spoilt = clean;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (Curve& curve : spoilt.curves) {
    curve.points.insert(curve.points.begin() + 1,
                        {{1, 0}, {1, -1}, {infinity, 1}, {1, infinity}, {std::nan(""), 1}, {1, std::nan("")}});
  }
  const TemporaryFolder folder;
  write_plot(folder.path() / "clean.svg", clean);
  write_plot(folder.path() / "spoilt.svg", spoilt);
  EXPECT_EQ(content_of(folder.path() / "clean.svg"), content_of(folder.path() / "spoilt.svg"));
}

TEST(WritePlot, IsSafeForOddData) {
  const std::string long_text(300, 'W');
  const TemporaryFolder folder;
  for (const Scale scale : {Scale::linear, Scale::logarithmic}) {
    Plot plot{long_text, {long_text, scale}, {"5 < 6 & \"7\" \xff", scale}, {}};
    for (int k = 0; k < 2; ++k) {
      write_plot(folder.path() / "plot.svg", plot);
      EXPECT_TRUE(content_of(folder.path() / "plot.svg").ends_with("</svg>\n"));
      // Second: no point, nothing to show, equal points, truncated and broken names.
      plot.curves = {{"", {}}, {long_text, {{std::nan(""), 1}}}, {"\xff<", {{3, 3}, {3, 3}, {3, 3}}}};
    }
    plot.curves.resize(200);
    write_plot(folder.path() / "plot.png", plot);
    EXPECT_FALSE(read_png(folder.path() / "plot.png").pixels.empty());
  }
}

TEST(WritePlot, TextsStayInThePicture) {
  const std::string long_text(300, 'W');
  const Plot plot{long_text, {long_text}, {long_text}, {{long_text, {{0, 0}, {1e9, 1e9}}}}};
  const TemporaryFolder folder;
  write_plot(folder.path() / "plot.png", plot);
  const Picture picture = read_png(folder.path() / "plot.png");
  ASSERT_FALSE(picture.pixels.empty());
  const Colour white{255, 255, 255};
  for (int x = 0; x < width; ++x) EXPECT_TRUE(picture.at(x, 0) == white && picture.at(x, height - 1) == white);
  for (int y = 0; y < height; ++y) EXPECT_TRUE(picture.at(0, y) == white && picture.at(width - 1, y) == white);
}

TEST(WritePlot, RefusesOtherExtensions) {
  const TemporaryFolder folder;
  for (const std::string name : {"plot.pdf", "plot", "plot.PNG"}) {
    EXPECT_THROW(write_plot(folder.path() / name, convergence()), OutputError) << name;
  }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(WritePlot, FullDiskIsAnError) {
  const TemporaryFolder folder;
  const FullDisk disk(100);
  EXPECT_THROW(write_plot(folder.path() / "plot.png", convergence()), OutputError);
  EXPECT_THROW(write_plot(folder.path() / "plot.svg", convergence()), OutputError);
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace patchlight::write_plot_test
