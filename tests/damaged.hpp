// Damaged files: every reader must read them or refuse them in one line.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

#include "host/error.hpp"

namespace lamplock::test {

/// Replaces one to three of the bytes by some of `bites`; every fourth time truncates them too.
inline std::string damaged(std::string bytes, std::string_view bites, std::mt19937_64& random) {
  for (auto changes = random() % 3 + 1; changes > 0; --changes) {
    bytes[random() % bytes.size()] = bites[random() % bites.size()];
  }
  if (random() % 4 == 0) bytes.resize(random() % bytes.size());
  return bytes;
}

/// Calls `call`, which reads a file and checks it; it may throw Error (bad input) of one line.
template <class Call>
void expect_read_or_refused(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

/// Damages `whole` with `bites` many times; `read` gets the bytes, reads them and checks the
/// result.
template <class Read>
void expect_damaged_read_or_refused(int times, const std::string& whole, std::string_view bites,
                                    Read&& read) {
  std::mt19937_64 random(2);
  for (int i = 0; i < times; ++i) {
    const std::string bytes = damaged(whole, bites, random);
    expect_read_or_refused([&] { read(bytes); });
  }
}

/// All bytes.
inline std::string any_byte() {
  std::string bites;
  for (int byte = 0; byte < 256; ++byte) bites += static_cast<char>(byte);
  return bites;
}

}  // namespace lamplock::test
