// The link on USB: bytes in both directions, over the serial port or over the pulse stream's
// endpoints.
//
// In:  the USB interrupt (priority 2); `read`, `write`, `poll` from the main loop, at least every
//      millisecond. Out: bytes.
// Budget: counted by instruction, without entry and waits of the bus: a packet of 64 bytes from the
//      host 510 to 610 cycles, to the host 700 to 880, both at once 1500, a start of frame 170 (one
//      each millisecond), a request on endpoint 0 500 to 1450, a dropped packet 1900. The choice of
//      the function adds some 60 to a packet from the host, and some 20 for each real-time byte at
//      its end (estimated).
//
// Only `interrupt` accesses the controller; the main loop uses the rings and pends the interrupt
// when there is new data to send, or room for packets that wait. Real-time bytes of the host are
// handled when their packet arrives; its other bytes wait in the buffer while the ring has no room
// (byte_rings.hpp), and the host with its next packets (NAK). A new configuration or bus reset
// empties both rings and counts `generation`, and so does a change of the function. One function is
// heard at a time (listener.hpp): there is one pair of rings, and packets of the other one are
// dropped unread, some 100 cycles each. The parts are in control_requests.hpp, control_pipe.hpp,
// bulk_pipes.hpp, bus_reset_exit.hpp.
//
// Erratum E15: no bulk IN packet is handed over in the last 200 us of a frame, which is timed from
// the start of frame by the microsecond timer. A packet handed over earlier stays: taking it back
// needs EP_ABORT, which E2 forbids, and a host that is reading has fetched it by then.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/boards/rp2040/base/byte_rings.hpp"
#include "firmware/boards/rp2040/registers/usb.hpp"
#include "firmware/boards/rp2040/usb/bulk_pipes.hpp"
#include "firmware/boards/rp2040/usb/bus_reset_exit.hpp"
#include "firmware/boards/rp2040/usb/control_pipe.hpp"
#include "firmware/boards/rp2040/usb/control_requests.hpp"
#include "firmware/boards/rp2040/usb/listener.hpp"

namespace lamplock::rp2040 {

/// Erratum E15: whether a time since the last start of frame is in the last 200 us of a frame. Up
/// to two starts of frame may have been lost; after that there are no frames (the bus is about to
/// be suspended, or is a simulated one without frames).
constexpr bool late_in_frame(std::uint32_t since_frame_us) {
  constexpr std::uint32_t frame_us = 1000;
  constexpr std::uint32_t late_us = 800;
  if (since_frame_us >= 3 * frame_us) return false;
  if (since_frame_us >= 2 * frame_us) return since_frame_us >= 2 * frame_us + late_us;
  if (since_frame_us >= frame_us) return since_frame_us >= frame_us + late_us;
  return since_frame_us >= late_us;
}

/// Events on the bus.
struct UsbCounters {
  std::uint32_t bus_resets = 0;
  std::uint32_t suspends = 0;
  std::uint32_t requests = 0;          ///< SETUP packets
  std::uint32_t refused_requests = 0;  ///< answered by STALL
  std::uint32_t bus_errors = 0;        ///< frames with an error detected by the controller
  std::uint32_t packets_received = 0;
  std::uint32_t packets_sent = 0;
  /// should be 0: mismatch with the controller about the next buffer
  std::uint32_t resynchronised = 0;
  std::uint32_t packets_unheard = 0;  ///< of the function that is not heard
};

/// The port. `Hardware` is UsbHardware (usb_hardware.hpp) or a test's.
template <class Hardware>
class BasicUsbSerial {
 public:
  static constexpr std::uint32_t receive_capacity = 4096;
  static constexpr std::uint32_t send_capacity = 2048;

  [[gnu::cold]] explicit BasicUsbSerial(Hardware& hardware) : hardware_(hardware) {}
  BasicUsbSerial(const BasicUsbSerial&) = delete;
  BasicUsbSerial& operator=(const BasicUsbSerial&) = delete;

