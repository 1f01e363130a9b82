#include "sim/chip/gdb/server.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace lamplock::sim::chip::gdb {

Server::Server(Chip& chip, ByteEndpoint& endpoint, Start start)
    : chip_(chip), endpoint_(endpoint), target_(chip), stub_(target_, start == Start::running) {
  // The debugger must see the cores before their first instruction.
  chip_.run_until(chip_.now());
}

bool Server::exchange() {
  std::array<std::uint8_t, 4096> bytes;
  const std::size_t count = endpoint_.read(bytes);
  stub_.receive(std::span(bytes).first(count));
  unsent_ += stub_.take_output();
  const auto* first = reinterpret_cast<const std::uint8_t*>(unsent_.data());
  unsent_.erase(0, endpoint_.write(std::span(first, unsent_.size())));
  return count != 0;
}

bool Server::run_until(Cycle until, const std::function<bool()>& is_cancelled) {
  constexpr auto pause = std::chrono::milliseconds(1);
  for (;;) {
    const bool heard = exchange();
    if (stub_.killed()) return false;
    if (!stub_.running()) {
      if (is_cancelled && is_cancelled()) return false;
      if (!heard) std::this_thread::sleep_for(pause);
      continue;
    }
    if (chip_.now() >= until) return true;
    stub_.run(std::min(until, chip_.now() + stretch));
  }
}

}  // namespace lamplock::sim::chip::gdb
