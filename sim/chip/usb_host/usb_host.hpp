// The host end of the USB cable: an ordinary PC with its stack, a CDC serial driver, and a program
// that may claim a vendor interface beside it.
//
// In:  bytes to send, plug, unplug, suspend, resume, DTR from the user or a test.
// Out: bytes received, statistics, the device's description of itself, and every departure from the
//      standards as a line of text.
// Who: the board facade and tests; the time wheel runs it.
//
// A device that pulls D+ up is debounced, reset and enumerated. From then on every frame of 1 ms
// begins with SOF, then control, bulk IN and bulk OUT of both functions take turns at the real bus
// times until the next transaction would not end before the frame (at most 19 of 64 bytes); NAKed
// ones are repeated. Received packets are delivered when a short one ends the transfer or the
// transfer is full, as drivers do, which reveals a device that omits the zero-length packet.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/usb/wire.hpp"
#include "sim/chip/usb_host/bulk_function.hpp"
#include "sim/chip/usb_host/descriptors.hpp"
#include "sim/chip/usb_host/microsoft_os.hpp"
#include "sim/chip/usb_host/transactions.hpp"
#include "sim/chip/usb_host/usb_function.hpp"

namespace lamplock::sim::chip {

/// Behaviour of the PC. Times that USB 2.0 gives are its minimum values.
struct UsbHostOptions {
  Picoseconds debounce = 100 * ps_per_ms;        ///< USB 2.0, 7.1.7.3
  Picoseconds reset = 10 * ps_per_ms;            ///< a hub's; root ports take 50 ms (7.1.7.5)
  Picoseconds reset_recovery = 10 * ps_per_ms;   ///< 7.1.7.5
  Picoseconds address_recovery = 2 * ps_per_ms;  ///< 9.2.6.3
  Picoseconds resume = 20 * ps_per_ms;           ///< 7.1.7.7
  Picoseconds resume_recovery = 10 * ps_per_ms;  ///< 7.1.7.7
  std::uint8_t address = 5;
  /// First ask for 64 bytes of the device descriptor, then reset once more, as Linux and Windows
  /// do; otherwise ask for 8.
  bool second_reset = false;
  /// Ask for the descriptors of Microsoft before the configuration, as Windows does.
  bool windows = false;
  /// Full transfers to the device end with a zero-length packet.
  bool send_zero_length = false;
  /// Bytes that a read asks the device for.
  std::size_t read_transfer = 4096;
  std::size_t write_buffer = 4096;
  std::size_t read_buffer = 65536;  ///< the device is not polled above this
  /// Another device on the bus sends a packet every 250 us.
  bool other_traffic = false;
};

/// Counters since plug-in, both functions together.
struct UsbHostStatistics {
  std::uint64_t frames = 0;
  std::uint64_t in_packets = 0, in_bytes = 0, in_naks = 0;
  std::uint64_t out_packets = 0, out_bytes = 0, out_naks = 0;
  std::uint64_t silences = 0;  ///< no valid answer
  std::uint64_t repeated = 0;  ///< IN packets with an unchanged toggle: dropped
  std::uint64_t stalls = 0;
  std::uint64_t notifications = 0;  ///< packets of the interrupt endpoint
  std::uint32_t max_bulk_packets_in_frame = 0;
  Picoseconds max_refused = 0;    ///< first NAK of an OUT packet to its ACK, or until now
  Picoseconds max_frame_gap = 0;  ///< SOF to SOF, suspension left out
};

class UsbHost final : public Timed, public usb::HostEnd {
 public:
  /// Plugged in from the start. `device` must outlive the host.
  UsbHost(TimeWheel& wheel, usb::DeviceEnd& device, UsbHostOptions options = {});
  ~UsbHost() override;
  UsbHost(const UsbHost&) = delete;
  UsbHost& operator=(const UsbHost&) = delete;

