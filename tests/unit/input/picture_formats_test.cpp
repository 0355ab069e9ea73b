// The same picture in every supported format, and damaged files of each.
#include "input/picture_colours.h"
#include "light/texture.h"
#include "model_files.h"

#include <cmath>
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

namespace patchlight::picture_formats_test {
namespace {

// The fault of bytes in no known format. What is damaged has another one.
std::string unknown_format() { return decoded_picture("just a text", 100).fault; }

constexpr std::size_t width = 9;
constexpr std::size_t height = 3;

// 9 x 3 pixels of many colors, in the order red, green, blue from the top left.
std::string many_colours() {
  std::string pixels;
  for (std::size_t k = 0; k < 3 * width * height; ++k) pixels += static_cast<char>(20 + k * 37 % 211);
  return pixels;
}

// A number in this many bytes, the least significant first.
std::string little_endian(std::size_t value, std::size_t bytes) {
  std::string text;
  for (std::size_t k = 0; k < bytes; ++k, value >>= 8U) text += static_cast<char>(value & 0xFFU);
  return text;
}

// Blue, green and red of a row.
std::string turned_round(const std::string& pixels, std::size_t row) {
  std::string turned;
  for (std::size_t x = 0; x < width; ++x)
    for (const std::size_t channel : {2, 1, 0}) turned += pixels[3 * (row * width + x) + channel];
  return turned;
}

// The file header of 14 bytes and the BITMAPINFOHEADER of 40 bytes. Rows are padded to whole words and start at the
// bottom.
std::string bmp_of(const std::string& pixels, bool downwards = false) {
  std::string rows;
  for (std::size_t k = 0; k < height; ++k) {
    rows += turned_round(pixels, downwards ? k : height - 1 - k);
    rows.resize((rows.size() + 3) / 4 * 4, '\0');
  }
  const std::size_t signed_height = downwards ? (std::size_t{1} << 32U) - height : height;
  return "BM" + little_endian(54 + rows.size(), 4) + little_endian(0, 4) + little_endian(54, 4) + little_endian(40, 4) +
         little_endian(width, 4) + little_endian(signed_height, 4) + little_endian(1, 2) + little_endian(24, 2) +
         little_endian(0, 4) + little_endian(rows.size(), 4) + little_endian(0, 16) + rows;
}

// Type 2, or type 10 with a packet of single pixels for each row. Bit 5 of the last byte means that rows start at the
// top.
std::string tga_of(const std::string& pixels, bool packed = false) {
  std::string bytes = little_endian(0, 2) + (packed ? "\x0A" : "\x02") + little_endian(0, 9) + little_endian(width, 2) +
                      little_endian(height, 2) + "\x18\x20";
  for (std::size_t row = 0; row < height; ++row) {
    if (packed) bytes += static_cast<char>(width - 1);
    bytes += turned_round(pixels, row);
  }
  return bytes;
}

std::string jpeg_of(std::size_t across, std::size_t down, const std::string& pixels) {
  std::string bytes;
  const auto add = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  stbi_write_jpg_to_func(add, &bytes, static_cast<int>(across), static_cast<int>(down), 3, pixels.data(), 100);
  return bytes;
}

// Mantissas and exponent of three numbers: Ward 1991. A row is stored in runs of single bytes, channel by channel,
// after 2 2 and its length, or without runs.
std::string hdr_of(std::size_t across, std::size_t down, const std::vector<Rgb>& values, bool in_runs = false) {
  std::vector<std::string> codes;
  for (const Rgb& value : values) {
    int exponent = 0;
    std::frexp(std::max({value[0], value[1], value[2]}), &exponent);
    std::string code;
    for (const double part : value) code += static_cast<char>(std::ldexp(part, 8 - exponent));
    codes.push_back(code + static_cast<char>(128 + exponent));
  }
  std::string bytes =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(down) + " +X " + std::to_string(across) + "\n";
  for (std::size_t y = 0; y < down; ++y) {
    if (in_runs) bytes += std::string("\x02\x02\0", 3) + static_cast<char>(across);
    for (std::size_t channel = 0; channel < 4 && in_runs; ++channel) {
      bytes += static_cast<char>(across);
      for (std::size_t x = 0; x < across; ++x) bytes += codes[y * across + x][channel];
    }
    for (std::size_t x = 0; x < across && !in_runs; ++x) bytes += codes[y * across + x];
  }
  return bytes;
}

std::vector<Rgb> linear_of(const DecodedPicture& picture) {
  std::vector<Rgb> values;
  for (const auto& texel : picture.texture->texels) values.push_back({texel[0], texel[1], texel[2]});
  return values;
}

DecodedPicture as_png() { return decoded_picture(png_of(width, height, many_colours()), 1000); }

TEST(PictureFormats, BmpAndTgaHaveTheTexelsOfPng) {
  const DecodedPicture expected = as_png();
  const std::string pixels = many_colours();
  for (const std::string& bytes : {bmp_of(pixels), bmp_of(pixels, true), tga_of(pixels), tga_of(pixels, true)}) {
    const DecodedPicture found = decoded_picture(bytes, 1000);
    ASSERT_TRUE(found.texture) << found.fault;
    EXPECT_EQ(found.texture->width, width);
    EXPECT_EQ(found.texture->texels, expected.texture->texels);
    EXPECT_FALSE(found.alpha);
  }
}

// A mantissa of eight bits is truncated, so the error is up to 1/128 of the largest of the three. stb_image reads it
// without a correction.
TEST(PictureFormats, HdrHasLinearValuesWithoutGamma) {
  const DecodedPicture expected = as_png();
  for (const bool in_runs : {false, true}) {
    // Rows of fewer than eight pixels have no runs.
    const std::vector<Rgb> values = linear_of(expected);
    const DecodedPicture found = decoded_picture(hdr_of(width, height, values, in_runs), 1000);
    ASSERT_TRUE(found.texture) << found.fault;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double largest = std::max({values[k][0], values[k][1], values[k][2]});
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found.texture->texels[k][c], values[k][c], largest / 128) << k;
    }
  }
  const DecodedPicture exact = decoded_picture(hdr_of(2, 1, {{.5, .25, .125}, {1, .5, 0}}), 1000);
  EXPECT_TRUE((*exact.mean == rgb(.75, .375, .0625)).all());
}

