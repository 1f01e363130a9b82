#include "host/serve/quiet_frontend.hpp"

#include <thread>

namespace lamplock::serve {
namespace {

class NoProgress final : public run::Progress {
 public:
  void update(std::size_t) override {}
  void set_left(std::optional<double>) override {}
  void set_state(const run::ProgressState&) override {}
  void note(const std::string&) override {}
};

class NoInterrupts final : public run::Interrupts {
 public:
  int count() const override { return 0; }
  void forget() override {}
};

class NoInput final : public run::LineInput {
 public:
  std::vector<std::string> lines(std::chrono::milliseconds wait) override {
    if (wait.count() > 0) std::this_thread::sleep_for(wait);
    return {};
  }
  void read_ahead() override {}
  bool ended() const override { return true; }
  bool is_typed() const override { return false; }
  std::string begun() const override { return ""; }
};

}  // namespace

std::unique_ptr<run::Progress> QuietFrontend::progress(std::string, std::size_t, std::size_t) {
  return std::make_unique<NoProgress>();
}

std::unique_ptr<run::Interrupts> QuietFrontend::interrupts() {
  return std::make_unique<NoInterrupts>();
}

std::unique_ptr<run::LineInput> QuietFrontend::line_input() { return std::make_unique<NoInput>(); }

}  // namespace lamplock::serve
