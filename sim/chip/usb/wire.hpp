// The USB cable between the device controller of the chip and the host end: packets and calls.
//
// In:  the host end drives: bus reset, frames, the phases of each transaction with their times.
// Out: the device end answers at once with what it will send; the host end gives it its bus time.
// Who: usb_host/ calls DeviceEnd; the controller in usb/ is one and calls HostEnd back.
//
// Packets are whole: bits, bit stuffing and line codes are not simulated; faults are given by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "sim/world/time.hpp"

namespace lamplock::sim::chip::usb {

/// Packet identifiers that are used here (USB 2.0, table 8-1).
enum class Pid : std::uint8_t { out, in, setup, data0, data1, ack, nak, stall };

/// Effect of the wire on a packet.
enum class Fault : std::uint8_t {
  none,
  lost,       ///< never arrives
  crc,        ///< arrives whole, checksum wrong
  bit_stuff,  ///< breaks off in a bit stuffing error, as when a hub ends it at the end of a frame
};

/// Largest packet of control, bulk and interrupt endpoints at full speed (USB 2.0, 5.5.3, 5.8.3).
inline constexpr std::size_t max_packet = 64;

/// Payload of a data packet, or a bare handshake.
struct Packet {
  Pid pid = Pid::data0;
  std::array<std::uint8_t, max_packet> bytes{};
  std::size_t size = 0;

  std::span<const std::uint8_t> payload() const { return std::span(bytes).first(size); }
};

/// Bit times at full speed, 12 Mbit/s (USB 2.0, 7.1.11), as time; rounded down.
constexpr Picoseconds bit_times(std::int64_t bits) { return bits * 250'000 / 3; }

/// The host end, as the device end calls it.
class HostEnd {
 public:
  virtual ~HostEnd() = default;
  /// The pull-up of D+ has been switched on or off.
  virtual void pull_up_changed(bool on, Picoseconds at) = 0;
  /// The device drives resume signalling (remote wake-up; USB 2.0, 7.1.7.7).
  virtual void remote_wakeup(Picoseconds at) = 0;
};

/// The device end, as the host end calls it. Times never decrease.
class DeviceEnd {
 public:
  virtual ~DeviceEnd() = default;
  /// Connects a host (nullptr: disconnects). It must outlive the connection.
  virtual void connect(HostEnd* host, Picoseconds at) = 0;
  /// True if D+ is pulled up.
  virtual bool pull_up() const = 0;

  virtual void begin_reset(Picoseconds at) = 0;
  virtual void end_reset(Picoseconds at) = 0;
  /// Resume signalling (K) begins; it ends with the next frame.
  virtual void begin_resume(Picoseconds at) = 0;
  virtual void end_resume(Picoseconds at) = 0;
  virtual void start_of_frame(std::uint16_t number, Picoseconds at) = 0;
  /// A packet of another device passes.
  virtual void other_traffic(Picoseconds at) = 0;

  /// End of an IN token; returns what the device sends, empty if it is silent.
  virtual std::optional<Packet> in(std::uint8_t address, std::uint8_t endpoint, Picoseconds at) = 0;
  /// After a data packet of the device: the host's ACK (or a damaged one) has arrived,
  /// or the time for it has passed.
  virtual void in_end(bool ack, Fault fault, Picoseconds at) = 0;

  /// End of an OUT or SETUP token.
  virtual void out(std::uint8_t address, std::uint8_t endpoint, bool setup, Picoseconds at) = 0;
  /// End of the data packet after it; returns the device's handshake, empty if it is silent.
  virtual std::optional<Pid> out_data(const Packet& packet, Fault fault, Picoseconds at) = 0;
  /// End of that handshake.
  virtual void out_end(Picoseconds at) = 0;
};

}  // namespace lamplock::sim::chip::usb
