#include "cli/standard_streams.h"

#include "patchlight/base/error.h"

#include "cli/messages.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iostream>
#include <string>
#include <unistd.h>

namespace patchlight::cli {
// Keeps what is written until it is flushed.
class StandardOutput::Buffer : public std::streambuf {
 public:
  int error_number() const { return error_number_; }

 protected:
  int_type overflow(int_type letter) override {
    if (!traits_type::eq_int_type(letter, traits_type::eof())) text_ += traits_type::to_char_type(letter);
    return traits_type::not_eof(letter);
  }
  std::streamsize xsputn(const char* letters, std::streamsize count) override {
    text_.append(letters, static_cast<std::size_t>(count));
    return count;
  }
  int sync() override {
    const std::string bytes = printable(text_);
    text_.clear();
    std::size_t done = 0;
    while (done < bytes.size() && error_number_ == 0) {
      const ssize_t count = ::write(STDOUT_FILENO, bytes.data() + done, bytes.size() - done);
      if (count >= 0) {
        done += static_cast<std::size_t>(count);
      } else if (errno != EINTR) {
        error_number_ = errno;
      }
    }
    return error_number_ == 0 ? 0 : -1;
  }

 private:
  std::string text_;
  int error_number_ = 0;
};

void open_standard_streams() {
  // In this order, as open() takes the lowest number that is free. A null device opened for reading refuses writing.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    const int opened = open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != descriptor) close(opened);
  }
}

StandardOutput::StandardOutput() : buffer_(std::make_unique<Buffer>()), before_(std::cout.rdbuf(buffer_.get())) {}

StandardOutput::~StandardOutput() {
  std::cout.flush();
  std::cout.rdbuf(before_);
}

void StandardOutput::finish() {
  std::cout.flush();
  if (buffer_->error_number() == 0) return;
  throw OutputError("standard output", std::string("cannot be written: ") + std::strerror(buffer_->error_number()));
}

}  // namespace patchlight::cli
