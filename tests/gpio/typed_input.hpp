// Simulates typed lines on the standard input.
#pragma once

#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <string_view>

namespace lamplock::test {

/// The standard input is a pipe while this object lives.
class TypedInput {
 public:
  TypedInput() : kept_(::dup(STDIN_FILENO)) {
    EXPECT_EQ(::pipe(pipe_.data()), 0);
    ::dup2(pipe_[0], STDIN_FILENO);
  }
  ~TypedInput() {
    if (kept_ >= 0) {
      ::dup2(kept_, STDIN_FILENO);
      ::close(kept_);
    }
    ::close(pipe_[0]);
    ::close(pipe_[1]);
  }
  TypedInput(const TypedInput&) = delete;
  TypedInput& operator=(const TypedInput&) = delete;

  void type(std::string_view text) {
    EXPECT_EQ(::write(pipe_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  /// True if the typed lines have been read; the program polls by the wall clock.
  bool taken() const {
    int waiting = 0;
    EXPECT_EQ(::ioctl(pipe_[0], FIONREAD, &waiting), 0);
    return waiting == 0;
  }

 private:
  int kept_;
  std::array<int, 2> pipe_{};
};

}  // namespace lamplock::test
