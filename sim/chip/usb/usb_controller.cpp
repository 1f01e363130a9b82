#include "sim/chip/usb/usb_controller.hpp"

#include <algorithm>

#include "sim/chip/usb/registers.hpp"

namespace lamplock::sim::chip {

using namespace usb;

namespace {

/// Idle bus that means suspend (USB 2.0, 7.1.7.6).
constexpr Picoseconds suspend_after = 3 * ps_per_ms;
/// Idle bus that RP2040-E5 needs after a reset.
constexpr Picoseconds e5_idle = 800 * ps_per_us;
/// Where RP2040-E15 can strike: the last 200 us of a frame of 1 ms.
constexpr Picoseconds e15_window_start = 800 * ps_per_us;
/// The only frequency of clk_usb (datasheet, 4.1.2.1).
constexpr std::uint64_t usb_clock_hz = 48'000'000;

enum LineState : std::uint32_t { se0 = 0, j_state = 1, k_state = 2 };

std::string endpoint_name(std::uint32_t index) {
  return "EP" + std::to_string(index / 2) + (index % 2 == 0 ? " IN" : " OUT");
}

}  // namespace

bool UsbController::Endpoint::doubled() const {
  return (control & ep_control::double_buffered) != 0;
}

std::uint32_t UsbController::Endpoint::address() const {
  const std::uint32_t first =
      number_zero() ? dpram::ep0_buffer : control & ep_control::address_mask;
  return (first + buffer * max_packet) % dpram::size;
}

UsbController::UsbController(TimeWheel& wheel, IrqLines& irq, std::span<std::uint8_t> dpram,
                             NotModelled not_modelled, UsbErrata errata)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      irq_(irq),
      dpram_(dpram.first(dpram::size)),
      not_modelled_(std::move(not_modelled)),
      errata_(errata),
      interrupts_(reg::intr, interrupt::all) {
  reset();
}

void UsbController::reset() {
  addr_endp_ = main_ctrl_ = sie_ctrl_ = muxing_ = pwr_ = 0;
  phy_direct_ = phy_override_ = 0;
  phy_trim_ = 0x1f1f;  // reset value, datasheet 4.1.4
  latched_ = changes_ = buff_status_ = abort_ = abort_done_ = stall_arm_ = stall_nak_ = 0;
  interrupts_.reset();
  frame_ = 0;
  connected_ = suspended_ = hung_ = false;
  abort_stuck_ = select_ = 0;
  done_.fill({});
  transaction_ = {};
  connect_after_ = -1;
  update_pull_up();
  plan();
  update_interrupt();
}

// DPRAM

std::uint32_t UsbController::word(std::uint32_t offset) const {
  return half(offset) | static_cast<std::uint32_t>(half(offset + 2)) << 16;
}

std::uint16_t UsbController::half(std::uint32_t offset) const {
  return static_cast<std::uint16_t>(dpram_[offset] | dpram_[offset + 1] << 8);
}

void UsbController::set_half(std::uint32_t offset, std::uint16_t value) {
  dpram_[offset] = static_cast<std::uint8_t>(value);
  dpram_[offset + 1] = static_cast<std::uint8_t>(value >> 8);
}

void UsbController::dpram_stored(std::uint32_t offset, std::uint32_t before, std::uint32_t after) {
  if (offset < dpram::buffer_control || offset >= dpram::ep0_buffer) return;
  if (wheel_.frequency() == usb_clock_hz) return;
  const Picoseconds cycle = ps_per_s / static_cast<Picoseconds>(usb_clock_hz);
  const std::uint32_t index = (offset - dpram::buffer_control) / 4;
  for (std::uint32_t buffer = 0; buffer < 2; ++buffer) {
    const auto was = static_cast<std::uint16_t>(before >> (16 * buffer));
    const auto is = static_cast<std::uint16_t>(after >> (16 * buffer));
    Picoseconds& written = fields_written_[2 * index + buffer];
    if (((was ^ is) & ~buffer_control::available) != 0) written = wheel_.time() + 1;
    const bool rises = (is & ~was & buffer_control::available) != 0;
    if (rises && written != 0 && wheel_.time() + 1 - written < cycle)
      violation(endpoint_name(index) + " buffer " + std::to_string(buffer) +
                ": AVAILABLE set less than one cycle of clk_usb after the other fields");
  }
}

// Registers

std::uint32_t UsbController::read(std::uint32_t offset) {
  if (offset == reg::sof_rd) {
    changes_ &= ~interrupt::dev_sof;
    update_interrupt();
  }
  return peek(offset);
}

std::uint32_t UsbController::peek(std::uint32_t offset) const {
  switch (offset) {
    case reg::addr_endp:
      return addr_endp_;
    case reg::main_ctrl:
      return main_ctrl_;
    case reg::sof_rd:
      return frame_;
    case reg::sie_ctrl:
      return sie_ctrl_;
    case reg::sie_status:
      return status();
    case reg::buff_status:
      return buff_status_;
    case reg::buff_cpu_should_handle:
      return should_handle();
    case reg::ep_abort:
      return abort_;
    case reg::ep_abort_done:
      return abort_done_;
    case reg::ep_stall_arm:
      return stall_arm_;
    case reg::nak_poll:
      return 0x0010'0010;  // reset value; of host mode, which is not modelled
    case reg::ep_status_stall_nak:
      return stall_nak_;
    case reg::usb_muxing:
      return muxing_;
    case reg::usb_pwr:
      return pwr_;
    case reg::usbphy_direct:
      return phy_direct_;
    case reg::usbphy_direct_override:
      return phy_override_;
    case reg::usbphy_trim:
      return phy_trim_;
    case reg::intr:
    case reg::inte:
    case reg::intf:
    case reg::ints:
      return interrupts_.read(offset, raw_interrupts());
    default:
      return 0;  // host registers that are refused when written, and reserved space
  }
}

std::uint32_t UsbController::write_clear_bits(std::uint32_t offset) const {
  switch (offset) {
    case reg::sie_status:
      return sie_status::latched | sie_status::states;
    case reg::buff_status:
    case reg::ep_abort_done:
    case reg::ep_status_stall_nak:
      return 0xffff'ffffu;
    default:
      return 0;
  }
}

void UsbController::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case reg::addr_endp:
      addr_endp_ = value & 0x000f'007f;
      break;
    case reg::main_ctrl:
      write_main_ctrl(value);
      break;
    case reg::sie_ctrl:
      write_sie_ctrl(value);
      break;
    case reg::sie_status:
      write_sie_status(value);
      break;
    case reg::buff_status:
      write_buff_status(value);
      break;
    case reg::ep_abort:
      write_abort(value);
      break;
    case reg::ep_abort_done:
      abort_done_ &= ~value;
      break;
    case reg::ep_stall_arm:
      stall_arm_ = value & 3;
      break;
    case reg::ep_status_stall_nak:
      stall_nak_ &= ~value;
      break;
    case reg::inte:
    case reg::intf:
      interrupts_.write(offset, value);
      break;
    case reg::usb_muxing:
    case reg::usb_pwr:
    case reg::usbphy_direct:
    case reg::usbphy_direct_override:
    case reg::usbphy_trim:
      write_phy(offset, value);
      break;
    case reg::sof_rd:
    case reg::buff_cpu_should_handle:
    case reg::intr:
    case reg::ints:
      break;  // read-only
    default:
      write_host_register(offset, value);
      break;
  }
  update_interrupt();
}