  /// Queues bytes for the device; returns how many were taken: none before enumerated(), at most
  /// what the buffer of 4096 has room for; over the vendor interface none without claim_vendor().
  std::size_t write(std::span<const std::uint8_t> bytes, UsbFunction to = UsbFunction::serial);
  /// Takes bytes from the device; returns how many there were.
  std::size_t read(std::span<std::uint8_t> bytes, UsbFunction from = UsbFunction::serial);
  bool has_output(UsbFunction from = UsbFunction::serial) const {
    return !bulk(from).received.empty();
  }
  /// Bytes that were written and that the device has not acknowledged.
  std::size_t unsent(UsbFunction to = UsbFunction::serial) const { return bulk(to).unsent(); }
  /// Received bytes that wait for the end of their transfer.
  std::size_t unfinished() const { return bulk(UsbFunction::serial).transfer.size(); }

  /// A program claims the vendor interface, now or as soon as it is enumerated; false releases it.
  void claim_vendor(bool claimed);
  /// A program opens the serial port (open from the start): the driver asks for packets. set_dtr()
  /// sets DTR separately.
  void open_serial(bool open);

  void unplug();
  void plug();
  /// Stops frames; a transaction in progress breaks off. Only once enumerated.
  void suspend();
  void resume();
  void set_dtr(bool on);
  /// A bus reset and another enumeration, as when a driver has given up.
  void reset_device();
  /// A control transfer in addition to the others; the answer is kept under last_control().
  void control(const std::array<std::uint8_t, 8>& setup, std::vector<std::uint8_t> data = {});

  bool enumerated() const { return step_ == Step::running; }
  bool failed() const { return step_ == Step::failed; }
  bool plugged() const { return plugged_; }
  bool suspended() const { return step_ == Step::suspended; }
  const UsbHostStatistics& statistics() const { return statistics_; }
  const usb::Violations& violations() const { return violations_; }
  const usb::DeviceInfo& device_info() const { return device_info_; }
  const usb::SerialPort& port() const { return configuration_.port; }
  const usb::VendorPipe& vendor() const { return configuration_.vendor; }
  /// The descriptor set as Windows reads it; empty without UsbHostOptions::windows.
  const std::optional<usb::MicrosoftSet>& microsoft_set() const { return microsoft_set_; }
  const std::map<int, std::string>& strings() const { return strings_; }
  struct ControlAnswer {
    bool done = false, stalled = false, failed = false;
    std::vector<std::uint8_t> data;
  };
  const ControlAnswer& last_control() const { return last_control_; }

  /// Sees every transaction before it goes out and may put faults into it.
  using FaultInjector = std::function<void(usb::Transaction&)>;
  void set_fault_injector(FaultInjector injector) { fault_injector_ = std::move(injector); }
  UsbHostOptions& options() { return options_; }

  // Timed
  void run(Cycle to) override;
  void clock_changed() override { plan(); }
  // usb::HostEnd
  void pull_up_changed(bool on, Picoseconds at) override;
  void remote_wakeup(Picoseconds at) override;

 private:
  /// State of enumeration. Frames run from `first_descriptor` on.
  enum class Step : std::uint8_t {
    detached,
    debounce,
    reset,
    first_descriptor,
    second_reset,
    set_address,
    device,
    qualifier,
    bos_head,
    bos,
    microsoft_set,
    configuration_head,
    configuration,
    languages,
    strings,
    set_configuration,
    set_line_coding,
    get_line_coding,
    line_state,
    running,
    failed,
    suspended,
    resuming
  };
  enum class Turn : std::uint8_t {
    none,
    control,
    interrupt,
    bulk_in,
    bulk_out,
    vendor_in,
    vendor_out
  };
  enum class Stage : std::uint8_t { setup, data, status };
  struct ControlTransfer {
    std::array<std::uint8_t, 8> setup{};
    std::vector<std::uint8_t> data;
    bool user = false;  ///< asked for by control() or set_dtr(), not by enumeration
    Stage stage = Stage::setup;
    bool data1 = false;
    std::size_t sent = 0;
    int errors = 0;
    Picoseconds started = -1;
    Picoseconds stage_started = 0;
    bool is_in() const { return (setup[0] & 0x80) != 0; }
    std::size_t length() const { return static_cast<std::size_t>(setup[6] | setup[7] << 8); }
  };

