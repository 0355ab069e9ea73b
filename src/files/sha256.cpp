#include "files/sha256.h"

#include <array>
#include <memory>
#include <openssl/evp.h>
#include <stdexcept>

namespace patchlight {

std::string sha256(std::span<const std::string> parts) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool good = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const std::string& part : parts) {
    good = good && EVP_DigestUpdate(context.get(), part.data(), part.size()) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  good = good && EVP_DigestFinal_ex(context.get(), digest.data(), &length) == 1;
  if (!good) throw std::runtime_error("OpenSSL offers no SHA-256 on this machine");

  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (unsigned int k = 0; k < length; ++k) {
    text += digits[digest[k] >> 4];
    text += digits[digest[k] & 15];
  }
  return text;
}

}  // namespace patchlight
