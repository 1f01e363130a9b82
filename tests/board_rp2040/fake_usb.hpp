// A USB controller in memory and its host, for tests of UsbSerial.
//
// The controller follows the RP2040 datasheet on transactions in device mode (4.1.2.6): stalls
// behind their gate, buffer halves in turn, AVAILABLE and FULL, data sequence, BUFF_STATUS set
// again while the other buffer is done as well. The host keeps toggles as in USB 2.0, 8.6.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "firmware/boards/rp2040/usb/usb_serial.hpp"

namespace lamplock::test {

using Bytes = std::vector<std::uint8_t>;

/// The controller's side of a handshake.
enum class Handshake : std::uint8_t { ack, nak, stall, silence };

class FakeUsb {
 public:
  struct Lock {};

  // Functions that UsbSerial calls.

  void start() {
    std::memset(static_cast<void*>(&memory_), 0, sizeof(memory_));
    started = true;
  }
  void attach() { attached = true; }
  rp2040::UsbDpram& dpram() { return memory_; }
  std::uint32_t interrupts() const {
    std::uint32_t bits = events_;
    if (done() != 0) bits |= rp2040::usb_field::int_buffer;
    if ((sie_status & rp2040::usb_field::status_setup) != 0) bits |= rp2040::usb_field::int_setup;
    if ((sie_status & rp2040::usb_field::status_reset) != 0)
      bits |= rp2040::usb_field::int_bus_reset;
    if ((sie_status & rp2040::usb_field::status_resume) != 0) bits |= rp2040::usb_field::int_resume;
    return bits;
  }
  std::uint32_t status() const { return sie_status; }
  void clear_status(std::uint32_t bits) {
    using namespace rp2040::usb_field;
    if ((bits & status_suspended) != 0) events_ &= ~int_suspend;
    sie_status &= ~(bits & (status_setup | status_reset | status_resume | status_errors));
  }
  std::uint32_t done() const { return done_[0] | done_[1]; }
  void clear_done(std::uint32_t bits) {
    // Reports only the first of two finished buffers: the bit is set again for the second.
    for (std::uint32_t bit = 1; bit != 0; bit <<= 1) {
      if ((bits & bit) == 0) continue;
      if ((done_[0] & bit) != 0) {
        done_[0] &= ~bit;
      } else {
        done_[1] &= ~bit;
      }
    }
  }
  void acknowledge_frame() { events_ &= ~rp2040::usb_field::int_sof; }
  void set_address(std::uint8_t value) { address = value; }
  void arm_stall() { stall_armed = true; }
  std::uint32_t microseconds() const { return now_us; }
  void settle() { ++settles; }
  void pend() { pended = true; }
  bool reset_exit_needed() const { return old_chip; }
  void hold_idle_line() {
    held = true;
    ++holds;
  }
  void release_line() { held = false; }

  // Transactions of the bus.

  void bus_reset() { sie_status |= rp2040::usb_field::status_reset; }
  void start_of_frame() { events_ |= rp2040::usb_field::int_sof; }
  void suspend() {
    sie_status |= rp2040::usb_field::status_suspended;
    events_ |= rp2040::usb_field::int_suspend;
  }
  void resume() {
    sie_status &= ~rp2040::usb_field::status_suspended;
    sie_status |= rp2040::usb_field::status_resume;
    events_ |= rp2040::usb_field::int_suspend;
  }

  void setup(std::span<const std::uint8_t, 8> packet) {
    for (std::size_t i = 0; i < 2; ++i)
      memory_.setup[i] = static_cast<std::uint32_t>(packet[4 * i]) |
                         static_cast<std::uint32_t>(packet[4 * i + 1]) << 8 |
                         static_cast<std::uint32_t>(packet[4 * i + 2]) << 16 |
                         static_cast<std::uint32_t>(packet[4 * i + 3]) << 24;
    stall_armed = false;
    sie_status |= rp2040::usb_field::status_setup;
  }

  /// An IN token: data and its PID if there is any.
  Handshake in(std::uint8_t endpoint, Bytes& data, bool& data1) {
    using namespace rp2040::usb_field;
    if (endpoint != 0 && (control(endpoint, true) & endpoint_enable) == 0)
      return Handshake::silence;
    auto* halves = memory_.buffer_control[endpoint].in;
    if (stalled(endpoint, halves)) return Handshake::stall;
    const unsigned half = turn(endpoint, true, halves);
    const std::uint32_t value = halves[half];
    if ((value & buffer_available) == 0 || (value & buffer_full) == 0) return Handshake::nak;
    const std::uint32_t size = value & buffer_length;
    data = read(offset(endpoint, true) + 64 * half, size);
    data1 = (value & buffer_data1) != 0;
    finish(endpoint, true, half, halves, value & (buffer_length | buffer_data1 | buffer_last));
    return Handshake::ack;
  }