  // Time
  void plan();
  void wait(Picoseconds until);
  void frame(Picoseconds at);
  void start_frames(Picoseconds at);
  void stop_frames();

  // Enumeration
  void enter(Step step);
  void waited(Picoseconds at);
  void begin_reset(Picoseconds at, Step step);
  void detach();
  void ask(std::array<std::uint8_t, 8> setup, std::vector<std::uint8_t> data = {});
  void ask_descriptor(std::uint8_t type, std::uint8_t index, std::uint16_t language,
                      std::size_t length);
  void control_done(const ControlTransfer& transfer, const ControlAnswer& answer, Picoseconds at);
  void enumeration_answer(const ControlAnswer& answer, Picoseconds at);
  void descriptor_answer(const ControlAnswer& answer);
  bool bos_answer(const ControlAnswer& answer);
  void class_answer(const ControlAnswer& answer);
  bool next_string();
  void fail_enumeration(const std::string& why);
  void violation(const std::string& text);

  // Transactions
  void begin_transaction(Picoseconds at);
  Turn choose(Picoseconds at);
  bool can_take(Turn turn, Picoseconds at) const;
  bool fits(std::size_t payload, Picoseconds at) const;
  void launch(usb::Transaction transaction, Picoseconds at);
  void done(const usb::Transaction& transaction, const usb::Result& result);
  usb::Transaction control_transaction();
  void control_result(const usb::Transaction& transaction, const usb::Result& result);
  void control_progress(const usb::Transaction& transaction, const usb::Result& result);
  void finish_control(const ControlAnswer& answer, Picoseconds at);
  void check_control_times(Picoseconds at);
  void interrupt_result(const usb::Result& result);
  void bulk_in_result(usb::BulkFunction& bulk, const usb::Result& result);
  void bulk_out_result(usb::BulkFunction& bulk, const usb::Result& result);
  void stalled(std::uint8_t endpoint_address);
  void clear_port();
  usb::BulkFunction& bulk(UsbFunction function) {
    return bulk_[static_cast<std::size_t>(function)];
  }
  const usb::BulkFunction& bulk(UsbFunction function) const {
    return bulk_[static_cast<std::size_t>(function)];
  }
  static UsbFunction function_of(Turn turn) {
    const bool vendor = turn == Turn::vendor_in || turn == Turn::vendor_out;
    return vendor ? UsbFunction::vendor : UsbFunction::serial;
  }

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  usb::DeviceEnd& device_;
  UsbHostOptions options_;
  usb::TransactionEngine engine_;
  FaultInjector fault_injector_;

  bool plugged_ = false;
  Step step_ = Step::detached;
  int attempts_ = 0;
  Picoseconds wait_until_ = -1;
  Picoseconds next_frame_ = -1;
  Picoseconds last_frame_ = -1;
  Picoseconds next_stranger_ = -1;
  Picoseconds bus_free_ = 0;  ///< end of the transaction before
  std::uint16_t frame_number_ = 0;
  Turn turn_ = Turn::none;  ///< of the transaction in progress
  Turn last_turn_ = Turn::none;
  std::uint8_t address_ = 0;

  std::optional<ControlTransfer> transfer_now_;
  std::deque<ControlTransfer> control_queue_;
  ControlAnswer last_control_;
  ControlAnswer answer_;

  // Descriptors and errors of the device
  usb::Violations violations_;
  usb::DeviceInfo device_info_;
  usb::Configuration configuration_;
  std::vector<std::uint8_t> device_bytes_, configuration_bytes_;
  std::uint16_t bos_size_ = 0;
  std::optional<usb::MicrosoftCapability> microsoft_;
  std::optional<usb::MicrosoftSet> microsoft_set_;
  std::map<int, std::string> strings_;
  std::vector<int> strings_to_read_;
  std::uint16_t language_ = 0;
  bool dtr_ = true;

  // Data
  std::array<usb::BulkFunction, 2> bulk_;  ///< by UsbFunction
  bool notify_data1_ = false;
  Picoseconds interrupt_due_ = 0;
  std::uint32_t bulk_in_frame_ = 0;
  UsbHostStatistics statistics_;
};

}  // namespace lamplock::sim::chip