  /// 16 characters; before `start`.
  void set_serial_number(std::string_view text) { requests_.set_serial_number(text); }

  /// Attaches to the bus. clk_usb runs at 48 MHz; the interrupt may be enabled before or after.
  void start() {
    requests_.reset();
    hardware_.start();
    control_.reset();
    stop_pipes();
    // No start of frame yet.
    frame_us_ = hardware_.microseconds() - 3000;
    hardware_.attach();
  }

  /// USBCTRL_IRQ.
  void interrupt() {
    const std::uint32_t why = hardware_.interrupts();
    if ((why & usb_field::int_bus_reset) != 0) on_bus_reset();
    if ((why & usb_field::int_sof) != 0) on_frame();
    if ((why & (usb_field::int_suspend | usb_field::int_resume)) != 0) on_suspend(why);
    if ((why & usb_field::int_buffer) != 0) on_buffers();
    if ((why & usb_field::int_setup) != 0) on_setup();
    // For every reason: a packet may be done before BUFF_STATUS shows it, or be waiting.
    for (const usb::Function function : {usb::Function::serial, usb::Function::stream})
      if (out_[usb::index(function)].filled()) take_packets(function);
    auto& in = in_[usb::index(listener_.heard())];
    if (in.busy(to_send_))
      in.service(to_send_, [this] { return !late_in_frame(hardware_.microseconds() - frame_us_); });
  }

  /// Main loop, at least every millisecond.
  void poll() {
    reset_exit_.poll(counters_.bus_resets);
    if (to_send_.size() != 0 || (packets_wait_ && received_.has_room())) hardware_.pend();
  }

  /// A job is unfinished: the heard function does not change while its host lives.
  void set_tied(bool tied) { tied_ = tied; }
  usb::Function heard() const { return listener_.heard(); }

  /// Removes the oldest command of one byte; false if there is none.
  bool read_realtime(std::uint8_t& byte) { return received_.pop_realtime(byte); }
  bool realtime_waits() const { return received_.realtime_waits(); }
  /// Removes received bytes; returns how many.
  std::size_t read(std::span<std::uint8_t> out) { return received_.pop(out); }
  /// The bytes of the last read() were received before a byte that ends jogs (0x85, `!`, 0x84).
  bool before_jog_cancel() const { return received_.before_jog_cancel(); }
  /// Received bytes that wait.
  std::size_t available() const { return received_.size(); }

  /// Queues bytes to send; returns how many were accepted, all if `room()` allows. None while not
  /// configured.
  std::size_t write(std::span<const std::uint8_t> in) {
    if (!configured() || in.empty()) return 0;
    const std::uint32_t generation = generation_;
    const std::uint32_t count = to_send_.place(in);
    {
      [[maybe_unused]] const typename Hardware::Lock lock;
      // If their host has gone meanwhile, the bytes are dropped.
      if (generation == generation_) to_send_.publish(count);
    }
    hardware_.pend();
    return count;
  }
  std::size_t room() const { return configured() ? to_send_.room() : 0; }

  bool configured() const { return configured_; }
  /// No host, or a sleeping one; on a Pico an unplugged cable looks the same.
  bool suspended() const { return suspended_; }
  /// Changes with each new connection.
  std::uint32_t generation() const { return generation_; }
  /// A host is present, awake, and has not closed the port: a program that opens a serial port
  /// usually raises DTR, and the system lowers it when the program ends. The stream has no such
  /// sign.
  bool present() const {
    if (!configured_ || suspended_) return false;
    const bool closed = requests_.opened() != 0 && !requests_.dtr();
    return heard() == usb::Function::stream || !closed;
  }
  /// A program has the port open, according to DTR.
  bool dtr() const { return requests_.dtr(); }
  /// How many times a program has opened the port.
  std::uint32_t opened() const { return requests_.opened(); }
  std::span<const std::uint8_t> line_coding() const { return requests_.line_coding(); }