// Numbers above 1 are no reflectances, unless a factor reduces them.
class HdrOfMaterials : public ModelFiles {};

TEST_F(HdrOfMaterials, AreRefusedWhereTheyReflectMoreThanAll) {
  const auto with_factor = [&](const std::string& factor) {
    write("m.mtl", "newmtl paint\nKd " + factor + "\nmap_Kd p.hdr\n");
    return write("m.obj",
                 "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl paint\nf 1/1 2/2 3/3\n");
  };
  write("p.hdr", hdr_of(2, 1, {{1.5, .25, .125}, {.25, .5, 0}}));
  const std::string message = refusal(with_factor("1 1 1"));
  EXPECT_NE(message.find("'paint'"), std::string::npos) << message;
  EXPECT_TRUE(read_scene(with_factor(".5 .5 .5")).materials[0].reflectance.isApprox(.5 * rgb(.875, .375, .0625)));
  EXPECT_TRUE((read_scene(with_factor("1 1 1"), {.settings = {parse_material_setting("paint.reflectance=.5")}})
                   .materials[0]
                   .reflectance == .5)
                  .all());
}

// Blocks of 8 x 8 pixels have one color each. The finest quantization leaves rounding in three steps of up to one code
// each.
TEST(PictureFormats, JpegIsAsNearAsItsCodes) {
  const std::string colours("\xC0\x80\x40\x20\xA0\x60", 6);
  std::string pixels;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) pixels += colours.substr(x < 8 ? 0 : 3, 3);
  const DecodedPicture expected = decoded_picture(png_of(16, 8, pixels), 1000);
  const DecodedPicture found = decoded_picture(jpeg_of(16, 8, pixels), 1000);
  ASSERT_TRUE(found.texture) << found.fault;
  const double steepest = 2.4 / 1.055 / 255;  // of a code at most
  for (Eigen::Index band = 0; band < 3; ++band) EXPECT_NEAR((*found.mean)[band], (*expected.mean)[band], 3 * steepest);
}

TEST(PictureFormats, ThatAreCutOffAreNamed) {
  const std::string pixels = many_colours();
  const std::vector<Rgb> values = linear_of(as_png());
  std::string large;
  for (int k = 0; k < 3 * 64 * 64; ++k) large += static_cast<char>(k * k % 251);
  for (const std::string& whole :
       {png_of(width, height, pixels), bmp_of(pixels), tga_of(pixels), tga_of(pixels, true), jpeg_of(64, 64, large),
        hdr_of(width, height, values), hdr_of(width, height, values, true)}) {
    EXPECT_EQ(decoded_picture(whole, 1000).fault, "");
    for (const std::size_t missing : {std::size_t{2}, whole.size() / 3, whole.size() - 20}) {
      const std::string fault = decoded_picture(whole.substr(0, whole.size() - missing), 1000).fault;
      EXPECT_FALSE(fault.empty()) << whole.substr(0, 10) << " without " << missing;
      EXPECT_NE(fault, unknown_format()) << whole.substr(0, 10) << " without " << missing;
    }
  }
}

