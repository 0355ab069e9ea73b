#include "cli/picture_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"
#include "output/image/write_picture.h"
#include "scene/projection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace patchlight::cli {
namespace {

constexpr std::uint64_t most_pixels_per_edge = 32768;

std::array<int, 2> size_of_picture(const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw refusal("--size", text, "width and height in pixels, as in 1600x900");
  const auto edge = [](const std::string& part) {
    return static_cast<int>(whole_number("--size", part, 1, most_pixels_per_edge));
  };
  return {edge(text.substr(0, cross)), edge(text.substr(cross + 1))};
}

Projection projection_asked(const std::string& text) {
  using enum Projection;
  return choice<Projection>("--projection", text,
                            {{name_of(perspective), perspective},
                             {name_of(orthographic), orthographic},
                             {name_of(angular), angular},
                             {name_of(hemispherical), hemispherical},
                             {name_of(panorama), panorama}});
}

void add_camera_options(CLI::App& command, PictureGiven& given) {
  command
      .add_option_function<std::vector<std::string>>(
          "--camera",
          [&given](const std::vector<std::string>& values) {
            const std::string degrees = std::string("an angle above 0 degrees, as in ") + camera_example;
            given.camera = Camera{point("--camera (EYE)", values[0]), point("--camera (TARGET)", values[1]),
                                  number("--camera (FOV)", values[2], degrees, [](double x) { return x > 0; })};
          },
          "view of the picture: eye and target as X,Y,Z in model\nunits, vertical field of view in degrees; "
          "default: a view\nfrom within the scene's bounds that shows most of it")
      ->expected(3)
      ->option_text("EYE TARGET FOV");
  add(command, "--projection", "NAME",
      "with --camera: perspective, orthographic (FOV is the height that\nis shown, in model units; what is nearer than "
      "the eye's plane is\ncut away), fisheye angular or hemispherical, panorama; default\nperspective",
      [&given](const std::string& text) { given.projection = projection_asked(text); });
  command
      .add_option_function<std::vector<std::string>>(
          "--view",
          [&given](const std::vector<std::string>& names) {
            for (const std::string& name : names)
              if (name.empty()) throw refusal("--view", name, "the name of a camera");
            given.views = names;
          },
          "view of the picture: a camera of the scene file; default: its first")
      ->allow_extra_args(false)
      ->option_text("NAME");
}

Camera with_projection(Camera camera, Projection projection) {
  camera.projection = projection;
  if (projection == Projection::orthographic) camera.height = camera.vertical_field_of_view;
  if (has_extent(camera)) return camera;
  const std::string found = std::to_string(std::lround(camera.vertical_field_of_view)) + " degrees";
  throw UsageError("--camera (FOV): found " + found + "; expected an angle above 0 and " +
                   (projection == Projection::perspective ? "below " : "up to ") +
                   std::to_string(std::lround(largest_field_of_view(projection))) + " degrees, as in " +
                   camera_example);
}

void require_picture_of(const PictureGiven& given, const std::string& file_option) {
  const bool picture_alone = !given.for_observers;
  const char* const needs = given.camera && picture_alone           ? "--camera"
                            : !given.views.empty() && picture_alone ? "--view"
                            : given.colors                          ? "--false-color"
                            : given.quality                         ? "--picture-quality"
                            : given.size                            ? "--size"
                            : given.error                           ? "--picture-error"
                            : given.most_samples                    ? "--picture-samples"
                            : !given.error_map.empty()              ? "--picture-error-map"
                                                                    : nullptr;
  if (given.file.empty() && needs != nullptr) throw UsageError(std::string(needs) + " needs " + file_option + " FILE");
  if (given.camera && !given.views.empty())
    throw UsageError("--camera and --view both say where the picture is taken from; give one of them");
  if (given.projection && !given.camera)
    throw UsageError("--projection needs --camera EYE TARGET FOV; a camera of a scene file states its own");
  if (given.camera && given.camera->eye == given.camera->target)
    throw UsageError("--camera: EYE and TARGET are the same point; expected two different ones");
}

// "room.png" of the view "desk": "room.desk.png", with what file names do not like as "_".
std::filesystem::path with_view(const std::filesystem::path& file, const std::string& view) {
  if (file.empty()) return file;
  std::string name = view;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == '/' || letter == '\\' || letter == ':'; }, '_');
  return file.parent_path() / (file.stem().string() + '.' + name + file.extension().string());
}

}  // namespace