void UsbController::write_host_register(std::uint32_t offset, std::uint32_t value) {
  if (value == 0) return;
  if (offset >= reg::addr_endp1 && offset <= reg::addr_endp15)
    not_modelled_("USBCTRL_REGS ADDR_ENDP1..15 (host mode) written");
  else if (offset == reg::sof_wr)
    not_modelled_("USBCTRL_REGS SOF_WR (host mode) written");
  else if (offset == reg::int_ep_ctrl)
    not_modelled_("USBCTRL_REGS INT_EP_CTRL (host mode) written");
  else if (offset == reg::nak_poll)
    not_modelled_("USBCTRL_REGS NAK_POLL (host mode) written");
  else
    not_modelled_("USBCTRL_REGS reserved register written");
}

void UsbController::write_main_ctrl(std::uint32_t value) {
  if ((value & main_ctrl::host_ndevice) != 0) not_modelled_("USBCTRL_REGS host mode");
  if ((value & main_ctrl::sim_timing) != 0) not_modelled_("USBCTRL_REGS MAIN_CTRL SIM_TIMING");
  main_ctrl_ = value & (main_ctrl::controller_en | main_ctrl::host_ndevice | main_ctrl::sim_timing);
  update_pull_up();
}

void UsbController::write_sie_ctrl(std::uint32_t value) {
  if ((value & sie_ctrl::host_bits) != 0) not_modelled_("USBCTRL_REGS SIE_CTRL host mode bits");
  if ((value & sie_ctrl::direct) != 0) not_modelled_("USBCTRL_REGS SIE_CTRL DIRECT drive");
  sie_ctrl_ = value & sie_ctrl::writable & ~sie_ctrl::resume;
  update_pull_up();
  if ((value & sie_ctrl::resume) != 0 && suspended_ && host_ != nullptr)
    host_->remote_wakeup(wheel_.time());
}

