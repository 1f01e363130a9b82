// Bulk endpoints: bytes in one direction each, through two alternating buffers.
//
// In:  BulkOut: packets of the host. BulkIn: bytes of a SendRing.
// Out: BulkOut: packets to a taker (ReceiveRing, UsbSerial). BulkIn: packets to the host.
// Who: UsbSerial, in the USB interrupt; some 350 to 720 cycles a packet of 64 bytes (counted by
//      instruction), against 6000 that one takes on the bus.
//
// The controller uses the two buffers of an endpoint strictly in turn (RP2040 datasheet,
// 4.1.2.6.2); so does this code, by its own count, and reads the buffer control words instead of
// BUFF_CPU_SHOULD_HANDLE: BUFF_STATUS may be visible before the word is written back, and both
// buffers may be done at once. Every half is written by 16-bit stores, since the controller writes
// the other one.
//
// Errata. E2 (B0, B1: EP_ABORT is never done): EP_ABORT is not used; buffers are taken back by
// plain stores only while the host does not use the endpoint (reset, configuration, halt). E15
// (late IN tokens hang the controller, all revisions): BulkIn calls `permitted` before each packet.
// E3, E4 concern the host mode.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/base/byte_rings.hpp"
#include "firmware/boards/rp2040/registers/usb.hpp"
#include "firmware/boards/rp2040/usb/control_pipe.hpp"
#include "firmware/boards/rp2040/usb/descriptors.hpp"

namespace lamplock::rp2040::usb {

/// Offsets of the buffers in the DPRAM. A double buffer is 2 x 64 bytes in a row.
inline constexpr std::uint32_t out_buffer_offset = 0x180;
inline constexpr std::uint32_t in_buffer_offset = 0x200;
inline constexpr std::uint32_t notify_buffer_offset = 0x280;
inline constexpr std::uint32_t stream_out_buffer_offset = 0x2C0;
inline constexpr std::uint32_t stream_in_buffer_offset = 0x340;
static_assert(out_buffer_offset == offsetof(UsbDpram, data));

/// An endpoint and the offset of its double buffer.
struct BulkPlace {
  std::uint8_t endpoint = 0;
  std::uint16_t buffer_offset = 0;
};
inline constexpr BulkPlace serial_out_place{data_endpoint, out_buffer_offset};
inline constexpr BulkPlace serial_in_place{data_endpoint, in_buffer_offset};
inline constexpr BulkPlace stream_out_place{stream_endpoint, stream_out_buffer_offset};
inline constexpr BulkPlace stream_in_place{stream_endpoint, stream_in_buffer_offset};

/// Words of a double buffer: 16 of buffer 0, 16 of buffer 1.
inline volatile std::uint32_t* buffer_words(UsbDpram& dpram, BulkPlace place) {
  return &dpram.data[(place.buffer_offset - offsetof(UsbDpram, data)) / 4];
}
inline constexpr std::uint32_t words_per_packet = packet_size / 4;

inline constexpr std::uint32_t double_bulk_control =
    usb_field::endpoint_enable | usb_field::endpoint_double | usb_field::endpoint_each_buffer |
    usb_field::endpoint_bulk;

/// Flag for arming the next buffer in turn. The controller may have missed an earlier command to
/// start at buffer 0, so the flag is repeated.
constexpr std::uint32_t select_flag(std::uint32_t half) {
  return half == 0 ? std::uint32_t{usb_field::buffer_reset_select} : 0u;
}

/// What to do with a received packet.
enum class PacketLook : std::uint8_t {
  take,
  begins_anew,  ///< take it; the previous packet is void
  drop
};

/// From the host.
template <class Hardware>
class BulkOut {
 public:
  BulkOut(Hardware& hardware, BulkPlace place)
      : hardware_(hardware),
        halves_(hardware.dpram().buffer_control[place.endpoint].out),
        words_(buffer_words(hardware.dpram(), place)),
        place_(place) {}