  UsbCounters counters() const {
    UsbCounters result = counters_;
    for (std::size_t i = 0; i < usb::function_count; ++i) {
      result.packets_received += out_[i].packets();
      result.packets_sent += in_[i].packets();
      result.resynchronised += out_[i].resynchronised();
    }
    return result;
  }

 private:
  void on_bus_reset() {
    hardware_.clear_status(usb_field::status_reset);
    ++counters_.bus_resets;
    hardware_.clear_done(~0u);
    hardware_.set_address(0);
    requests_.reset();
    control_.reset();
    new_connection();
    stop_pipes();
    suspended_ = false;
  }

  void on_frame() {
    hardware_.acknowledge_frame();
    frame_us_ = hardware_.microseconds();
    suspended_ = false;
    if ((hardware_.status() & usb_field::status_errors) != 0) {
      hardware_.clear_status(usb_field::status_errors);
      ++counters_.bus_errors;
    }
  }

  /// The interrupt reports that the state has changed, SIE_STATUS the new one. Waking up is
  /// detected by the resume, by the next frame or by a reset, whichever is first.
  void on_suspend(std::uint32_t why) {
    const bool suspended = (hardware_.status() & usb_field::status_suspended) != 0;
    hardware_.clear_status(usb_field::status_suspended | usb_field::status_resume);
    const bool resumed = (why & usb_field::int_resume) != 0;
    if (suspended && !resumed && !suspended_) ++counters_.suspends;
    suspended_ = suspended && !resumed;
  }

  void on_buffers() {
    const std::uint32_t done = hardware_.done();
    hardware_.clear_done(done);
    if ((done & 1) != 0) control_.on_in_done();
    if ((done & 2) != 0) control_.on_out_done();
  }

  /// Passes packets of one function to the ring.
  struct Taker {
    BasicUsbSerial& port;
    usb::Function from;
    usb::PacketLook inspect(const volatile std::uint32_t* words, std::uint32_t size) const {
      const usb::Verdict verdict = port.hear(from, words, size);
      if (verdict == usb::Verdict::drop) return usb::PacketLook::drop;
      const bool reset = port.received_.take_realtime(words, size);
      return reset || verdict != usb::Verdict::take ? usb::PacketLook::begins_anew
                                                    : usb::PacketLook::take;
    }
    /// A packet that waited while the other function took over is discarded.
    bool push_packet(const volatile std::uint32_t* words, std::uint32_t size) const {
      if (port.listener_.heard() != from) return true;
      const bool taken = port.received_.push_packet(words, size);
      port.packets_wait_ = !taken;
      // Its host would send more if it could.
      if (!taken) port.listener_.speaks_on(port.hardware_.microseconds());
      return taken;
    }
  };
  void take_packets(usb::Function from) { out_[usb::index(from)].service(Taker{*this, from}); }

  /// A packet was received: decides whether its function is heard.
  usb::Verdict hear(usb::Function from, const volatile std::uint32_t* words, std::uint32_t size) {
    const usb::Verdict verdict =
        listener_.packet(from, usb::tail_of(words, size), hardware_.microseconds(), tied_);
    if (verdict == usb::Verdict::drop) {
      ++counters_.packets_unheard;
      return verdict;
    }
    if (verdict != usb::Verdict::take) new_host();
    if (verdict == usb::Verdict::take_over_broken) received_.mark_gap();
    return verdict;
  }

  void on_setup() {
    ++counters_.requests;
    suspended_ = false;
    const usb::Answer answer =
        control_.on_setup([this](const usb::Reaction& reaction) { apply(reaction); });
    if (answer == usb::Answer::stall) ++counters_.refused_requests;
  }

