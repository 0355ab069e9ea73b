// Loaded before a program, makes it take the locale of its environment, as windows and script languages do.
#include <clocale>

namespace {
const bool taken = std::setlocale(LC_ALL, "") != nullptr;
}
