#pragma once

#include "patchlight/input/read_scene.h"

#include <CLI/App.hpp>

namespace patchlight::cli {

/// Adds --sky, --sun, --ground and --weather to a command. What is parsed lands in `daylight`, which must outlive it.
void add_daylight_options(CLI::App& command, DaylightSetting& daylight);

}  // namespace patchlight::cli
