// A bad cable with a link and a fake machine at its end.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/link/link.hpp"
#include "tests/bad_cable.hpp"
#include "tests/link/fake_machine.hpp"

namespace lamplock::test {

/// Transport with faults; owns link and machine.
class FaultyTransport : public BadCable {
 public:
  using BadCable::BadCable;

  FakeMachine machine;
  link::Link link;
  std::uint32_t points_per_ms = 8;

 private:
  void machine_receive(std::span<const std::uint8_t> bytes) override {
    link.receive(bytes, machine);
  }
  void machine_reconnected() override { link.new_connection(); }
  void machine_run() override {
    if (now().count() % 1000 == 0) machine.fire(points_per_ms);
    link.poll(machine);
  }
  std::size_t machine_transmit(std::span<std::uint8_t> bytes) override {
    return link.transmit(bytes);
  }
};

}  // namespace lamplock::test
