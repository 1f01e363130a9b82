// One of the two pairs of bulk endpoints that the PC uses: its queues and state.
//
// In/out: bytes of a program, packets. Who: UsbHost, which has one for the serial port's driver and
// one for a program that has claimed the vendor interface.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "sim/chip/usb/wire.hpp"
#include "sim/chip/usb_host/descriptors.hpp"

namespace lamplock::sim::chip::usb {

/// Queues and data toggles.
struct BulkFunction {
  BulkEndpoints ends;
  bool open = false;  ///< opened by a program: packets are requested
  std::deque<std::uint8_t> to_send, received;
  std::vector<std::uint8_t> transfer;
  std::optional<Packet> packet;  ///< OUT, until acknowledged
  bool zero_length_due = false;
  bool in_data1 = false, out_data1 = false;
  Picoseconds refused_since = -1;

  /// Bytes that were written and that the device has not acknowledged.
  std::size_t unsent() const { return to_send.size() + (packet ? packet->size : 0); }
  bool has_packet() const { return packet || !to_send.empty() || zero_length_due; }
  /// Bytes of the packet to be sent next.
  std::size_t next_size() const {
    return packet ? packet->size : std::min<std::size_t>(to_send.size(), ends.out_size);
  }

  /// Drops data under way and the endpoints read from the device.
  void clear() {
    const bool was_open = open;
    *this = {};
    open = was_open;
  }
  void clear_toggles() { in_data1 = out_data1 = false; }

  /// Takes at most `room` bytes; returns how many were taken.
  std::size_t write(std::span<const std::uint8_t> bytes, std::size_t room) {
    const std::size_t count = std::min(room, bytes.size());
    to_send.insert(to_send.end(), bytes.begin(),
                   bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  std::size_t read(std::span<std::uint8_t> bytes) {
    const std::size_t count = std::min(bytes.size(), received.size());
    std::copy_n(received.begin(), count, bytes.begin());
    received.erase(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

  /// The packet to be sent, made if there is none. `zero_length`: a full one is followed by an
  /// empty one.
  const Packet& next_packet(bool zero_length) {
    if (packet) return *packet;
    packet.emplace();
    packet->size = std::min<std::size_t>(to_send.size(), ends.out_size);
    std::copy_n(to_send.begin(), packet->size, packet->bytes.begin());
    to_send.erase(to_send.begin(), to_send.begin() + static_cast<std::ptrdiff_t>(packet->size));
    packet->pid = out_data1 ? Pid::data1 : Pid::data0;
    zero_length_due = zero_length && to_send.empty() && packet->size == ends.out_size;
    return *packet;
  }

  /// A new packet has come. Delivers when a short one ends the transfer, or it has `size` bytes.
  void take(std::span<const std::uint8_t> bytes, std::size_t size) {
    transfer.insert(transfer.end(), bytes.begin(), bytes.end());
    if (bytes.size() >= ends.in_size && transfer.size() < size) return;
    received.insert(received.end(), transfer.begin(), transfer.end());
    transfer.clear();
  }
};

}  // namespace lamplock::sim::chip::usb
