#include "output/image/write_exr.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"

#include "light/photometry.h"
#include "output/file/whole_file.h"
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

std::vector<ExrChannel> channels_of(const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  const auto count = static_cast<std::size_t>(image.pixels.rows());
  std::vector<ExrChannel> all;
  for (const char* name : {"R", "G", "B", "luminance.Y"}) all.push_back({name, std::vector<float>(count)});
  for (std::size_t k = 0; k < count; ++k) {
    const Spectrum radiance = image.pixels.row(static_cast<Eigen::Index>(k));
    const std::array<double, 3> rgb = linear_rgb(radiance, bands);
    for (std::size_t c = 0; c < 3; ++c) all[c].values[k] = static_cast<float>(rgb[c]);
    all[3].values[k] = static_cast<float>(luminance(radiance, bands));
  }
  const auto add = [&](const char* name, const auto& values) {
    if (values.size() == 0) return;
    ExrChannel channel{name, std::vector<float>(count)};
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

// Besides numbers, one channel of whole ones if there are any.
void write_channels(const std::filesystem::path& file, Imf::Header header, const std::vector<ExrChannel>& channels,
                    std::vector<std::uint32_t> patches) {
  header.compression() = Imf::ZIP_COMPRESSION;
  header.insert("software", Imf::StringAttribute(std::string("patchlight ") + version()));
  const auto width = static_cast<std::size_t>(header.dataWindow().max.x + 1);
  Imf::FrameBuffer pixels;
  const auto add = [&](const std::string& name, Imf::PixelType type, const void* values) {
    header.channels().insert(name, Imf::Channel(type));
    // What is written is only read.
    pixels.insert(name, Imf::Slice(type, static_cast<char*>(const_cast<void*>(values)), 4, 4 * width));
  };
  for (const ExrChannel& channel : channels) add(channel.name, Imf::FLOAT, channel.values.data());
  if (!patches.empty()) add("patch.id", Imf::UINT, patches.data());
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    Imf::OutputFile out(temporary.c_str(), header, 1);
    out.setFrameBuffer(pixels);
    out.writePixels(header.dataWindow().max.y + 1);
  });
}

// What OpenEXR refuses, in words of ours.
template <class Write>
void in_our_words(const std::filesystem::path& file, const Write& write) {
  try {
    write();
  } catch (const OutputError&) {
    throw;
  } catch (const std::exception& error) {
    throw OutputError(file.string(), std::string("the picture cannot be written as OpenEXR: ") + error.what());
  }
}

}  // namespace

void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<ExrChannel>& channels,
               const std::string& comment) {
  in_our_words(file, [&] {
    Imf::Header header(width, height);
    if (!comment.empty()) header.insert("comments", Imf::StringAttribute(comment));
    write_channels(file, std::move(header), channels, {});
  });
}

void write_exr(const std::filesystem::path& file, const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  in_our_words(file, [&] {
    Imf::Header header(image.width, image.height);
    if (picture.unfinished) header.insert("comments", Imf::StringAttribute("unfinished"));
    write_channels(file, std::move(header), channels_of(picture, bands), {image.patch.begin(), image.patch.end()});
  });
}

}  // namespace patchlight
