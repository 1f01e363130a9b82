// Checks the error for bad input: one line, the right exit status.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "host/error.hpp"

namespace lamplock::test {

/// The message of the Error (bad input) that `call` must throw; a failure and "" otherwise.
template <class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("error: ")) << text;
    return text;
  }
  ADD_FAILURE() << "no error";
  return "";
}

}  // namespace lamplock::test
