// Damaged files: what every reader must read or refuse in one line, and never do more.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

#include "host/error.hpp"

namespace lamplock::test {

/// The bytes with one to three of them changed to some out of `bites`; every fourth time the end is
/// cut off too.
inline std::string damaged(std::string bytes, std::string_view bites, std::mt19937_64& random) {
  for (auto changes = random() % 3 + 1; changes > 0; --changes) {
    bytes[random() % bytes.size()] = bites[random() % bites.size()];
  }
  if (random() % 4 == 0) bytes.resize(random() % bytes.size());
  return bytes;
}

/// Calls what reads a file and judges what it has read. It may throw Error (bad input) of one line.
template <class Call>
void expect_read_or_refused(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

}  // namespace lamplock::test
