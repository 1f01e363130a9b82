#include "host/serve/paced_transport.hpp"

#include <algorithm>
#include <thread>

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;

constexpr auto max_lag = 100ms;
constexpr auto slice = 1ms;

}  // namespace

std::size_t PacedTransport::write(std::span<const std::uint8_t> bytes) {
  pass_time();
  return inner_.write(bytes);
}

std::size_t PacedTransport::read(std::span<std::uint8_t> bytes) {
  pass_time();
  return inner_.read(bytes);
}

void PacedTransport::wait(std::chrono::microseconds time) {
  const auto until = Clock::now() + time;
  for (pass_time(); !made_.board->has_output() && Clock::now() < until; pass_time())
    std::this_thread::sleep_for(std::min<Clock::duration>(slice, until - Clock::now()));
}

void PacedTransport::pass_time() {
  const auto now = Clock::now();
  passed_until_ = std::max(passed_until_, now - max_lag);
  const auto time = std::chrono::duration_cast<std::chrono::microseconds>(now - passed_until_);
  passed_until_ += time;
  made_.board->run_until(made_.board->now() + time.count() * sim::ps_per_us);
}

}  // namespace lamplock::serve