void UsbController::write_sie_status(std::uint32_t value) {
  latched_ &= ~(value & sie_status::latched);
  if ((value & sie_status::connected) != 0) changes_ &= ~interrupt::dev_conn_dis;
  if ((value & sie_status::suspended) != 0) changes_ &= ~interrupt::dev_suspend;
  if ((value & sie_status::resume) != 0) changes_ &= ~interrupt::dev_resume_from_host;
}

void UsbController::write_buff_status(std::uint32_t value) {
  for (std::uint32_t index = 0; index < 32; ++index) {
    if ((value & buff_status_ & 1u << index) == 0) continue;
    // With both buffers done the bit is set again for the other one (datasheet, 4.1.2.6.2).
    Done& done = done_[index];
    done.buffers &= static_cast<std::uint8_t>(~(1u << done.first));
    done.first ^= 1;
    if (done.buffers == 0) buff_status_ &= ~(1u << index);
  }
}

void UsbController::write_abort(std::uint32_t value) {
  if (errata_.e2_abort_sticks) abort_stuck_ |= abort_ & ~value;
  const std::uint32_t rising = value & ~abort_;
  abort_ = value;
  // Done when the endpoint is idle; one that is in a transaction becomes so at its end.
  std::uint32_t idle = rising;
  if (transaction_.phase != Phase::idle) idle &= ~(1u << transaction_.endpoint.index);
  abort_done_ |= idle;
}

void UsbController::write_phy(std::uint32_t offset, std::uint32_t value) {
  if (offset == reg::usb_muxing) {
    if ((value & (phy::to_extphy | phy::to_digital_pad)) != 0)
      not_modelled_("USBCTRL_REGS USB_MUXING to external PHY or digital pads");
    muxing_ = value & 0xf;
  } else if (offset == reg::usb_pwr) {
    pwr_ = value & 0x3f;
  } else if (offset == reg::usbphy_direct) {
    phy_direct_ = value & 0xff77;
  } else if (offset == reg::usbphy_direct_override) {
    if ((value & ~phy::dp_pullup_override) != 0)
      not_modelled_("USBCTRL_REGS USBPHY_DIRECT_OVERRIDE other than the D+ pull-up");
    phy_override_ = value & 0x9fff;
  } else {
    phy_trim_ = value & 0x1f1f;
  }
  update_pull_up();
}

std::uint32_t UsbController::status() const {
  std::uint32_t line = se0;
  if (bus_ == Bus::resume)
    line = k_state;
  else if (bus_ == Bus::idle && pull_up_)
    line = j_state;
  return latched_ | (vbus_detected() ? sie_status::vbus_detected : 0) |
         line << sie_status::line_state_shift | (suspended_ ? sie_status::suspended : 0) |
         (connected_ ? sie_status::connected : 0);
}

std::uint32_t UsbController::raw_interrupts() const {
  struct Source {
    std::uint32_t status, interrupt;
  };
  static constexpr std::array<Source, 9> sources{
      {{sie_status::trans_complete, interrupt::trans_complete},
       {sie_status::data_seq_error, interrupt::error_data_seq},
       {sie_status::rx_timeout, interrupt::error_rx_timeout},
       {sie_status::rx_overflow, interrupt::error_rx_overflow},
       {sie_status::bit_stuff_error, interrupt::error_bit_stuff},
       {sie_status::crc_error, interrupt::error_crc},
       {sie_status::stall_rec, interrupt::stall},
       {sie_status::bus_reset, interrupt::bus_reset},
       {sie_status::setup_rec, interrupt::setup_req}}};
  std::uint32_t raw = changes_;
  for (const Source& source : sources)
    if ((latched_ & source.status) != 0) raw |= source.interrupt;
  if (vbus_detected()) raw |= interrupt::vbus_detect;
  if (buff_status_ != 0) raw |= interrupt::buff_status;
  if (abort_done_ != 0) raw |= interrupt::abort_done;
  if (stall_nak_ != 0) raw |= interrupt::ep_stall_nak;
  return raw;
}

