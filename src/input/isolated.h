#pragma once

#include "patchlight/scene/scene.h"

#include <functional>
#include <string>

namespace patchlight {

/// What `read` returns, found in a child process: libraries that read rich formats can crash on damaged files, and then
/// only the child ends. \throws InputError as `read` does, and naming `file` when the child crashed, threw anything
/// else, took more memory than 4 GB and 300 times the size of the file, or took more than `most_seconds` of processor
/// time; a house of 2 MB takes 0.1.
Scene read_isolated(const std::string& file, const std::function<Scene()>& read, unsigned most_seconds = 60);

}  // namespace patchlight
