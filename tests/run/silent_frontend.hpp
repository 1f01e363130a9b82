// A front end that shows nothing and answers nothing, for tests of use cases.
#pragma once

#include "host/run/frontend.hpp"

namespace lamplock::test {

class SilentFrontend : public run::Frontend {
 public:
  void line(const std::string&) override {}
  void text(const std::string&) override {}
  void notice(const std::string&) override {}
  void phase(const std::string&, const std::string&) override {}
  void restart_clock() override {}
  std::unique_ptr<run::Progress> progress(std::string, std::size_t, std::size_t) override {
    return nullptr;
  }
  std::unique_ptr<run::Interrupts> interrupts() override { return nullptr; }
  std::unique_ptr<run::LineInput> line_input() override { return nullptr; }
  std::unique_ptr<run::LineInput> dialogue_input() override { return nullptr; }
  bool can_ask() const override { return false; }
  bool confirms(const std::string&) override { return false; }
};

}  // namespace lamplock::test
