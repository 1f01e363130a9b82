// A small CDC serial device that drives the USB controller through its registers as a driver does,
// and its bench: wheel, interrupt lines, DPRAM, controller.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include "sim/chip/usb/registers.hpp"
#include "sim/chip/usb/usb_controller.hpp"

namespace lamplock::sim::chip::rigs {

namespace reg = usb::reg;
namespace bc = usb::buffer_control;
using Bytes = std::vector<std::uint8_t>;

/// The chip around the controller.
struct UsbBench {
  explicit UsbBench(UsbErrata errata = {})
      : controller(
            wheel, irq, dpram, [this](const std::string& what) { unknown.insert(what); }, errata) {
    wheel.set_frequency(125'000'000);
  }
  TimeWheel wheel;
  IrqLines irq;
  std::array<std::uint8_t, 4096> dpram{};
  std::set<std::string> unknown;
  UsbController controller;

  Picoseconds now() const { return wheel.time(); }
  std::uint32_t load(std::uint32_t at) const {
    return static_cast<std::uint32_t>(dpram[at] | dpram[at + 1] << 8 | dpram[at + 2] << 16) |
           static_cast<std::uint32_t>(dpram[at + 3]) << 24;
  }
  void store(std::uint32_t at, std::uint32_t value) {
    const std::uint32_t before = load(at);
    for (std::uint32_t i = 0; i < 4; ++i) dpram[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
    controller.dpram_stored(at, before, value);
  }
  std::uint16_t load_half(std::uint32_t at) const {
    return static_cast<std::uint16_t>(dpram[at] | dpram[at + 1] << 8);
  }
  void store_half(std::uint32_t at, std::uint32_t value) {
    const std::uint32_t word = at & ~3u, shift = 8 * (at & 2u);
    store(word, (load(word) & ~(0xffffu << shift)) | (value & 0xffffu) << shift);
  }
  /// Half of a buffer control word; `index` = 2 x endpoint, + 1 if OUT.
  static std::uint32_t control_word(std::uint32_t index, std::uint32_t buffer = 0) {
    return 0x80 + 4 * index + 2 * buffer;
  }
  /// As the datasheet requires: fields first, AVAILABLE a cycle of clk_usb later.
  void arm(std::uint32_t index, std::uint32_t buffer, std::uint32_t fields) {
    store_half(control_word(index, buffer), fields);
    wheel.advance_to(wheel.now() + 3);
    store_half(control_word(index, buffer), fields | bc::available);
  }
  void write(std::uint32_t offset, std::uint32_t value) { controller.write(offset, value); }
  std::uint32_t read(std::uint32_t offset) { return controller.read(offset); }
  bool interrupt() const { return (irq.levels() & 1u << static_cast<unsigned>(Irq::usbctrl)) != 0; }
};

/// Properties and behaviour of the device.
struct FakeOptions {
  bool doubled = false;
  bool zero_length = true;  ///< ends full transfers
  std::size_t room = 2048;  ///< bytes held before OUT packets are refused
  bool echo = true;
  bool avoid_e15 = false;  ///< no bulk IN armed in the last 200 us of a frame
};

/// CDC device: EP1 interrupt IN, EP2 bulk IN and OUT.
class FakeCdc {
 public:
  FakeCdc(UsbBench& bench, FakeOptions options = {});

  void start();
  void stop() { bench_.write(reg::sie_ctrl, usb::sie_ctrl::ep0_int_1buf); }
  void interrupt();
  void send(const Bytes& bytes);
  void stall_bulk(bool in);
  void wake_host();

  Bytes device_descriptor, configuration_descriptor;
  std::vector<std::string> strings = {"lamplock", "fake", "0001"};
  Bytes received;  ///< with echo off
  bool configured = false, paused = false, dtr = false;
  int resets = 0, suspends = 0, resumes = 0, setups = 0;
  FakeOptions options;

 private:
  struct Pipe {
    std::uint32_t index = 0;
    std::uint32_t next = 0;  ///< buffer to arm next
    std::uint32_t armed = 0;
    bool data1 = false;
    bool reset_select = false;
    std::deque<std::uint32_t> lengths;
  };
  void bus_reset();
  void setup();
  void standard(const Bytes& packet);
  void answer(Bytes data, std::size_t length);
  void send_ep0();
  void accept_status();
  void stall_ep0();
  void buffer_done(std::uint32_t index);
  void configure();
  void reset_pipe(Pipe& pipe);
  void arm(Pipe& pipe, std::uint32_t length, bool full);
  void feed_in();
  void feed_out();
  std::uint32_t buffers() const { return options.doubled ? 2 : 1; }
  std::uint32_t address(const Pipe& pipe, std::uint32_t buffer) const {
    return (pipe.index == 4 ? 0x200u : 0x300u) + 64 * buffer;
  }
  bool late() const;

  UsbBench& bench_;
  std::deque<std::uint8_t> to_send_;
  Pipe in_{.index = 4, .lengths = {}}, out_{.index = 5, .lengths = {}};
  bool zero_length_due_ = false;
  Bytes ep0_data_;
  std::size_t ep0_sent_ = 0;
  bool ep0_data1_ = true, ep0_in_ = false, line_coding_due_ = false;
  int new_address_ = -1;
  Bytes line_coding_ = Bytes(7);
  Picoseconds frame_at_ = 0;
};

}  // namespace lamplock::sim::chip::rigs
