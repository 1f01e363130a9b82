// Serves one image on the chip simulator to a debugger, and tells what its pins did.
//
// usage: gdb_serve IMAGE SECONDS [alone]
// Prints the address to connect to (127.0.0.1, a free port) and waits for a debugger with the chip
// halted at reset; with "alone" it does not wait. Ends when the debugger kills it, or when SECONDS
// of simulated time are over, with a line that sums up every edge of every pad: equal lines, equal
// runs.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "sim/chip/chip.hpp"
#include "sim/chip/gdb/server.hpp"
#include "sim/chip/image/image.hpp"
#include "sim/chip/usb_host/usb_host.hpp"
#include "sim/endpoint/tcp_endpoint.hpp"

namespace {

using namespace lamplock::sim;

/// Counts edges and mixes them into a number (FNV-1a over words).
class EdgeSum final : public chip::PadListener {
 public:
  void pad_changed(unsigned gpio, bool level, chip::Cycle at) override {
    ++count_;
    mix(gpio << 1 | (level ? 1u : 0u));
    mix(at);
  }
  void mix(std::uint64_t word) { sum_ = (sum_ ^ word) * 0x0000'0100'0000'01b3; }
  std::uint64_t count() const { return count_; }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t sum_ = 0xcbf2'9ce4'8422'2325;
};

bool run(chip::Chip& chip, chip::gdb::Server& server, Picoseconds end) {
  // The clock changes on the way, and with it the cycle that a time means.
  while (chip.time() < end)
    if (!server.run_until(chip.now() + chip.wheel().frequency() / 1000)) return false;
  return true;
}

void serve(const char* path, double seconds, bool alone) {
  chip::Chip chip;
  EdgeSum edges;
  chip.gpio().listen(edges);
  const chip::UsbHost host(chip.wheel(), chip.usb());
  chip.load(chip::load_image(path), path);
  chip.power_on();
  TcpEndpoint endpoint("127.0.0.1:0");
  std::printf("%s\n", endpoint.address().c_str());
  std::fflush(stdout);
  chip::gdb::Server server(chip, endpoint,
                           alone ? chip::gdb::Start::running : chip::gdb::Start::halted);
  if (!run(chip, server, static_cast<Picoseconds>(seconds * static_cast<double>(ps_per_s)))) return;
  edges.mix(chip.core(0).cycle());
  for (unsigned i = 0; i < 16; ++i) edges.mix(chip.core(0).reg(i));
  for (const std::uint8_t byte : chip.bus().sram()) edges.mix(byte);
  std::printf(
      "end: %s, %llu edges, sum %016llx\n", host.enumerated() ? "enumerated" : "not enumerated",
      static_cast<unsigned long long>(edges.count()), static_cast<unsigned long long>(edges.sum()));
}

}  // namespace

int main(int count, char** arguments) {
  const bool alone = count == 4 && std::string_view(arguments[3]) == "alone";
  if (count != 3 && !alone) {
    std::fprintf(stderr, "usage: gdb_serve IMAGE SECONDS [alone]\n");
    return 2;
  }
  try {
    serve(arguments[1], std::atof(arguments[2]), alone);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
  return 0;
}
