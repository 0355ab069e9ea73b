#include "files/sha256.h"

#include <gtest/gtest.h>

namespace patchlight::sha256_test {
namespace {

// Two messages and digests from NIST's example computations for FIPS 180-4, and the digest of the empty message.
TEST(Sha256, GivesThePublishedDigests) {
  EXPECT_EQ(sha256(std::vector<std::string>{}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256(std::vector<std::string>{"abc"}),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::vector<std::string>{"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"}),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, OfPartsIsThatOfTheirConcatenation) {
  EXPECT_EQ(sha256(std::vector<std::string>{"a", "", "bc"}), sha256(std::vector<std::string>{"abc"}));
}

}  // namespace
}  // namespace patchlight::sha256_test