std::uint32_t UsbController::should_handle() const {
  std::uint32_t word = 0;
  for (std::uint32_t index = 0; index < 32; ++index)
    if ((buff_status_ & 1u << index) != 0 && done_[index].first != 0) word |= 1u << index;
  return word;
}

void UsbController::update_interrupt() {
  irq_.set(Irq::usbctrl, interrupts_.status(raw_interrupts()) != 0);
}

// State of the cable

bool UsbController::vbus_detected() const {
  return (pwr_ & phy::vbus_detect_override) != 0 ? (pwr_ & phy::vbus_detect) != 0 : vbus_pin_;
}

void UsbController::set_vbus_pin(bool level) {
  vbus_pin_ = level;
  update_pull_up();
  update_interrupt();
}

void UsbController::set_usb_clock(std::uint64_t hz) { usb_hz_ = hz; }

void UsbController::update_pull_up() {
  const bool enabled = (main_ctrl_ & main_ctrl::controller_en) != 0 &&
                       (main_ctrl_ & main_ctrl::host_ndevice) == 0 && (muxing_ & phy::to_phy) != 0;
  bool wanted = (sie_ctrl_ & sie_ctrl::pullup_en) != 0;
  if ((phy_override_ & phy::dp_pullup_override) != 0)
    wanted = (phy_direct_ & phy::dp_pullup_en) != 0;
  // The override in USB_PWR exists because the device pulls up only with VBUS detected.
  const bool on = enabled && wanted && vbus_detected();
  if (on == pull_up_) return;
  if (on && usb_hz_ != usb_clock_hz)
    violation("pull-up enabled with clk_usb at " + std::to_string(usb_hz_) + " Hz, not 48 MHz");
  pull_up_ = on;
  last_activity_ = wheel_.time();
  if (!on) {
    set_connected(false);
    set_suspended(false);
    transaction_ = {};
  }
  plan();
  if (host_ != nullptr) host_->pull_up_changed(on, wheel_.time());
}

void UsbController::set_connected(bool on) {
  if (connected_ == on) return;
  connected_ = on;
  changes_ |= interrupt::dev_conn_dis;
}

void UsbController::set_suspended(bool on) {
  if (suspended_ == on) return;
  suspended_ = on;
  changes_ |= interrupt::dev_suspend;
}

void UsbController::connect(HostEnd* host, Picoseconds at) {
  host_ = host;
  bus_ = Bus::idle;
  connect_after_ = -1;
  transaction_ = {};
  activity(at);
  plan();
}

void UsbController::activity(Picoseconds at) {
  last_activity_ = at;
  if (connect_after_ >= 0) {
    connect_after_ = at + e5_idle;
    plan();
  }
}

void UsbController::plan() {
  Picoseconds due = never;
  if (bus_ != Bus::idle && !bus_seen_)
    due = bus_since_ + (bus_ == Bus::reset ? Assumed::reset_detect : Assumed::resume_detect);
  else if (connect_after_ >= 0)
    due = connect_after_;
  else if (bus_ == Bus::idle && pull_up_ && !suspended_)
    due = last_activity_ + suspend_after;
  wheel_.set(slot_, wheel_.cycle_at(due));
}

void UsbController::clock_changed() { plan(); }

void UsbController::run(Cycle) {
  const Picoseconds at = wheel_.time();
  if (bus_ == Bus::reset && !bus_seen_) {
    bus_seen_ = at >= bus_since_ + Assumed::reset_detect;
    if (bus_seen_ && pull_up_ && !hung_) {
      latched_ |= sie_status::bus_reset;
      set_suspended(false);
      set_connected(false);
    }
  } else if (bus_ == Bus::resume && !bus_seen_) {
    bus_seen_ = at >= bus_since_ + Assumed::resume_detect;
    if (bus_seen_ && suspended_ && !hung_) {
      latched_ |= sie_status::resume;
      changes_ |= interrupt::dev_resume_from_host;
      set_suspended(false);
    }
  } else if (connect_after_ >= 0) {
    if (at >= connect_after_) {
      connect_after_ = -1;
      last_activity_ = at;
      set_connected(true);
    }
  } else if (bus_ == Bus::idle && pull_up_ && !suspended_ && at >= last_activity_ + suspend_after) {
    set_suspended(true);
  }
  plan();
  update_interrupt();
}

