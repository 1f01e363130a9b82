// Runs one USB transaction at a time on the cable: tokens, data, handshakes, each with its time on
// the bus, and with faults on request.
//
// In:  a transaction and when it may begin.
// Out: its result and when the bus is free again.
// Who: UsbHost; tests of single transactions use it directly (raw mode).
//
// Bus time of a packet: sync, PID, payload, checksum, and 8 bit times for end of packet and gap:
// 13 bytes beyond the payload in a transaction, as USB 2.0, table 5-9 counts. Bit stuffing, which
// may lengthen a payload by up to a sixth, is neglected.
#pragma once

#include <functional>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/usb/wire.hpp"

namespace lamplock::sim::chip::usb {

inline constexpr std::int64_t token_bits = 32;
inline constexpr std::int64_t handshake_bits = 16;
inline constexpr std::int64_t gap_bits = 8;
/// Time-out for a missing packet (USB 2.0, 7.1.19: 16 to 18 bit times).
inline constexpr std::int64_t timeout_bits = 18;
constexpr std::int64_t data_bits(std::size_t bytes) {
  return 32 + 8 * static_cast<std::int64_t>(bytes);
}
/// A whole transaction with a payload: 19 of 64 bytes fit into a frame.
constexpr std::int64_t transaction_bits(std::size_t bytes) {
  return token_bits + data_bits(bytes) + handshake_bits + 3 * gap_bits;
}

struct Transaction {
  Pid token = Pid::in;  ///< in, out or setup
  std::uint8_t address = 0;
  std::uint8_t endpoint = 0;
  Packet data;  ///< of OUT and SETUP
  Fault token_fault = Fault::none;
  Fault data_fault = Fault::none;
  Fault handshake_fault = Fault::none;
};

/// Result of a transaction, as the host sees it.
struct Result {
  /// Pid::ack (OUT, SETUP), data0 or data1 (IN), nak, stall; empty on silence or a broken packet.
  std::optional<Pid> answer;
  Packet data;          ///< of IN
  Picoseconds end = 0;  ///< the bus is free again
};

/// One transaction at a time.
class TransactionEngine final : public Timed {
 public:
  using Handler = std::function<void(const Transaction&, const Result&)>;

  TransactionEngine(TimeWheel& wheel, DeviceEnd& device);
  TransactionEngine(const TransactionEngine&) = delete;
  TransactionEngine& operator=(const TransactionEngine&) = delete;

  /// Called once per transaction, possibly slightly before result.end; may start the next one.
  void on_done(Handler handler) { handler_ = std::move(handler); }
  /// Begins at `at`; the engine is not busy.
  void start(const Transaction& transaction, Picoseconds at);
  bool busy() const { return stage_ != Stage::idle; }
  /// Drops the present transaction, without a result.
  void abandon();

  void run(Cycle to) override;
  void clock_changed() override { plan(); }

 private:
  enum class Stage : std::uint8_t { idle, token, in_handshake, out_data, out_handshake };
  void plan();
  void next(Stage stage, Picoseconds due);
  void finish(std::optional<Pid> answer, Picoseconds end);
  void after_in_token();
  void after_in_data(const Packet& sent);
  void after_out_token();
  void after_out_data();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  DeviceEnd& device_;
  Handler handler_;
  Transaction transaction_;
  Result result_;
  std::optional<Pid> handshake_;
  Stage stage_ = Stage::idle;
  Picoseconds due_ = 0;
};

}  // namespace lamplock::sim::chip::usb
