#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "temporary_folder.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

namespace patchlight::write_image_test {
namespace {

// Every pixel different, and no symmetry.
DisplayImage gradient(int width, int height) {
  DisplayImage image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back({static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 200});
    }
  }
  return image;
}

TEST(WritePng, GivesThePixelsBack) {
  const TemporaryFolder folder;
  const std::string file = folder.path() / "picture.png";
  const DisplayImage image = gradient(7, 5);
  write_png(file, image);

  const vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* const read = reader->GetOutput();
  ASSERT_EQ(read->GetDimensions()[0], 7);
  ASSERT_EQ(read->GetDimensions()[1], 5);
  ASSERT_EQ(read->GetNumberOfScalarComponents(), 3);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      // VTK's lowest row is the image's last.
      const auto* const pixel = static_cast<const std::uint8_t*>(read->GetScalarPointer(x, 4 - y, 0));
      EXPECT_TRUE(std::equal(pixel, pixel + 3, image.pixels[static_cast<std::size_t>(7 * y + x)].begin()));
    }
  }
}

TEST(WritePng, FullDiskIsAnError) {
  const TemporaryFolder folder;
  const FullDisk disk(20);
  EXPECT_THROW(write_png(folder.path() / "picture.png", gradient(7, 5)), OutputError);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(WithLegend, KeepsThePictureAndAddsBarAndText) {
  const DisplayImage image = gradient(200, 150);
  const DisplayImage whole = with_legend(image, 0, 1000, "luminance in cd/m^2");
  ASSERT_GT(whole.width, image.width);
  ASSERT_EQ(whole.height, image.height);
  ASSERT_EQ(whole.pixels.size(), static_cast<std::size_t>(whole.width) * 150);

  int white = 0, blue = 0, red = 0;
  int first_red_row = whole.height, first_blue_row = whole.height;
  for (int y = 0; y < whole.height; ++y) {
    const auto row = whole.pixels.begin() + static_cast<std::ptrdiff_t>(y) * whole.width;
    EXPECT_TRUE(std::equal(row, row + image.width, image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * 200));
    for (auto pixel = row + image.width; pixel < row + whole.width; ++pixel) {
      const auto [r, g, b] = *pixel;
      if (r > 128 && r == g && g == b) ++white;
      if (b > 150 && r < 60 && g < 80) ++blue, first_blue_row = std::min(first_blue_row, y);
      if (r > 150 && g < 60 && b < 60) ++red, first_red_row = std::min(first_red_row, y);
    }
  }
  EXPECT_GT(white, 50);  // five numbers and a title, some ten strokes each
  EXPECT_GT(blue, 0);
  EXPECT_LT(first_red_row, first_blue_row);  // the upper value is at the top
  EXPECT_GT(red, 0);
}

TEST(WithLegend, IsSafeForTinyPictures) {
  const DisplayImage whole = with_legend(gradient(3, 2), 0, 1, "title");
  EXPECT_EQ(whole.pixels.size(), static_cast<std::size_t>(whole.width) * 2);
  EXPECT_EQ(whole.pixels[1], (std::array<std::uint8_t, 3>{1, 0, 200}));
}

}  // namespace
}  // namespace patchlight::write_image_test
