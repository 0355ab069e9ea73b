#include "output/write_picture.h"

#include "patchlight/base/error.h"

#include "light/photometry.h"
#include "temporary_folder.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <vector>
#include <vtkHDRReader.h>
#include <vtkImageData.h>
#include <vtkNew.h>

namespace patchlight::write_picture_test {
namespace {

constexpr int width = 37;
constexpr int height = 11;

// Runs of equal pixels and others, over six decades; one pixel is black.
Picture some_picture() {
  Picture picture;
  picture.camera = {Point(1, 2, 3), Point(4, 2, 3), 60};
  Image& image = picture.radiance;
  constexpr Eigen::Index count = width * height;
  image = {width, height, Field::Zero(count, 3), Eigen::VectorXd::Zero(count)};
  for (Eigen::Index k = 1; k < count; ++k) {
    const double level = k % width < 12 ? 0.75 : std::pow(10.0, 3 * std::sin(0.1 * static_cast<double>(k)));
    image.pixels.row(k) << level, 0.5 * level, 0.25 * level;
  }
  image.error = Eigen::VectorXd::LinSpaced(count, 0, 1);
  image.depth = Eigen::VectorXd::Constant(count, 2.5);
  image.normal = Field::Zero(count, 3);
  image.normal.col(2).setOnes();
  image.patch.assign(static_cast<std::size_t>(count), 7);
  image.patch[3] = -1;
  picture.image = {width, height, std::vector<std::array<std::uint8_t, 3>>(static_cast<std::size_t>(count))};
  return picture;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(WritePicture, RadianceFilesHaveTheSameValuesForAnotherReader) {
  const TemporaryFolder folder;
  const Picture picture = some_picture();
  write_picture(folder.path() / "view.hdr", picture, Vector::UnitZ(), usual_bands(3));
  const vtkNew<vtkHDRReader> reader;
  reader->SetFileName((folder.path() / "view.hdr").c_str());
  reader->Update();
  vtkImageData& read = *reader->GetOutput();
  ASSERT_EQ(read.GetDimensions()[0], width);
  ASSERT_EQ(read.GetDimensions()[1], height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto expected = picture.radiance.pixels.row(y * width + x);
      for (int c = 0; c < 3; ++c) {
        // A mantissa of eight bits of the largest of the three; VTK's rows go upward.
        const double found = read.GetScalarComponentAsDouble(x, height - 1 - y, 0, c);
        EXPECT_NEAR(found, expected[c], expected.maxCoeff() / 128) << x << ' ' << y << ' ' << c;
      }
    }
  }
}

TEST(WritePicture, RadianceFilesSayFromWhereTheyWereSeen) {
  const TemporaryFolder folder;
  write_picture(folder.path() / "view.hdr", some_picture(), Vector::UnitZ(), usual_bands(3));
  const std::string text = bytes_of(folder.path() / "view.hdr");
  EXPECT_TRUE(text.starts_with("#?RADIANCE\n"));
  EXPECT_NE(text.find("\nVIEW= -vtv -vp 1 2 3 -vd 1 0 0 -vu 0 0 1 -vh "), std::string::npos);
  EXPECT_NE(text.find(" -vv 60 "), std::string::npos);
  EXPECT_NE(text.find("\nEXPOSURE=1\n"), std::string::npos);
}

TEST(WritePicture, OpenExrFilesHaveTheSameValuesInLayers) {
  const TemporaryFolder folder;
  const Picture picture = some_picture();
  write_picture(folder.path() / "view.exr", picture, Vector::UnitZ(), usual_bands(3));
  Imf::InputFile file((folder.path() / "view.exr").c_str());
  std::vector<float> red(width * height), luminances(width * height), errors(width * height), up(width * height);
  std::vector<std::uint32_t> patches(width * height);
  Imf::FrameBuffer pixels;
  const auto add = [&](const char* name, Imf::PixelType type, void* to) {
    EXPECT_NE(file.header().channels().findChannel(name), nullptr) << name;
    pixels.insert(name, Imf::Slice(type, static_cast<char*>(to), 4, 4 * width));
  };
  add("R", Imf::FLOAT, red.data());
  add("luminance.Y", Imf::FLOAT, luminances.data());
  add("error.Y", Imf::FLOAT, errors.data());
  add("normal.Z", Imf::FLOAT, up.data());
  add("patch.id", Imf::UINT, patches.data());
  file.setFrameBuffer(pixels);
  file.readPixels(0, height - 1);
  for (std::size_t k = 0; k < red.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    EXPECT_EQ(red[k], static_cast<float>(picture.radiance.pixels(row, 0)));
    EXPECT_EQ(luminances[k], static_cast<float>(luminance(picture.radiance.pixels.row(row))));
    EXPECT_EQ(errors[k], static_cast<float>(picture.radiance.error[row]));
    EXPECT_EQ(up[k], 1);
    EXPECT_EQ(patches[k], k == 3 ? 4294967295U : 7U);
  }
}

TEST(WritePicture, PngFilesSayTheirExposure) {
  const TemporaryFolder folder;
  Picture picture = some_picture();
  picture.exposure = 0.25;
  write_picture(folder.path() / "view.png", picture, Vector::UnitZ(), usual_bands(3));
  EXPECT_NE(bytes_of(folder.path() / "view.png")
                .find(std::string("Exposure\0"
                                  "0.25",
                                  13)),
            std::string::npos);
}

TEST(WritePicture, RefusesOtherNames) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_picture(folder.path() / "view.gif", some_picture(), Vector::UnitZ(), usual_bands(3)), OutputError);
}

}  // namespace
}  // namespace patchlight::write_picture_test
