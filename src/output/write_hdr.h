#pragma once

#include "patchlight/views/picture.h"

#include <filesystem>

namespace patchlight {

/// Writes the radiances of a picture as Radiance does, W/(m^2 sr) of linear RGB with Rec. 709 primaries: one exponent
/// for three mantissas of eight bits (Ward 1991, Real Pixels), run-length encoded. The view goes with it, but for
/// panoramas, which Radiance has none of. \throws OutputError.
void write_hdr(const std::filesystem::path& file, const Picture& picture, const Vector& up, const Bands& bands);

}  // namespace patchlight
