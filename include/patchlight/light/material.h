#pragma once

#include "patchlight/light/spectrum.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// Place of a material in Scene::materials.
using MaterialIndex = std::uint32_t;

/// The index of refraction of window glass.
inline constexpr double usual_index = 1.52;

/// The statements of a model file about a material that it makes a pane or a mirror.
struct StatedSurface {
  std::string by;             ///< the statement, for messages: "d 0.3"
  Spectrum matt_reflectance;  ///< what the surface reflects diffusely if it is taken for opaque and matt
  Spectrum matt_exitance{};   ///< what it emits then, W/m^2; empty: as much as otherwise
};

/// A picture on surfaces. In its coordinates it has the width and the height 1: u runs from its left to its right, v
/// from its top to its bottom.
struct Texture {
  std::uint32_t width = 0;  ///< texels, 1 or more
  std::uint32_t height = 0;
  std::vector<std::array<float, 3>> texels;  ///< linear RGB with Rec. 709 primaries, row by row from the top
};

/// How a picture continues beyond its edges.
enum class Wrap : std::uint8_t {
  repeat,  ///< the picture again
  mirror,  ///< the picture mirrored, and so on by turns
  clamp    ///< the texels of the edge
};

/// A reflectance that follows a picture: the sum of a texel's red, green and blue times what each of the three stands
/// for.
struct TexturedReflectance {
  std::shared_ptr<const Texture> texture;
  std::array<Spectrum, 3> of_primaries;  ///< the reflectance where the picture is 1 in red, in green and in blue alone
  std::array<Wrap, 2> wrap{};            ///< beyond u and beyond v of 0 to 1
};

/// The spectra of a material by wavelength; null where its spectrum of colors counts.
struct MaterialSpectra {
  std::shared_ptr<const SampledSpectrum> reflectance{};
  std::shared_ptr<const SampledSpectrum> specular_reflectance{};
  std::shared_ptr<const SampledSpectrum> transmittance{};
  std::shared_ptr<const SampledSpectrum> diffuse_transmittance{};
  std::shared_ptr<const SampledSpectrum> light{};  ///< the spectral distribution of its emission; any multiple of it
};

/// A surface that scatters diffusely (Lambertian), and may let light through or reflect it as a mirror besides; all
/// spectra have the scene's number of bands.
struct Material {
  std::string name;
  Spectrum reflectance;      ///< rho, in [0, 1]
  Spectrum exitance;         ///< self-emitted, W/m^2; pi times the emitted radiance
  Spectrum transmittance{};  ///< tau, in [0, 1]: the share of light that goes straight through at normal incidence, as
                             ///< through the glass of a window; empty or 0: opaque
  double index = usual_index;  ///< n, 1 or more: the index of refraction, by which a clear material lets less through
                               ///< at an angle; 1: a sheet with holes, which lets the same through at all angles
  Spectrum specular_reflectance{};   ///< in [0, 1]: the share of light that is reflected as by a mirror, at all angles
                                     ///< alike; empty or 0: none, but for what a clear material reflects by its index
  Spectrum diffuse_transmittance{};  ///< tau, in [0, 1]: the share of light that a translucent sheet scatters out of
                                     ///< its other side, evenly; empty or 0: none
  std::optional<StatedSurface> stated_pane{};    ///< where a model file makes it a pane, and no setting has another say
  std::optional<StatedSurface> stated_mirror{};  ///< the same of a mirror
  std::optional<TexturedReflectance>
      texture{};              ///< where a polygon has a TextureMap: what `reflectance` is the mean of
  bool second_face = false;   ///< made up, clear in full: that of the second faces of solid panes
  MaterialSpectra spectra{};  ///< until the scene has its bands, see read_scene()
};

}  // namespace patchlight