  /// An OUT transaction.
  Handshake out(std::uint8_t endpoint, bool data1, std::span<const std::uint8_t> data) {
    using namespace rp2040::usb_field;
    if (endpoint != 0 && (control(endpoint, false) & endpoint_enable) == 0)
      return Handshake::silence;
    auto* halves = memory_.buffer_control[endpoint].out;
    if (stalled(endpoint, halves)) return Handshake::stall;
    const unsigned half = turn(endpoint, false, halves);
    const std::uint32_t value = halves[half];
    if ((value & buffer_available) == 0 || (value & buffer_full) != 0) return Handshake::nak;
    if (((value & buffer_data1) != 0) != data1) {  // a repetition: acknowledged and dropped
      sie_status |= 1u << 31;
      ++sequence_errors;
      return Handshake::ack;
    }
    write(offset(endpoint, false) + 64 * half, data);
    finish(endpoint, false, half, halves,
           static_cast<std::uint32_t>(data.size()) | buffer_full | (value & buffer_data1));
    return Handshake::ack;
  }

  bool started = false;
  bool attached = false;
  bool pended = false;
  bool stall_armed = false;
  bool old_chip = false;
  bool held = false;
  int holds = 0;
  int settles = 0;
  int sequence_errors = 0;
  std::uint8_t address = 0;
  std::uint32_t sie_status = 1u << 2;  ///< line state J
  std::uint32_t now_us = 0;

 private:
  std::uint32_t control(std::uint8_t endpoint, bool to_host) const {
    const auto& both = memory_.endpoint_control[endpoint - 1];
    return to_host ? both.in : both.out;
  }
  std::uint32_t offset(std::uint8_t endpoint, bool to_host) const {
    return endpoint == 0 ? 0x100 : control(endpoint, to_host) & 0xffc0;
  }
  bool stalled(std::uint8_t endpoint, const rp2040::BufferHalf* halves) const {
    return (halves[0] & rp2040::usb_field::buffer_stall) != 0 && (endpoint != 0 || stall_armed);
  }
  bool is_double(std::uint8_t endpoint, bool to_host) const {
    return endpoint != 0 && (control(endpoint, to_host) & rp2040::usb_field::endpoint_double) != 0;
  }
  unsigned turn(std::uint8_t endpoint, bool to_host, const rp2040::BufferHalf* halves) {
    if (!is_double(endpoint, to_host)) return 0;
    unsigned& select = select_[endpoint][to_host ? 1 : 0];
    if ((halves[0] & rp2040::usb_field::buffer_reset_select) != 0) select = 0;
    return select;
  }
  void finish(std::uint8_t endpoint, bool to_host, unsigned half, rp2040::BufferHalf* halves,
              std::uint32_t value) {
    halves[half] = static_cast<std::uint16_t>(value);
    if (is_double(endpoint, to_host)) select_[endpoint][to_host ? 1 : 0] = half ^ 1;
    const std::uint32_t bit = 1u << (2 * endpoint + (to_host ? 0 : 1));
    done_[(done_[0] & bit) != 0 ? 1 : 0] |= bit;
  }
  volatile std::uint32_t* word(std::uint32_t at) {
    return at < 0x180 ? &memory_.control_buffer[0][(at - 0x100) / 4]
                      : &memory_.data[(at - 0x180) / 4];
  }
  Bytes read(std::uint32_t at, std::uint32_t size) {
    Bytes out;
    for (std::uint32_t i = 0; i < size; ++i)
      out.push_back(static_cast<std::uint8_t>(*word(at + i / 4 * 4) >> (8 * (i % 4))));
    return out;
  }
  void write(std::uint32_t at, std::span<const std::uint8_t> data) {
    for (std::uint32_t i = 0; i < data.size(); ++i) {
      const std::uint32_t shift = 8 * (i % 4);
      volatile std::uint32_t* target = word(at + i / 4 * 4);
      *target = (*target & ~(0xffu << shift)) | static_cast<std::uint32_t>(data[i]) << shift;
    }
  }

  rp2040::UsbDpram memory_{};
  std::uint32_t events_ = 0;
  std::uint32_t done_[2] = {};
  unsigned select_[16][2] = {};
};

/// A host with one device.
class UsbHost {
 public:
  struct Result {
    Handshake handshake = Handshake::silence;
    Bytes data;
  };

  UsbHost() { serial.start(); }

  /// Runs the device's interrupt handler until no interrupt is pending.
  void serve() {
    for (int i = 0; i < 20; ++i) {
      if (usb.interrupts() == 0 && !usb.pended) return;
      usb.pended = false;
      serial.interrupt();
    }
    ADD_FAILURE() << "the interrupt never ends";
  }