  /// Accepts packets from now on; the first is DATA0.
  void start() {
    stop();
    next_ = 0;
    data1_ = false;
    halted_ = false;
    control() = double_bulk_control | place_.buffer_offset;
    arm(0, usb_field::buffer_reset_select);
    arm(1, 0);
  }

  void stop() {
    control() = 0;
    halves_[0] = 0;
    halves_[1] = 0;
    halted_ = true;
  }

  /// A packet waits that the host regards as delivered.
  bool keeps_packet() const {
    return (looked_at_[0] && !void_[0] && is_done(halves_[0])) ||
           (looked_at_[1] && !void_[1] && is_done(halves_[1]));
  }
  /// A packet may be there for `service`.
  bool filled() const { return ((halves_[0] | halves_[1]) & usb_field::buffer_full) != 0; }

  /// Passes received packets to `taker`, and the buffers back as soon as it has taken them:
  ///   PacketLook inspect(words, size)   once for each packet when it has been received
  ///   bool push_packet(words, size)  false: the packet waits in its buffer, and so does the host
  template <class Taker>
  void service(Taker&& taker) {
    if (halted_) return;
    // At most both: more need a new interrupt.
    for (int packets = 0; packets < 2; ++packets) {
      // Read in this order: if the later one is done, so is the earlier one, unless this count
      // and the controller's differ; then the one that is done is the next.
      const bool other_done = is_done(halves_[next_ ^ 1]);
      bool another_follows = other_done;
      if (!is_done(halves_[next_])) {
        if (!other_done) return;
        next_ ^= 1;
        ++resynchronised_;
        another_follows = false;
      }
      inspect(next_, taker);
      if (another_follows) inspect(next_ ^ 1, taker);
      const std::uint32_t size = size_of(next_);
      if (size != 0 && !void_[next_] && !taker.push_packet(words_of(next_), size)) return;
      arm(next_, 0);
      next_ ^= 1;
      ++packets_;
    }
  }

  void halt() {
    halted_ = true;
    halves_[1] = 0;
    give_buffer(hardware_, halves_[0], 0, usb_field::buffer_stall);
  }

  /// Begins again with DATA0, in the next buffer in turn.
  void restart() {
    halves_[0] = 0;
    halves_[1] = 0;
    halted_ = false;
    data1_ = false;
    arm(next_, select_flag(next_));
    arm(next_ ^ 1, 0);
  }

  std::uint32_t packets() const { return packets_; }
  std::uint32_t resynchronised() const { return resynchronised_; }

 private:
  static bool is_done(std::uint32_t value) {
    return (value & (usb_field::buffer_full | usb_field::buffer_available)) ==
           usb_field::buffer_full;
  }
  Register& control() { return hardware_.dpram().endpoint_control[place_.endpoint - 1].out; }

  volatile std::uint32_t* words_of(std::uint32_t half) { return words_ + half * words_per_packet; }
  std::uint32_t size_of(std::uint32_t half) const {
    return std::min<std::uint32_t>(halves_[half] & usb_field::buffer_length, packet_size);
  }

  /// Once for each packet, in their order; the second one may arrive while the first one waits.
  template <class Taker>
  void inspect(std::uint32_t half, Taker&& taker) {
    if (looked_at_[half]) return;
    looked_at_[half] = true;
    if (size_of(half) == 0) return;
    const PacketLook look = taker.inspect(words_of(half), size_of(half));
    void_[half] = look == PacketLook::drop;
    if (look == PacketLook::begins_anew && half != next_) void_[next_] = true;
  }

  void arm(std::uint32_t half, std::uint32_t flags) {
    looked_at_[half] = void_[half] = false;
    const std::uint32_t pid = data1_ ? usb_field::buffer_data1 : 0u;
    data1_ = !data1_;
    give_buffer(hardware_, halves_[half], packet_size | pid | flags, usb_field::buffer_available);
  }