void UsbController::begin_reset(Picoseconds at) {
  bus_ = Bus::reset;
  bus_since_ = at;
  bus_seen_ = false;
  connect_after_ = -1;
  transaction_ = {};
  plan();
}

void UsbController::end_reset(Picoseconds at) {
  const bool counted = bus_seen_ && pull_up_ && !hung_;
  bus_ = Bus::idle;
  activity(at);
  if (counted && errata_.e5_reset_needs_idle)
    connect_after_ = at + e5_idle;
  else if (counted)
    set_connected(true);
  plan();
  update_interrupt();
}

void UsbController::begin_resume(Picoseconds at) {
  bus_ = Bus::resume;
  bus_since_ = at;
  bus_seen_ = false;
  plan();
}

void UsbController::end_resume(Picoseconds at) {
  bus_ = Bus::idle;
  activity(at);
  plan();
}

void UsbController::start_of_frame(std::uint16_t number, Picoseconds at) {
  activity(at);
  if (!listens()) return;
  last_frame_ = at;
  frame_ = number & 0x7ff;
  changes_ |= interrupt::dev_sof;
  update_interrupt();
}

void UsbController::other_traffic(Picoseconds at) { activity(at); }

/// Whether packets are received. A suspended controller wakes by resume signalling only, not by
/// packets (RP2350 datasheet, 12.7.2.2.3, which names this as changed in the RP2350).
bool UsbController::listens() const {
  return pull_up_ && connected_ && !suspended_ && !hung_ && bus_ == Bus::idle &&
         usb_hz_ == usb_clock_hz && (sie_ctrl_ & sie_ctrl::transceiver_pd) == 0;
}

// Transactions

/// The endpoint that a token addresses; empty if the controller does not answer for it.
std::optional<UsbController::Endpoint> UsbController::find_endpoint(std::uint8_t number, bool out) {
  Endpoint endpoint;
  endpoint.index = 2u * number + (out ? 1u : 0u);
  if (number == 0) {
    endpoint.control =
        ep_control::enable |
        (sie_ctrl_ & (sie_ctrl::ep0_int_2buf | sie_ctrl::ep0_int_1buf | sie_ctrl::ep0_double_buf));
    if ((sie_ctrl_ & sie_ctrl::ep0_int_nak) != 0) endpoint.control |= ep_control::int_nak;
    if ((sie_ctrl_ & sie_ctrl::ep0_int_stall) != 0) endpoint.control |= ep_control::int_stall;
  } else {
    endpoint.control = word(dpram::ep_control + 4 * (endpoint.index - 2));
    if ((endpoint.control & ep_control::enable) == 0) return std::nullopt;
    if ((endpoint.control >> ep_control::type_shift & 3) == ep_control::type_isochronous) {
      not_modelled_("USBCTRL_REGS isochronous endpoint");
      return std::nullopt;
    }
    if ((endpoint.control & ep_control::address_mask) < dpram::ep0_buffer)
      violation(endpoint_name(endpoint.index) + ": data buffer lies on the control words");
  }
  const std::uint32_t control_word = dpram::buffer_control + 4 * endpoint.index;
  const std::uint32_t bit = 1u << endpoint.index;
  if ((half(control_word) & buffer_control::select_reset) != 0) select_ &= ~bit;
  endpoint.buffer = endpoint.doubled() && (select_ & bit) != 0 ? 1 : 0;
  endpoint.word = half(control_word + 2 * endpoint.buffer);
  return endpoint;
}

/// NAK for an aborted endpoint, STALL for a stalled one (datasheet, 4.1.2.6), else nothing yet.
std::optional<UsbController::Answer> UsbController::refusal(const Endpoint& endpoint) {
  const std::uint32_t bit = 1u << endpoint.index;
  if (((abort_ | abort_stuck_) & bit) != 0) return Answer::nak;
  const bool stall =
      (half(dpram::buffer_control + 4 * endpoint.index) & buffer_control::stall) != 0;
  if (stall && (!endpoint.number_zero() || (stall_arm_ & bit) != 0)) return Answer::stall;
  return std::nullopt;
}