  void reset() {
    usb.bus_reset();
    serve();
  }
  /// Advances time to this offset in the next frame.
  void frame(std::uint32_t offset_us = 0) {
    usb.now_us = usb.now_us / 1000 * 1000 + 1000;
    usb.start_of_frame();
    serve();
    usb.now_us += offset_us;
  }

  static std::array<std::uint8_t, 8> packet(std::uint8_t type, std::uint8_t request,
                                            std::uint16_t value, std::uint16_t index,
                                            std::uint16_t length) {
    const auto low = [](std::uint16_t v) { return static_cast<std::uint8_t>(v & 0xff); };
    const auto high = [](std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); };
    return {type,       request,     low(value),  high(value),
            low(index), high(index), low(length), high(length)};
  }

  /// A whole control transfer as in USB 2.0, 8.5.3.
  Result control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                 std::uint16_t length, const Bytes& out = {}) {
    usb.setup(packet(type, request, value, index, length));
    serve();
    if (length != 0 && (type & 0x80) != 0) return control_read(length);
    bool data1 = true;
    for (std::size_t at = 0; at < out.size(); at += 64) {
      const std::size_t size = std::min<std::size_t>(64, out.size() - at);
      const Handshake answer = usb.out(0, data1, std::span(out).subspan(at, size));
      if (answer != Handshake::ack) return {answer, {}};
      serve();
      data1 = !data1;
    }
    Bytes data;
    const Handshake answer = usb.in(0, data, data1);
    serve();
    if (answer == Handshake::ack) {
      EXPECT_TRUE(data1) << "status stage is DATA1";
      EXPECT_TRUE(data.empty());
    }
    return {answer, {}};
  }

  bool enumerate() {
    reset();
    if (control(0x80, 6, 0x0100, 0, 64).handshake != Handshake::ack) return false;
    if (control(0x00, 5, 7, 0, 0).handshake != Handshake::ack) return false;
    const bool good = control(0x00, 9, 1, 0, 0).handshake == Handshake::ack;
    clear_toggles();
    return good;
  }
  void clear_toggles() {
    toggle_out_ = {};
    toggle_in_ = {};
  }

  Handshake bulk_out(std::span<const std::uint8_t> data, bool serve_now = true) {
    bool& toggle = toggle_out_[endpoint];
    const Handshake answer = usb.out(endpoint, toggle, data);
    if (answer == Handshake::ack) toggle = !toggle;
    if (serve_now) serve();
    return answer;
  }
  /// One IN transaction; a repeated packet (wrong toggle) is a failure.
  Result bulk_in(bool serve_now = true) {
    Result result;
    bool data1 = false;
    bool& toggle = toggle_in_[endpoint];
    result.handshake = usb.in(endpoint, result.data, data1);
    if (result.handshake == Handshake::ack) {
      EXPECT_EQ(data1, toggle);
      toggle = !toggle;
    }
    if (serve_now) serve();
    return result;
  }

  FakeUsb usb;
  rp2040::BasicUsbSerial<FakeUsb> serial{usb};
  Bytes commands;  ///< one-byte commands read beside other bytes
  /// Of bulk transfers: 2, the serial port; 3, the pulse stream.
  std::uint8_t endpoint = 2;

 private:
  Result control_read(std::uint16_t length) {
    Result result{Handshake::ack, {}};
    bool expected = true;
    for (;;) {
      Bytes data;
      bool data1 = false;
      const Handshake answer = usb.in(0, data, data1);
      if (answer != Handshake::ack) return {answer, result.data};
      serve();
      EXPECT_EQ(data1, expected);
      expected = !expected;
      result.data.insert(result.data.end(), data.begin(), data.end());
      EXPECT_LE(result.data.size(), length);
      if (data.size() < 64 || result.data.size() >= length) break;
    }
    result.handshake = usb.out(0, true, {});
    serve();
    return result;
  }

  std::array<bool, 16> toggle_out_{};
  std::array<bool, 16> toggle_in_{};
};

/// `size` letters, beginning with the `first`.
inline Bytes numbered(std::size_t size, unsigned first = 0) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>('A' + (first + i) % 26);
  return out;
}

/// All bytes that the device has received.
inline Bytes read_all(UsbHost& host, std::size_t piece = 64) {
  Bytes out;
  Bytes buffer(piece);
  std::uint8_t command = 0;
  while (host.serial.available() != 0) {
    while (host.serial.read_realtime(command)) host.commands.push_back(command);
    const std::size_t count = host.serial.read(buffer);
    out.insert(out.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return out;
}

}  // namespace lamplock::test
