// The frontend of a use case that makes a file for a page: keeps its notices, asks nothing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/run/frontend.hpp"

namespace lamplock::serve {

class QuietFrontend final : public run::Frontend {
 public:
  void line(const std::string&) override {}
  void text(const std::string&) override {}
  void notice(const std::string& text) override { notices_.push_back(text); }
  void phase(const std::string&, const std::string&) override {}
  void restart_clock() override {}
  std::unique_ptr<run::Progress> progress(std::string, std::size_t, std::size_t) override;
  std::unique_ptr<run::Interrupts> interrupts() override;
  std::unique_ptr<run::LineInput> line_input() override;
  std::unique_ptr<run::LineInput> dialogue_input() override { return line_input(); }
  bool can_ask() const override { return false; }
  bool confirms(const std::string&) override { return false; }

  const std::vector<std::string>& notices() const { return notices_; }

 private:
  std::vector<std::string> notices_;
};

}  // namespace lamplock::serve
