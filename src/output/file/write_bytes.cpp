#include "output/file/write_bytes.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

namespace patchlight {

void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    // A full disk may show on closing only.
    stream.close();
    if (!stream) throw OutputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
  });
}

}  // namespace patchlight