void add_view_options(CLI::App& command, PictureGiven& given) {
  add_camera_options(command, given);
  add(command, "--size", "WIDTHxHEIGHT", "of the picture in pixels; default 800x800",
      [&given](const std::string& text) { given.size = size_of_picture(text); });
}

void add_picture_options(CLI::App& command, PictureGiven& given, PictureQuality usual) {
  add(command, "--false-color", "luminance", "picture in false colors with a legend in cd/m^2; default: natural colors",
      [&given](const std::string& text) {
        given.colors = choice<PictureColors>("--false-color", text, {{"luminance", PictureColors::luminance}});
      });
  add_view_options(command, given);
  add(command, "--picture-quality", "draft|final",
      std::string("picture of the smoothed solution, or of light that is gathered\nat each of its points; default ") +
          (usual == PictureQuality::draft ? "draft" : "final"),
      [&given](const std::string& text) {
        given.quality = choice<PictureQuality>("--picture-quality", text,
                                               {{"draft", PictureQuality::draft}, {"final", PictureQuality::final}});
      });
  add(command, "--picture-error", "NUMBER",
      "wanted standard error of the luminance of a final picture's\npixels, relative; dark pixels are granted more; "
      "default 1%",
      [&given](const std::string& text) { given.error = relative_error("--picture-error", text); });
  add(command, "--picture-samples", "N", "samples of a final picture's pixel at most, a power of two; default 64",
      [&given](const std::string& text) {
        const std::uint64_t samples =
            whole_number("--picture-samples", text, least_picture_samples, most_picture_samples);
        if (!std::has_single_bit(samples)) throw refusal("--picture-samples", text, "a power of two, as 128 or 256");
        given.most_samples = static_cast<int>(samples);
      });
  add(command, "--picture-error-map", "FILE",
      "that error of each pixel in false colors with a legend in\ncd/m^2 (.png); default: not written",
      [&given](const std::string& text) {
        if (text.empty()) throw refusal("--picture-error-map", text, "the name of a file");
        given.error_map = text;
      });
}

PictureSettings picture_settings(const PictureGiven& given, const std::string& file_option, PictureQuality usual) {
  require_picture_of(given, file_option);
  PictureSettings settings;
  settings.file = given.file;
  settings.error_map = given.error_map;
  settings.views = given.views;
  if (given.camera)
    settings.camera = with_projection(*given.camera, given.projection.value_or(Projection::perspective));
  settings.colors = given.colors.value_or(PictureColors::natural);
  settings.quality = given.quality.value_or(usual);
  if (given.size) settings.size = *given.size;
  settings.error = given.error.value_or(settings.error);
  settings.most_samples = given.most_samples.value_or(settings.most_samples);
  const auto& extensions = picture_extensions();
  if (!given.file.empty() &&
      std::find(extensions.begin(), extensions.end(), settings.file.extension()) == extensions.end())
    throw UsageError(file_option + ": found '" + given.file + "'; expected a name that ends in .png, .hdr or .exr");
  if (!given.error_map.empty() && settings.error_map.extension() != ".png")
    throw UsageError("--picture-error-map: found '" + given.error_map + "'; expected a name that ends in .png");
  if (settings.quality == PictureQuality::draft && (given.error || given.most_samples || !given.error_map.empty()))
    throw UsageError(std::string(given.error          ? "--picture-error"
                                 : given.most_samples ? "--picture-samples"
                                                      : "--picture-error-map") +
                     " is of final pictures; give --picture-quality final");
  if (given.colors && settings.file.extension() != ".png")
    throw UsageError("--false-color is of pictures in PNG; found '" + given.file +
                     "', which has luminances themselves");
  return settings;
}

std::vector<PictureSettings> single_pictures(const PictureSettings& settings) {
  if (settings.views.size() < 2) return {settings};
  std::vector<PictureSettings> all;
  for (const std::string& view : settings.views) {
    PictureSettings one = settings;
    one.views = {view};
    one.file = with_view(settings.file, view);
    one.error_map = with_view(settings.error_map, view);
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<OutputFile> picture_files(const PictureSettings& settings, const std::string& file_option) {
  std::vector<OutputFile> files;
  for (const PictureSettings& one : single_pictures(settings)) {
    files.push_back({file_option, one.file});
    files.push_back({"--picture-error-map", one.error_map});
  }
  return files;
}

}  // namespace patchlight::cli
