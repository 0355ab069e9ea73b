#include "output/write_exr.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"

#include "light/photometry.h"
#include "output/whole_file.h"
#include "render/tone_map.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A channel of numbers in single precision.
struct Channel {
  std::string name;
  std::vector<float> values;
};

std::vector<Channel> channels_of(const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  const auto count = static_cast<std::size_t>(image.pixels.rows());
  std::vector<Channel> all;
  for (const char* name : {"R", "G", "B", "luminance.Y"}) all.push_back({name, std::vector<float>(count)});
  for (std::size_t k = 0; k < count; ++k) {
    const Spectrum radiance = image.pixels.row(static_cast<Eigen::Index>(k));
    const std::array<double, 3> rgb = linear_rgb(radiance, bands);
    for (std::size_t c = 0; c < 3; ++c) all[c].values[k] = static_cast<float>(rgb[c]);
    all[3].values[k] = static_cast<float>(luminance(radiance, bands));
  }
  const auto add = [&](const char* name, const auto& values) {
    if (values.size() == 0) return;
    Channel channel{name, std::vector<float>(count)};
    for (std::size_t k = 0; k < count; ++k)
      channel.values[k] = static_cast<float>(values[static_cast<Eigen::Index>(k)]);
    all.push_back(std::move(channel));
  };
  add("error.Y", image.error);
  add("depth.Z", image.depth);
  if (image.normal.size() > 0) {
    add("normal.X", Eigen::VectorXd(image.normal.col(0)));
    add("normal.Y", Eigen::VectorXd(image.normal.col(1)));
    add("normal.Z", Eigen::VectorXd(image.normal.col(2)));
  }
  return all;
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  std::vector<Channel> channels = channels_of(picture, bands);
  std::vector<std::uint32_t> patches(image.patch.begin(), image.patch.end());
  const auto width = static_cast<std::size_t>(image.width);
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.insert("software", Imf::StringAttribute(std::string("patchlight ") + version()));
    if (picture.unfinished) header.insert("comments", Imf::StringAttribute("unfinished"));
    Imf::FrameBuffer pixels;
    const auto add = [&](const std::string& name, Imf::PixelType type, void* values) {
      header.channels().insert(name, Imf::Channel(type));
      pixels.insert(name, Imf::Slice(type, static_cast<char*>(values), 4, 4 * width));
    };
    for (Channel& channel : channels) add(channel.name, Imf::FLOAT, channel.values.data());
    if (!patches.empty()) add("patch.id", Imf::UINT, patches.data());
    write_whole_file(file, [&](const std::filesystem::path& temporary) {
      Imf::OutputFile out(temporary.c_str(), header, 1);
      out.setFrameBuffer(pixels);
      out.writePixels(image.height);
    });
  } catch (const OutputError&) {
    throw;
  } catch (const std::exception& error) {
    throw OutputError(file.string(), std::string("the picture cannot be written as OpenEXR: ") + error.what());
  }
}

}  // namespace patchlight
