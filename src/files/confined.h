#pragma once

#include <filesystem>
#include <vector>

namespace patchlight {

/// From now on this process and its children open no sockets, write no files and read files of these folders only, as
/// far as the kernel can keep them from it (Landlock, seccomp). Files that are open stay so.
void confine_process(const std::vector<std::filesystem::path>& readable);

}  // namespace patchlight
