// Where tests find the files of the repository and what was built from it.
//
// Only tests/paths.cpp is compiled with these places, so a compiler cache serves the other tests of
// every checkout.
#pragma once

#include <string>
#include <string_view>

namespace lamplock::test {

/// A file or folder of the repository, by its path from there: "docs/safety.md".
std::string in_repository(std::string_view path);
/// One of the folder of the build: "lamplock-rp2040.uf2".
std::string in_build(std::string_view path);

}  // namespace lamplock::test
