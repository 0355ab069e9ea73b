#include "patchlight/base/error.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"

#include "light/photometry.h"
#include "output/image/write_image.h"
#include "render/tone_map.h"
#include "support/scenes.h"
#include "temporary_folder.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <algorithm>
#include <array>
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
#include <vtkPNGReader.h>

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
        // The eight-bit mantissa is relative to the largest of the three. VTK's rows go upward.
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

std::vector<std::array<std::uint8_t, 3>> row_of_png(const std::filesystem::path& file, int from_top, int pixels) {
  const vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* const read = reader->GetOutput();
  std::vector<std::array<std::uint8_t, 3>> row;
  for (int x = 0; x < pixels; ++x) {
    const int y = read->GetDimensions()[1] - 1 - from_top;  // VTK begins with the lowest row
    const auto* const pixel = static_cast<const std::uint8_t*>(read->GetScalarPointer(x, y, 0));
    row.push_back({pixel[0], pixel[1], pixel[2]});
  }
  return row;
}

// A picture of four pixels with these radiances and one exposure.
Picture of_radiances(const std::vector<double>& radiances) {
  Picture picture;
  picture.radiance = {4, 1, Field::Zero(4, 3), Eigen::VectorXd::Zero(4)};
  for (Eigen::Index k = 0; k < 4; ++k) picture.radiance.pixels.row(k) = radiances[static_cast<std::size_t>(k)];
  picture.image = {4, 1, tone_map(picture.radiance.pixels, picture.exposure, usual_bands(3))};
  return picture;
}

TEST(WriteDifference, ShowsBothAndWhatTheirLuminancesDiffer) {
  const TemporaryFolder folder;
  const Picture first = of_radiances({0.1, 0.2, 0.3, 0.5}), second = of_radiances({0.1, 0.3, 0.1, 0.1});
  write_difference(folder.path() / "both.png", first, second, usual_bands(3));
  const auto row = row_of_png(folder.path() / "both.png", 0, 12);
  // 0, 17.9, 35.8 and 71.6 cd/m^2. The color scale ends where all but one in twenty pixels are below, at the third of
  // four.
  const Eigen::Vector4d differences = luminous_efficacy * Eigen::Vector4d(0, 0.1, 0.2, 0.4);
  const auto colours = false_color(differences, 0, differences[2]);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(row[k], first.image.pixels[k]);
    EXPECT_EQ(row[4 + k], second.image.pixels[k]);
    EXPECT_EQ(row[8 + k], colours[k]) << k;
  }
  // None if both are the same.
  write_difference(folder.path() / "same.png", first, first, usual_bands(3));
  const auto same = row_of_png(folder.path() / "same.png", 0, 12);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(same[8 + k], false_color(Eigen::Vector4d::Zero(), 0, 1)[0]);
}

// Light is linear in the emission of lamps. One and a half times the light differs from it by half of the first
// picture, pixel by pixel.
TEST(WriteDifference, OfSolutionsThatDifferByAFactorIsThatShareOfTheFirst) {
  const TemporaryFolder folder;
  Scene scene = test::furnished_room(0.5);
  const PictureOptions options{
      .camera = Camera{Point(0.3, 0.3, 1.6), Point(3, 2.2, 0.9), 60}, .width = 16, .height = 12};
  Request request;
  request.mesh.max_edge = 0.5;
  const Picture first = take_picture(simulate(scene, request), options);
  for (Material& material : scene.materials) material.exitance *= 1.5;
  const Picture second = take_picture(simulate(scene, request), options);
  write_difference(folder.path() / "both.png", first, second, bands_of(scene));

  const Eigen::VectorXd half = 0.5 * luminous_efficacy * first.radiance.pixels.col(0).matrix();
  ASSERT_GT(half.minCoeff(), 0);
  std::vector<double> sorted(half.begin(), half.end());
  std::sort(sorted.begin(), sorted.end());
  const double end = sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  const auto colours = false_color(half, 0, end);
  for (int y = 0; y < 12; ++y) {
    const auto row = row_of_png(folder.path() / "both.png", y, 48);
    for (std::size_t x = 0; x < 16; ++x) {
      // The solver stops at relative errors of 1e-6, so a color may be rounded the other way.
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(row[32 + x][c], colours[static_cast<std::size_t>(y) * 16 + x][c], 1) << x << ' ' << y;
    }
  }
}

TEST(WritePicture, RefusesOtherNames) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_picture(folder.path() / "view.gif", some_picture(), Vector::UnitZ(), usual_bands(3)), OutputError);
}

}  // namespace
}  // namespace patchlight::write_picture_test