TEST(PictureFormats, ThatAreDamagedOrTooLargeAreNamed) {
  const std::string png = png_of(2, 2, std::string(12, '\x40'));
  const std::string bmp = bmp_of(many_colours());
  const std::string size("\0\0\x4E\x20\0\0\x4E\x20", 8);
  const std::string little_size = little_endian(20000, 4) + little_endian(20000, 4);
  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  const std::string tga = tga_of(many_colours());
  for (const auto& [bytes, fault] : std::vector<std::pair<std::string, std::string>>{
           {png.substr(0, 16) + size + png.substr(24), "has more than 8192 x 8192 pixels"},
           {bmp.substr(0, 18) + little_size + bmp.substr(26), "has more than 8192 x 8192 pixels"},
           {tga.substr(0, 12) + "\xFF\x7F\xFF\x7F" + tga.substr(16), "has more than 8192 x 8192 pixels"},
           {hdr + "-Y 8192 +X 8192\n", "has more than 4096 x 8192 pixels, the most of a Radiance HDR"},
           {hdr + "-Y 20000 +X 20000\n", "has more than 8192 x 8192 pixels"},
           {png.substr(0, 45) + "\x7F\x7F" + png.substr(47), "cannot be decoded; is it whole?"},
           {bmp.substr(0, 28) + "\x07" + bmp.substr(29), "cannot be decoded; is it whole?"},
           {hdr + "+X 8 -Y 8\n" + std::string(400, '\1'), "cannot be decoded; is it whole?"},
           {hdr + "-Y 8 +X 8\n" + std::string("\2\2\0\7", 4) + std::string(400, '\1'),
            "cannot be decoded; is it whole?"}}) {
    EXPECT_EQ(decoded_picture(bytes, 100).fault, fault) << bytes.substr(0, 10);
    EXPECT_FALSE(decoded_picture(bytes, 100).mean);
  }
}

TEST(PictureFormats, ThatAreNotReadAreRefusedWithThoseThatAre) {
  EXPECT_FALSE(unknown_format().empty());
  std::string noise;
  for (int k = 0; k < 500; ++k) noise += static_cast<char>(k * k * 31 % 253);
  for (const std::string& bytes :
       {std::string("P6 1 1 255 abc"), "GIF89a" + noise, "8BPS" + noise, std::string(), std::string("\0\0", 2), noise,
        std::string(100, '\0'), std::string("\0\0\2", 3) + std::string(40, '\0'), "RIFF" + noise,
        // JPEG 2000, AVIF, ICO.
        std::string("\0\0\0\x0CjP  \r\n\x87\n", 12) + noise, std::string("\0\0\0\x20", 4) + "ftypavif" + noise,
        std::string("\0\0\1\0\1\0", 6) + noise, std::string("just a text")})
    EXPECT_EQ(decoded_picture(bytes, 100).fault, unknown_format()) << bytes;
}

// The fourth byte of a 32-bit pixel is alpha if the header declares it.
TEST(PictureFormats, AlphaOfTgaCountsWhereItIsOne) {
  const auto with = [](char descriptor) {
    return little_endian(0, 2) + "\x02" + little_endian(0, 9) + little_endian(2, 2) + little_endian(1, 2) + "\x20" +
           descriptor + std::string("\x10\x20\x30\0\x40\x50\x60\xFF", 8);
  };
  EXPECT_FALSE(decoded_picture(with('\x20'), 10).alpha);
  const DecodedPicture found = decoded_picture(with('\x28'), 10);
  ASSERT_TRUE(found.alpha);
  EXPECT_EQ(found.alpha->count[0], 1U);
  EXPECT_EQ(found.alpha->count[255], 1U);
}

// The fourth byte of BI_RGB has no meaning. BI_BITFIELDS of the BITMAPV4HEADER of 108 bytes defines the position of
// alpha.
TEST(PictureFormats, AlphaOfBmpCountsWhereItIsOne) {
  const std::string pixels("\x10\x20\x30\0\x40\x50\x60\xFF", 8);
  const auto with = [&](std::size_t header, std::size_t compression, const std::string& rest) {
    return "BM" + little_endian(14 + header + 8, 4) + little_endian(0, 4) + little_endian(14 + header, 4) +
           little_endian(header, 4) + little_endian(2, 4) + little_endian(1, 4) + little_endian(1, 2) +
           little_endian(32, 2) + little_endian(compression, 4) + little_endian(8, 4) + std::string(16, '\0') + rest +
           pixels;
  };
  EXPECT_EQ(decoded_picture(with(40, 0, ""), 10).fault, "");
  EXPECT_FALSE(decoded_picture(with(40, 0, ""), 10).alpha);
  const std::string masks = little_endian(0xFF0000, 4) + little_endian(0xFF00, 4) + little_endian(0xFF, 4) +
                            little_endian(0xFF000000, 4) + std::string(52, '\0');
  const DecodedPicture found = decoded_picture(with(108, 3, masks), 10);
  ASSERT_TRUE(found.alpha) << found.fault;
  EXPECT_EQ(found.alpha->count[0], 1U);
  EXPECT_EQ(found.alpha->count[255], 1U);
}

// stb_image reads the old kind of runs, (1, 1, 1, length), as pixels.
TEST(PictureFormats, RunsOfHdrOfTheOldKindAreNamed) {
  const std::string bytes =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n" + std::string("\x80\x40\x20\x80\1\1\1\x11", 8);
  EXPECT_FALSE(decoded_picture(bytes, 100).fault.empty());
}

// A run of length zero would be read forever at the end of the file.
TEST(PictureFormats, RunsOfHdrThatNeverEndAreCutOff) {
  const std::string endless = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n" + std::string("\2\2\0\x09", 4);
  EXPECT_FALSE(decoded_picture(endless, 10).fault.empty());
  EXPECT_FALSE(decoded_picture(endless + std::string(50, '\0'), 10).fault.empty());
}

}  // namespace
}  // namespace patchlight::picture_formats_test