  void apply(const usb::Reaction& reaction) {
    switch (reaction.effect) {
      case usb::Effect::configure:
        new_connection();
        configured_ = true;
        for (auto& out : out_) out.start();
        for (auto& in : in_) in.start();
        start_notify();
        break;
      case usb::Effect::deconfigure:
        new_connection();
        stop_pipes();
        break;
      case usb::Effect::restart:
        restart(reaction.pipes);
        break;
      case usb::Effect::halt:
        halt(reaction.pipes);
        break;
      case usb::Effect::none:
      case usb::Effect::use_address:  // after the status stage, by ControlPipe
        break;
    }
  }

  void new_connection() {
    configured_ = false;
    listener_.reset(hardware_.microseconds());
    new_host();
  }
  /// Discards data in transit from or to the previous host.
  void new_host() {
    generation_ = generation_ + 1;
    received_.discard();
    to_send_.discard();
    packets_wait_ = false;
  }

  void stop_pipes() {
    for (auto& out : out_) out.stop();
    for (auto& in : in_) in.stop();
    hardware_.dpram().endpoint_control[usb::notify_endpoint - 1].in = 0;
    notify_half() = 0;
  }

  /// The notification endpoint exists, and never sends.
  void start_notify() {
    notify_half() = 0;
    hardware_.dpram().endpoint_control[usb::notify_endpoint - 1].in =
        usb_field::endpoint_enable | usb_field::endpoint_each_buffer |
        usb_field::endpoint_interrupt | usb::notify_buffer_offset;
  }
  BufferHalf& notify_half() { return hardware_.dpram().buffer_control[usb::notify_endpoint].in[0]; }

  /// Finishes completed buffers before buffers are armed again.
  void settle() {
    for (const usb::Function function : {usb::Function::serial, usb::Function::stream}) {
      take_packets(function);
      in_[usb::index(function)].service(to_send_, [] { return false; });
    }
  }

  /// Packets that wait for room are lost when their endpoint restarts.
  void lose_packets(usb::Pipes pipes) {
    for (std::size_t i = 0; i < usb::function_count; ++i) {
      if ((pipes & usb::out_pipes[i]) == 0 || !out_[i].keeps_packet()) continue;
      received_.lose_packets();
      packets_wait_ = false;
    }
  }

  void restart(usb::Pipes pipes) {
    settle();
    lose_packets(pipes);
    for (std::size_t i = 0; i < usb::function_count; ++i) {
      if ((pipes & usb::out_pipes[i]) != 0) out_[i].restart();
      if ((pipes & usb::in_pipes[i]) != 0) in_[i].restart();
    }
    if ((pipes & usb::pipe_notify) != 0) notify_half() = 0;
  }

  void halt(usb::Pipes pipes) {
    settle();
    lose_packets(pipes);
    for (std::size_t i = 0; i < usb::function_count; ++i) {
      if ((pipes & usb::out_pipes[i]) != 0) out_[i].halt();
      if ((pipes & usb::in_pipes[i]) != 0) in_[i].halt();
    }
    if ((pipes & usb::pipe_notify) != 0)
      usb::give_buffer(hardware_, notify_half(), 0, usb_field::buffer_stall);
  }

  Hardware& hardware_;
  usb::ControlRequests requests_;
  usb::ControlPipe<Hardware> control_{hardware_, requests_};
  std::array<usb::BulkOut<Hardware>, usb::function_count> out_{
      {{hardware_, usb::serial_out_place}, {hardware_, usb::stream_out_place}}};
  std::array<usb::BulkIn<Hardware>, usb::function_count> in_{
      {{hardware_, usb::serial_in_place}, {hardware_, usb::stream_in_place}}};
  usb::Listener listener_;
  usb::BusResetExit<Hardware> reset_exit_{hardware_};
  ReceiveRing<receive_capacity> received_;
  SendRing<send_capacity> to_send_;
  UsbCounters counters_;
  std::uint32_t frame_us_ = 0;  ///< of the last start of frame
  volatile std::uint32_t generation_ = 0;
  volatile bool configured_ = false;
  volatile bool suspended_ = false;
  volatile bool tied_ = false;
  volatile bool packets_wait_ = false;  ///< for room in the ring
};

}  // namespace lamplock::rp2040