  Hardware& hardware_;
  BufferHalf* const halves_;
  volatile std::uint32_t* const words_;
  const BulkPlace place_;
  std::uint32_t next_ = 0;  ///< buffer of the next packet
  std::uint32_t packets_ = 0;
  std::uint32_t resynchronised_ = 0;
  bool data1_ = false;  ///< of the buffer armed next
  bool halted_ = true;
  bool looked_at_[2] = {};
  bool void_[2] = {};  ///< not heard, or a reset or another host came later
};

/// To the host.
template <class Hardware>
class BulkIn {
 public:
  BulkIn(Hardware& hardware, BulkPlace place)
      : hardware_(hardware),
        halves_(hardware.dpram().buffer_control[place.endpoint].in),
        words_(buffer_words(hardware.dpram(), place)),
        place_(place) {}

  /// Sends from now on; the first packet is DATA0.
  void start() {
    stop();
    data1_ = false;
    halted_ = false;
    empty_packet_due_ = false;
    control() = double_bulk_control | place_.buffer_offset;
  }

  void stop() {
    control() = 0;
    halves_[0] = 0;
    halves_[1] = 0;
    first_ = 0;
    armed_ = 0;
    halted_ = true;
  }

  /// `service` has work to do.
  template <class Ring>
  bool busy(const Ring& ring) const {
    return armed_ != 0 || empty_packet_due_ || ring.size() != 0;
  }

  /// Collects buffers that have been sent and fills them again while `permitted()`.
  template <class Ring, class Permission>
  void service(Ring& ring, Permission&& permitted) {
    if (halted_) return;
    while (armed_ != 0 && (halves_[first_] & usb_field::buffer_available) == 0) {
      first_ ^= 1;
      --armed_;
      ++packets_;
    }
    while (armed_ < 2) {
      const std::uint32_t size = std::min<std::uint32_t>(ring.size(), packet_size);
      if ((size == 0 && !empty_packet_due_) || !permitted()) return;
      // After a pause both ends start at buffer 0, whatever happened before.
      std::uint32_t flags = 0;
      if (armed_ == 0) {
        first_ = 0;
        flags = usb_field::buffer_reset_select;
      }
      const std::uint32_t half = first_ ^ armed_;
      if (size != 0) ring.pop_packet(words_ + half * words_per_packet, size);
      // After a full packet the host expects more: an empty one ends the transfer.
      empty_packet_due_ = size == packet_size;
      sizes_[half] = static_cast<std::uint8_t>(size);
      ++armed_;
      arm(half, flags);
    }
  }

  void halt() {
    halted_ = true;
    halves_[1] = 0;
    give_buffer(hardware_, halves_[0], 0, usb_field::buffer_stall);
  }

  /// Begins again with DATA0; sends now what was armed and has not been fetched.
  void restart() {
    halves_[0] = 0;
    halves_[1] = 0;
    halted_ = false;
    data1_ = false;
    for (std::uint32_t i = 0; i < armed_; ++i) arm(first_ ^ i, i == 0 ? select_flag(first_) : 0u);
  }

  std::uint32_t packets() const { return packets_; }
  /// Packets handed to the controller and not yet fetched.
  std::uint32_t armed() const { return armed_; }

 private:
  Register& control() { return hardware_.dpram().endpoint_control[place_.endpoint - 1].in; }

  void arm(std::uint32_t half, std::uint32_t flags) {
    const std::uint32_t pid = data1_ ? usb_field::buffer_data1 : 0u;
    data1_ = !data1_;
    give_buffer(hardware_, halves_[half], sizes_[half] | usb_field::buffer_full | pid | flags,
                usb_field::buffer_available);
  }

  Hardware& hardware_;
  BufferHalf* const halves_;
  volatile std::uint32_t* const words_;
  const BulkPlace place_;
  std::uint32_t first_ = 0;  ///< buffer that is sent next
  std::uint32_t armed_ = 0;  ///< 0 to 2
  std::uint32_t packets_ = 0;
  std::uint8_t sizes_[2] = {};
  bool data1_ = false;  ///< of the buffer armed next
  bool empty_packet_due_ = false;
  bool halted_ = true;
};

}  // namespace lamplock::rp2040::usb
