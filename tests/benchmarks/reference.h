#pragma once

#include "patchlight/transport/exchange_areas.h"

#include "benchmarks/room.h"

#include <filesystem>

namespace patchlight::benchmarks {

/// Exchange areas before closure with so many shadow rays for every pair that rays decide; with another seed than what
/// is compared with it. Read from `file` when that is there, else found and written to it.
ExchangeAreas reference(const Room& room, int samples, const std::filesystem::path& file);

}  // namespace patchlight::benchmarks