void UsbController::note_refusal(const Endpoint& endpoint, Answer answer) {
  const std::uint32_t wanted =
      answer == Answer::stall ? ep_control::int_stall : ep_control::int_nak;
  if ((endpoint.control & wanted) == 0) return;
  stall_nak_ |= 1u << endpoint.index;
  update_interrupt();
}

void UsbController::note_late_arm(const Endpoint& endpoint, bool armed, Picoseconds at) {
  if ((endpoint.control >> ep_control::type_shift & 3) != ep_control::type_bulk ||
      endpoint.number_zero())
    return;
  Picoseconds& refused = refused_at_[endpoint.index / 2];
  if (armed && refused > last_frame_ + e15_window_start) ++armed_late_;
  refused = armed ? 0 : at;
}

std::optional<Packet> UsbController::in(std::uint8_t address, std::uint8_t endpoint_number,
                                        Picoseconds at) {
  activity(at);
  transaction_ = {};
  if (!listens() || address != (addr_endp_ & 0x7f)) return std::nullopt;
  const std::optional<Endpoint> endpoint = find_endpoint(endpoint_number, false);
  if (!endpoint) return std::nullopt;

  const bool ready = (endpoint->word & buffer_control::available) != 0 &&
                     (endpoint->word & buffer_control::full) != 0;
  const std::optional<Answer> refused = refusal(*endpoint);
  note_late_arm(*endpoint, ready && !refused, at);
  Packet packet;
  if (refused || !ready) {
    const Answer answer = refused.value_or(Answer::nak);
    note_refusal(*endpoint, answer);
    packet.pid = answer == Answer::stall ? Pid::stall : Pid::nak;
    return packet;
  }
  packet.pid = (endpoint->word & buffer_control::pid) != 0 ? Pid::data1 : Pid::data0;
  packet.size = endpoint->word & buffer_control::length_mask;
  if (packet.size > max_packet) {
    violation(endpoint_name(endpoint->index) + ": length of more than 64 bytes");
    packet.size = max_packet;
  }
  for (std::size_t i = 0; i < packet.size; ++i)
    packet.bytes[i] = dpram_[(endpoint->address() + i) % dpram::size];
  transaction_ = {Phase::in_sent, Answer::data, *endpoint, static_cast<std::uint32_t>(packet.size),
                  packet.pid == Pid::data1};
  return packet;
}

void UsbController::in_end(bool ack, Fault fault, Picoseconds at) {
  activity(at);
  if (transaction_.phase != Phase::in_sent) return;
  if (fault == Fault::bit_stuff) {
    latched_ |= sie_status::bit_stuff_error;
    hung_ = errata_.e15_broken_packet_hangs;
  } else if (!ack || fault != Fault::none) {
    latched_ |= sie_status::rx_timeout;
  } else {
    latched_ |= sie_status::ack_rec;
    finish_buffer(transaction_, false);
  }
  end_transaction();
}

void UsbController::out(std::uint8_t address, std::uint8_t endpoint_number, bool setup,
                        Picoseconds at) {
  activity(at);
  transaction_ = {};
  if (!listens() || address != (addr_endp_ & 0x7f)) return;
  if (setup && endpoint_number != 0) return;
  const std::optional<Endpoint> endpoint = find_endpoint(endpoint_number, true);
  if (!endpoint) return;
  transaction_.phase = Phase::out_token;
  transaction_.endpoint = *endpoint;
  const bool ready = (endpoint->word & buffer_control::available) != 0 &&
                     (endpoint->word & buffer_control::full) == 0;
  if (setup)
    transaction_.answer = Answer::setup;  // always accepted (datasheet, 4.1.2.6.1)
  else
    transaction_.answer = refusal(*endpoint).value_or(ready ? Answer::data : Answer::nak);
}

