// Endpoint 0: carries requests and their answers in packets.
//
// In:  events of the controller (SETUP received, a buffer of endpoint 0 done) through `Hardware`.
// Out: packets, STALLs; a Reaction's effect for the other endpoints; the new address.
// Who: UsbSerial, in the USB interrupt. 350 to 1300 cycles an event (counted by instruction); only
//      for requests of the host, a few dozen times in the life of a connection.
//
// Every SETUP starts again from idle (USB 2.0, 8.5.3), so the pipe cannot get stuck. A data stage
// to the host ends with a packet shorter than 64 bytes, if necessary an empty one, but never
// exceeds the requested length (5.5.3). The empty packet of the status stage is expected from the
// first data packet on: when the host's last ACK is lost it continues to the status stage by itself
// (8.5.3.3).
//
// Known limit of the controller: a buffer left over from a request that the host abandoned stays
// armed until this code handles the next SETUP; the two stores are a few microseconds later.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/boards/rp2040/registers/usb.hpp"
#include "firmware/boards/rp2040/usb/control_requests.hpp"

namespace lamplock::rp2040::usb {

/// Hands one buffer to the controller: AVAILABLE (or STALL) is a separate store, at least one clock
/// of the USB side after the rest (datasheet, 4.1.2.5.1).
template <class Hardware>
void give_buffer(Hardware& hardware, BufferHalf& half, std::uint32_t value, std::uint32_t last) {
  half = static_cast<std::uint16_t>(value);
  hardware.settle();
  half = static_cast<std::uint16_t>(value | last);
}

/// Endpoint 0. `Requests` is ControlRequests or a test's.
template <class Hardware, class Requests = ControlRequests>
class ControlPipe {
 public:
  ControlPipe(Hardware& hardware, Requests& requests) : hardware_(hardware), requests_(requests) {}

  /// After a bus reset, and at the start.
  void reset() {
    disarm();
    stage_ = Stage::idle;
  }

  /// A SETUP packet was received. `apply(reaction)` changes the other endpoints before the host can
  /// see the answer. Returns that answer.
  template <class Apply>
  Answer on_setup(Apply&& apply) {
    disarm();
    SetupPacket setup;
    // If a SETUP arrives while the last is being read, the newer one counts.
    for (int tries = 0; tries < 3; ++tries) {
      hardware_.clear_status(usb_field::status_setup);
      setup = SetupPacket::from_words(hardware_.dpram().setup[0], hardware_.dpram().setup[1]);
      if ((hardware_.status() & usb_field::status_setup) == 0) break;
    }
    const Reaction reaction = requests_.setup(setup);
    use_address_ = reaction.effect == Effect::use_address;
    apply(reaction);
    begin(setup, reaction);
    return reaction.answer;
  }

  /// The IN buffer was sent.
  void on_in_done() {
    if (stage_ == Stage::send) {
      send_next();
    } else if (stage_ == Stage::status_in) {
      if (use_address_) hardware_.set_address(requests_.address());
      use_address_ = false;
      stage_ = Stage::idle;
    }
  }

  /// The OUT buffer has been filled.
  void on_out_done() {
    if (stage_ == Stage::send) {  // status stage, early or in time
      buffers().in[0] = 0;
      stage_ = Stage::idle;
    } else if (stage_ == Stage::receive) {
      take_data();
    }
  }

 private:
  enum class Stage : std::uint8_t { idle, send, receive, status_in };

  UsbDpram::BufferControl& buffers() { return hardware_.dpram().buffer_control[0]; }
  static constexpr std::uint32_t both_buffers_done = 3;  ///< BUFF_STATUS of endpoint 0

  void disarm() {
    buffers().in[0] = 0;
    buffers().out[0] = 0;
    hardware_.clear_done(both_buffers_done);
  }

  void begin(const SetupPacket& setup, const Reaction& reaction) {
    switch (reaction.answer) {
      case Answer::acknowledge:
        // A request with unexpected data is malformed.
        return setup.length == 0 ? send_status() : refuse();
      case Answer::receive:
        stage_ = Stage::receive;
        return expect();
      case Answer::send:
        if (setup.length == 0) return send_status();
        data_ = reaction.data.first(std::min<std::size_t>(reaction.data.size(), setup.length));
        // Less than requested, in whole packets: an empty one marks the end.
        empty_packet_due_ = data_.size() < setup.length && data_.size() % packet_size == 0;
        data1_ = true;
        stage_ = Stage::send;
        expect();
        return send_next();
      case Answer::stall:
        return refuse();
    }
  }

  void send_next() {
    if (data_.empty() && !empty_packet_due_) return;  // only the status stage is left
    const std::size_t size = std::min<std::size_t>(data_.size(), packet_size);
    if (size == 0) empty_packet_due_ = false;
    volatile std::uint32_t* words = hardware_.dpram().control_buffer[0];
    for (std::size_t i = 0; i < size; i += 4) words[i / 4] = word_at(i, size);
    data_ = data_.subspan(size);
    const std::uint32_t pid = data1_ ? usb_field::buffer_data1 : 0u;
    data1_ = !data1_;
    give_buffer(hardware_, buffers().in[0],
                static_cast<std::uint32_t>(size) | usb_field::buffer_full | pid,
                usb_field::buffer_available);
  }

  std::uint32_t word_at(std::size_t at, std::size_t size) const {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4 && at + i < size; ++i)
      word |= static_cast<std::uint32_t>(data_[at + i]) << (8 * i);
    return word;
  }

  void take_data() {
    const std::uint32_t value = buffers().out[0];
    const std::size_t size = std::min<std::size_t>(value & usb_field::buffer_length, packet_size);
    std::array<std::uint8_t, packet_size> data;
    for (std::size_t i = 0; i < size; ++i)
      data[i] =
          static_cast<std::uint8_t>(hardware_.dpram().control_buffer[0][i / 4] >> (8 * (i % 4)));
    if (requests_.received(std::span<const std::uint8_t>(data).first(size))) return send_status();
    refuse();
  }

  /// Accepts data, or the empty packet of the status stage.
  void expect() {
    give_buffer(hardware_, buffers().out[0], packet_size | std::uint32_t{usb_field::buffer_data1},
                usb_field::buffer_available);
  }

  /// Status stage of a request without data to the host.
  void send_status() {
    stage_ = Stage::status_in;
    give_buffer(hardware_, buffers().in[0],
                std::uint32_t{usb_field::buffer_full} | usb_field::buffer_data1,
                usb_field::buffer_available);
  }

  /// STALL in both directions until the next SETUP, which clears the controller's gate
  /// (EP_STALL_ARM).
  void refuse() {
    stage_ = Stage::idle;
    use_address_ = false;
    hardware_.arm_stall();
    give_buffer(hardware_, buffers().in[0], 0, usb_field::buffer_stall);
    give_buffer(hardware_, buffers().out[0], 0, usb_field::buffer_stall);
  }

  Hardware& hardware_;
  Requests& requests_;
  std::span<const std::uint8_t> data_{};  ///< not yet handed over
  Stage stage_ = Stage::idle;
  bool data1_ = true;
  bool empty_packet_due_ = false;
  bool use_address_ = false;
};

}  // namespace lamplock::rp2040::usb
