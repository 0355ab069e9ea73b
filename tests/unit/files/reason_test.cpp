#include "files/reason.h"

#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight::reason_test {
namespace {

using nlohmann::json;

void parse(const std::string& text) { static_cast<void>(json::parse(text).size()); }

std::string reason(const std::function<void()>& fail) {
  try {
    fail();
  } catch (const std::exception& error) {
    return reason_of(error);
  }
  ADD_FAILURE() << "did not throw";
  return {};
}

// Exceptions of the standard library and of the JSON library, as thrown by them.
const std::vector<std::function<void()>>& failures() {
  static const json list = json::parse("[1]");
  static const std::vector<std::function<void()>> all = {[] { throw std::bad_alloc(); },
                                                         [] { std::vector<int>().reserve(std::size_t(-1)); },
                                                         [] { static_cast<void>(std::vector<int>().at(1)); },
                                                         [] { static_cast<void>(std::string().at(1)); },
                                                         [] { static_cast<void>(list.at("rooms")); },
                                                         [] { static_cast<void>(list.at(7)); },
                                                         [] { static_cast<void>(list.get<std::string>()); },
                                                         [] { static_cast<void>(json::object().at("rooms")); },
                                                         [] { parse("{"); },
                                                         [] { parse("\"\xff\""); },
                                                         [] { parse("1e999999"); }};
  return all;
}

TEST(ReasonOf, HasNoWordsOfLibraries) {
  for (const auto& fail : failures()) {
    const std::string text = reason(fail);
    EXPECT_FALSE(text.empty());
    for (const char* word : {"std::", "bad_alloc", "_M_", "json", "exception", "at()", "vector", "__"})
      EXPECT_EQ(text.find(word), std::string::npos) << text;
  }
}

TEST(ReasonOf, NamesTheKeyAndTheLineInTheFile) {
  EXPECT_NE(reason([] { static_cast<void>(json::object().at("rooms")); }).find("'rooms'"), std::string::npos);
  EXPECT_NE(reason([] { parse("{\n\n]"); }).find("line 3"), std::string::npos);
}

// An importer that returns its errors as text has the same causes.
TEST(ReasonOf, TextsOfLibrariesAreReplacedToo) {
  EXPECT_EQ(reason_of(std::string("std::bad_alloc")), reason([] { throw std::bad_alloc(); }));
  EXPECT_EQ(reason_of(std::string("a file of version 3")), "a file of version 3");
  EXPECT_EQ(reason_of(std::string("no mesh\nno node\n")), "no mesh no node");
  const std::string of_json = "Failed: [json.exception.parse_error.101] parse error at line 2, column 7: ill-formed\n";
  EXPECT_EQ(reason_of(of_json), "it is not JSON at line 2, column 7");
}

}  // namespace
}  // namespace patchlight::reason_test