std::optional<Pid> UsbController::out_data(const Packet& packet, Fault fault, Picoseconds at) {
  activity(at);
  if (transaction_.phase != Phase::out_token) return std::nullopt;
  const auto silent = [this](std::uint32_t error) -> std::optional<Pid> {
    latched_ |= error;
    end_transaction();
    return std::nullopt;
  };
  if (fault == Fault::lost) return silent(sie_status::rx_timeout);
  const Endpoint& endpoint = transaction_.endpoint;
  const bool data1 = packet.pid == Pid::data1;
  const std::uint32_t room = endpoint.word & buffer_control::length_mask;
  transaction_.data1 = data1;
  transaction_.length = std::min(room, static_cast<std::uint32_t>(packet.size));
  if (transaction_.answer == Answer::data &&
      data1 != ((endpoint.word & buffer_control::pid) != 0)) {
    // A repetition whose ACK was lost: acknowledged, dropped (USB 2.0, 8.6.4).
    if (fault == Fault::none) latched_ |= sie_status::data_seq_error;
    transaction_.answer = Answer::discard;
  }
  // Bytes are written as they arrive; the checksum arrives last.
  if (transaction_.answer == Answer::data)
    for (std::size_t i = 0; i < transaction_.length; ++i)
      dpram_[(endpoint.address() + i) % dpram::size] = packet.bytes[i];
  if (fault == Fault::crc) return silent(sie_status::crc_error);
  if (fault == Fault::bit_stuff) return silent(sie_status::bit_stuff_error);

  transaction_.phase = Phase::out_taken;
  switch (transaction_.answer) {
    case Answer::setup:
      if (data1) return silent(sie_status::data_seq_error);
      if (packet.size != 8) return silent(0);
      set_up(packet);
      return Pid::ack;
    case Answer::data:
      if (packet.size > room)
        violation(endpoint_name(endpoint.index) + ": a packet was longer than the buffer's length");
      return Pid::ack;
    case Answer::discard:
      update_interrupt();
      return Pid::ack;
    case Answer::stall:
      note_refusal(endpoint, Answer::stall);
      return Pid::stall;
    case Answer::nak:
    case Answer::nothing:
      break;
  }
  note_refusal(endpoint, Answer::nak);
  return Pid::nak;
}

/// The setup packet is in place; arms for STALL are dropped, buffers stay as they are.
void UsbController::set_up(const Packet& packet) {
  std::copy_n(packet.bytes.begin(), 8, dpram_.begin() + dpram::setup_packet);
  stall_arm_ = 0;
}

void UsbController::out_end(Picoseconds at) {
  activity(at);
  if (transaction_.phase != Phase::out_taken) return;
  if (transaction_.answer == Answer::setup)
    latched_ |= sie_status::setup_rec;
  else if (transaction_.answer == Answer::data)
    finish_buffer(transaction_, true);
  end_transaction();
}

void UsbController::end_transaction() {
  const std::uint32_t bit = 1u << transaction_.endpoint.index;
  if (transaction_.phase != Phase::idle && (abort_ & bit) != 0) abort_done_ |= bit;
  transaction_.phase = Phase::idle;
  update_interrupt();
}

/// Status phase (datasheet, 4.1.2.6.2): length, PID and last buffer are written to the half of the
/// word, everything else in it is zero; FULL says that an OUT packet is there.
void UsbController::finish_buffer(const Transaction& done, bool full) {
  const Endpoint& endpoint = done.endpoint;
  auto status = static_cast<std::uint16_t>(done.length | (endpoint.word & buffer_control::last));
  if (done.data1) status |= buffer_control::pid;
  if (full) status |= buffer_control::full;
  set_half(dpram::buffer_control + 4 * endpoint.index + 2 * endpoint.buffer, status);
  if ((endpoint.word & buffer_control::last) != 0) latched_ |= sie_status::trans_complete;
  if (endpoint.doubled()) select_ ^= 1u << endpoint.index;
  report_buffer(endpoint);
}

void UsbController::report_buffer(const Endpoint& endpoint) {
  Done& done = done_[endpoint.index];
  if ((endpoint.control & ep_control::int_1buf) == 0) {
    if ((endpoint.control & ep_control::int_2buf) == 0 || !endpoint.doubled()) return;
    done.count ^= 1;
    if (done.count != 0) return;
  }
  if (done.buffers == 0) done.first = static_cast<std::uint8_t>(endpoint.buffer);
  done.buffers |= static_cast<std::uint8_t>(1u << endpoint.buffer);
  buff_status_ |= 1u << endpoint.index;
}

void UsbController::violation(const std::string& text) {
  if (std::find(violations_.begin(), violations_.end(), text) == violations_.end())
    violations_.push_back(text);
}

}  // namespace lamplock::sim::chip
