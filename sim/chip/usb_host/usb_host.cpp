#include "sim/chip/usb_host/usb_host.hpp"

#include <algorithm>

namespace lamplock::sim::chip {

using namespace usb;

namespace {

constexpr Picoseconds frame_length = ps_per_ms;
/// Before the next SOF: its token, which is reported at its end, and the time in which hubs cut
/// transactions off (EOF1; USB 2.0, 11.2.5); the length is assumed.
constexpr Picoseconds frame_margin = bit_times(64);
constexpr Picoseconds stranger_interval = 250 * ps_per_us;
constexpr int max_attempts = 3;
constexpr int max_errors = 3;  ///< in a row (USB 2.0, 8.7.1)
/// A control transfer is aborted after this time (USB 2.0, 9.2.6.1).
constexpr Picoseconds control_limit = 5 * ps_per_s;
/// A stage without data, and the first data packet (USB 2.0, 9.2.6.4).
constexpr Picoseconds status_limit = 50 * ps_per_ms;
constexpr Picoseconds data_limit = 500 * ps_per_ms;

/// Requests (USB 2.0, table 9-4; PSTN 1.2, table 13).
enum Request : std::uint8_t {
  clear_feature = 1,
  set_address = 5,
  get_descriptor = 6,
  set_configuration = 9,
  set_line_coding = 0x20,
  get_line_coding = 0x21,
  set_control_line_state = 0x22
};

/// 115200 baud, 8 data bits, no parity, 1 stop bit.
const std::vector<std::uint8_t> line_coding = {0x00, 0xc2, 0x01, 0x00, 0, 0, 8};

std::array<std::uint8_t, 8> setup_packet(std::uint8_t type, std::uint8_t request,
                                         std::uint16_t value, std::uint16_t index,
                                         std::size_t length) {
  const auto low = [](std::size_t v) { return static_cast<std::uint8_t>(v); };
  const auto high = [](std::size_t v) { return static_cast<std::uint8_t>(v >> 8); };
  return {type,       request,     low(value),  high(value),
          low(index), high(index), low(length), high(length)};
}

}  // namespace

UsbHost::UsbHost(TimeWheel& wheel, DeviceEnd& device, UsbHostOptions options)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      device_(device),
      options_(options),
      engine_(wheel, device) {
  bulk(UsbFunction::serial).open = true;
  engine_.on_done([this](const Transaction& t, const Result& r) { done(t, r); });
  plug();
}

UsbHost::~UsbHost() { device_.connect(nullptr, wheel_.time()); }

// Time

void UsbHost::plan() {
  Picoseconds due = never;
  for (const Picoseconds time : {wait_until_, next_frame_, next_stranger_})
    if (time >= 0) due = std::min(due, time);
  wheel_.set(slot_, wheel_.cycle_at(due));
}

void UsbHost::wait(Picoseconds until) {
  wait_until_ = until;
  plan();
}

void UsbHost::run(Cycle) {
  const Picoseconds at = wheel_.time();
  if (next_stranger_ >= 0 && next_stranger_ <= at) {
    device_.other_traffic(next_stranger_);
    next_stranger_ += stranger_interval;
  }
  if (wait_until_ >= 0 && wait_until_ <= at) {
    const Picoseconds was = wait_until_;
    wait_until_ = -1;
    waited(was);
  }
  if (next_frame_ >= 0 && next_frame_ <= at) frame(next_frame_);
  plan();
}

void UsbHost::start_frames(Picoseconds at) {
  next_frame_ = at + bit_times(token_bits);
  last_frame_ = -1;
  if (options_.other_traffic) next_stranger_ = at + stranger_interval / 2;
  plan();
}

void UsbHost::stop_frames() {
  next_frame_ = last_frame_ = next_stranger_ = -1;
  engine_.abandon();
  turn_ = Turn::none;
  plan();
}

/// SOF has just ended.
void UsbHost::frame(Picoseconds at) {
  if (last_frame_ >= 0)
    statistics_.max_frame_gap = std::max(statistics_.max_frame_gap, at - last_frame_);
  last_frame_ = at;
  next_frame_ = at + frame_length;
  ++statistics_.frames;
  bulk_in_frame_ = 0;
  frame_number_ = (frame_number_ + 1) & 0x7ff;
  device_.start_of_frame(frame_number_, at);
  check_control_times(at);
  begin_transaction(at + bit_times(gap_bits));
}

// The user's side

std::size_t UsbHost::write(std::span<const std::uint8_t> bytes, UsbFunction to) {
  BulkFunction& function = bulk(to);
  if (step_ != Step::running || !function.open || !function.ends.found()) return 0;
  const std::size_t used = function.unsent();
  const std::size_t room = options_.write_buffer > used ? options_.write_buffer - used : 0;
  const std::size_t count = function.write(bytes, room);
  if (count != 0) begin_transaction(wheel_.time());
  return count;
}

std::size_t UsbHost::read(std::span<std::uint8_t> bytes, UsbFunction from) {
  const std::size_t count = bulk(from).read(bytes);
  if (count != 0) begin_transaction(wheel_.time());
  return count;
}

void UsbHost::claim_vendor(bool claimed) {
  bulk(UsbFunction::vendor).open = claimed;
  begin_transaction(wheel_.time());
}

void UsbHost::open_serial(bool open) {
  bulk(UsbFunction::serial).open = open;
  begin_transaction(wheel_.time());
}

void UsbHost::plug() {
  if (plugged_) return;
  plugged_ = true;
  statistics_ = {};
  device_.connect(this, wheel_.time());
  if (device_.pull_up()) pull_up_changed(true, wheel_.time());
}

void UsbHost::unplug() {
  if (!plugged_) return;
  plugged_ = false;
  detach();
  device_.connect(nullptr, wheel_.time());
}

void UsbHost::detach() {
  stop_frames();
  wait(-1);
  step_ = Step::detached;
  attempts_ = 0;
  clear_port();
}

void UsbHost::clear_port() {
  for (BulkFunction& function : bulk_) function.clear();
  notify_data1_ = false;
  transfer_now_.reset();
  control_queue_.clear();
  configuration_ = {};
  microsoft_.reset();
  microsoft_set_.reset();
}

void UsbHost::suspend() {
  if (step_ != Step::running) return;
  step_ = Step::suspended;
  stop_frames();
}

void UsbHost::resume() {
  if (step_ != Step::suspended) return;
  step_ = Step::resuming;
  device_.begin_resume(wheel_.time());
  wait(wheel_.time() + options_.resume);
}

void UsbHost::remote_wakeup(Picoseconds) {
  if (!configuration_.remote_wakeup)
    violation("remote wake-up that the configuration does not announce");
  resume();
}

void UsbHost::reset_device() {
  if (!plugged_ || !device_.pull_up()) return;
  stop_frames();
  clear_port();
  begin_reset(wheel_.time(), Step::reset);
}

void UsbHost::set_dtr(bool on) {
  dtr_ = on;
  if (step_ == Step::running)
    control(setup_packet(0x21, set_control_line_state, on ? 3 : 2,
                         configuration_.port.control_interface, 0));
}

void UsbHost::control(const std::array<std::uint8_t, 8>& setup, std::vector<std::uint8_t> data) {
  ControlTransfer transfer;
  transfer.setup = setup;
  transfer.data = std::move(data);
  transfer.user = true;
  last_control_ = {};
  control_queue_.push_back(std::move(transfer));
  begin_transaction(wheel_.time());
}

void UsbHost::violation(const std::string& text) {
  if (std::find(violations_.begin(), violations_.end(), text) == violations_.end())
    violations_.push_back(text);
}

// Attachment and enumeration

void UsbHost::pull_up_changed(bool on, Picoseconds at) {
  if (!plugged_) return;
  if (!on) return detach();
  step_ = Step::debounce;
  wait(at + options_.debounce);
}

void UsbHost::begin_reset(Picoseconds at, Step step) {
  step_ = step;
  stop_frames();
  transfer_now_.reset();
  address_ = 0;
  device_info_ = {};
  device_info_.max_packet0 = max_packet;  // until the device has said it
  device_.begin_reset(at);
  wait(at + options_.reset);
}

/// The waiting time of a step is over.
void UsbHost::waited(Picoseconds at) {
  switch (step_) {
    case Step::debounce:
      begin_reset(at, Step::reset);
      break;
    case Step::reset:
    case Step::second_reset:
      device_.end_reset(at);
      start_frames(at);
      wait(at + options_.reset_recovery);
      step_ = step_ == Step::reset ? Step::first_descriptor : Step::set_address;
      break;
    case Step::resuming:
      device_.end_resume(at);
      start_frames(at);
      step_ = Step::running;
      // No traffic during recovery: the device hears frames only.
      wait(at + options_.resume_recovery);
      break;
    case Step::running:
      begin_transaction(at);
      break;
    default:
      enter(step_);
      break;
  }
}

/// Sends the request of a step of enumeration.
void UsbHost::enter(Step step) {
  step_ = step;
  switch (step) {
    case Step::first_descriptor:
      ask_descriptor(descriptor::device, 0, 0, options_.second_reset ? 64 : 8);
      break;
    case Step::set_address:
      ask(setup_packet(0, set_address, options_.address, 0, 0));
      break;
    case Step::device:
      ask_descriptor(descriptor::device, 0, 0, 18);
      break;
    case Step::qualifier:
      ask_descriptor(descriptor::device_qualifier, 0, 0, 10);
      break;
    case Step::bos_head:
      ask_descriptor(descriptor::bos, 0, 0, 5);
      break;
    case Step::bos:
      ask_descriptor(descriptor::bos, 0, 0, bos_size_);
      break;
    case Step::microsoft_set:
      ask(setup_packet(0xc0, microsoft_->request, 0, microsoft_set_index, microsoft_->set_size));
      break;
    case Step::configuration_head:
      ask_descriptor(descriptor::configuration, 0, 0, 9);
      break;
    case Step::configuration:
      ask_descriptor(
          descriptor::configuration, 0, 0,
          static_cast<std::size_t>(configuration_bytes_[2] | configuration_bytes_[3] << 8));
      break;
    case Step::languages:
      ask_descriptor(descriptor::string, 0, 0, 255);
      break;
    case Step::strings:
      next_string();
      break;
    case Step::set_configuration:
      ask(setup_packet(0, set_configuration, configuration_.value, 0, 0));
      break;
    case Step::set_line_coding:
      ask(setup_packet(0x21, set_line_coding, 0, configuration_.port.control_interface,
                       line_coding.size()),
          line_coding);
      break;
    case Step::get_line_coding:
      ask(setup_packet(0xa1, get_line_coding, 0, configuration_.port.control_interface,
                       line_coding.size()));
      break;
    case Step::line_state:
      ask(setup_packet(0x21, set_control_line_state, dtr_ ? 3 : 2,
                       configuration_.port.control_interface, 0));
      break;
    default:
      break;
  }
}

void UsbHost::ask(std::array<std::uint8_t, 8> setup, std::vector<std::uint8_t> data) {
  transfer_now_ = ControlTransfer{};
  transfer_now_->setup = setup;
  transfer_now_->data = std::move(data);
  begin_transaction(wheel_.time());
}

void UsbHost::ask_descriptor(std::uint8_t type, std::uint8_t index, std::uint16_t language,
                             std::size_t length) {
  ask(setup_packet(0x80, get_descriptor, static_cast<std::uint16_t>(type << 8 | index), language,
                   length));
}

void UsbHost::fail_enumeration(const std::string& why) {
  if (++attempts_ < max_attempts) return begin_reset(wheel_.time(), Step::reset);
  violation("enumeration failed: " + why);
  step_ = Step::failed;
  transfer_now_.reset();
}

void UsbHost::control_done(const ControlTransfer& transfer, const ControlAnswer& answer,
                           Picoseconds at) {
  if (transfer.user) {
    last_control_ = answer;
    return;
  }
  // Only the device qualifier may be refused, by a device without high speed.
  const bool refused = step_ == Step::qualifier ? answer.failed : answer.failed || answer.stalled;
  if (refused)
    return fail_enumeration("request " + std::to_string(transfer.setup[1]) + " for " +
                            std::to_string(transfer.setup[3]) +
                            (answer.stalled ? " was refused" : " got no answer"));
  enumeration_answer(answer, at);
}

void UsbHost::enumeration_answer(const ControlAnswer& answer, Picoseconds at) {
  switch (step_) {
    case Step::first_descriptor:
      if (answer.data.size() < 8)
        return fail_enumeration("less than 8 bytes of the device descriptor");
      device_bytes_ = answer.data;
      if (options_.second_reset) begin_reset(at, Step::second_reset);
      device_info_.max_packet0 = device_bytes_[7];
      if (options_.second_reset) return;
      return enter(Step::set_address);
    case Step::set_address:
      address_ = options_.address;
      step_ = Step::device;
      return wait(at + options_.address_recovery);
    case Step::device:
    case Step::qualifier:
    case Step::bos_head:
    case Step::bos:
    case Step::microsoft_set:
    case Step::configuration_head:
    case Step::configuration:
    case Step::languages:
    case Step::strings:
      return descriptor_answer(answer);
    default:
      return class_answer(answer);
  }
}

void UsbHost::descriptor_answer(const ControlAnswer& answer) {
  switch (step_) {
    case Step::device:
      if (!std::equal(device_bytes_.begin(),
                      device_bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                  device_bytes_.size(), answer.data.size())),
                      answer.data.begin()))
        violation("device: descriptor differs from the first one read");
      device_bytes_ = answer.data;
      device_info_ = parse_device(answer.data, violations_);
      if (device_info_.max_packet0 == 0) return fail_enumeration("device descriptor is useless");
      return enter(Step::qualifier);
    case Step::qualifier:
      if (!answer.stalled) violation("device: has a device qualifier without high speed");
      // USB 2.1 and later have a BOS descriptor.
      return enter(device_info_.version >= 0x0201 ? Step::bos_head : Step::configuration_head);
    case Step::bos_head:
    case Step::bos:
    case Step::microsoft_set:
      if (!bos_answer(answer)) enter(Step::configuration_head);
      return;
    case Step::configuration_head:
      configuration_bytes_ = answer.data;
      if (answer.data.size() != 9) return fail_enumeration("not 9 bytes of the configuration");
      return enter(Step::configuration);
    case Step::configuration:
      configuration_bytes_ = answer.data;
      configuration_ = parse_configuration(answer.data, device_info_, violations_);
      if (!configuration_.port.found()) return fail_enumeration("no serial port");
      bulk(UsbFunction::serial).ends = configuration_.port;
      bulk(UsbFunction::vendor).ends = configuration_.vendor;
      strings_to_read_.assign(configuration_.strings.begin(), configuration_.strings.end());
      for (const int index : {device_info_.serial_string, device_info_.product_string,
                              device_info_.manufacturer_string})
        if (index != 0) strings_to_read_.push_back(index);
      strings_.clear();
      if (strings_to_read_.empty()) return enter(Step::set_configuration);
      return enter(Step::languages);
    case Step::languages:
      if (answer.data.size() < 4 || answer.data[0] != answer.data.size())
        violation("string 0: no list of languages");
      else
        language_ = static_cast<std::uint16_t>(answer.data[2] | answer.data[3] << 8);
      return enter(Step::strings);
    default: {  // a string
      const int index = strings_to_read_.back();
      strings_to_read_.pop_back();
      strings_[index] = parse_string(answer.data, index, violations_);
      if (!next_string()) enter(Step::set_configuration);
    }
  }
}

/// Continues with the contents of the BOS descriptor; false if there is no more.
bool UsbHost::bos_answer(const ControlAnswer& answer) {
  if (step_ == Step::bos_head) {
    bos_size_ = parse_bos_head(answer.data, violations_);
    if (bos_size_ != 0) enter(Step::bos);
    return bos_size_ != 0;
  }
  if (step_ == Step::bos) {
    microsoft_ = parse_bos(answer.data, violations_);
    if (!microsoft_ || !options_.windows) return false;
    enter(Step::microsoft_set);
    return true;
  }
  microsoft_set_ = parse_microsoft_set(answer.data, *microsoft_, violations_);
  return false;
}

/// Asks for the next string that has not been read; false if there is none.
bool UsbHost::next_string() {
  while (!strings_to_read_.empty() && strings_.contains(strings_to_read_.back()))
    strings_to_read_.pop_back();
  if (strings_to_read_.empty()) return false;
  ask_descriptor(descriptor::string, static_cast<std::uint8_t>(strings_to_read_.back()), language_,
                 255);
  return true;
}

void UsbHost::class_answer(const ControlAnswer& answer) {
  switch (step_) {
    case Step::set_configuration:
      for (BulkFunction& function : bulk_) function.clear_toggles();
      notify_data1_ = false;
      return enter(Step::set_line_coding);
    case Step::set_line_coding:
      return enter(Step::get_line_coding);
    case Step::get_line_coding:
      if (answer.data != line_coding) violation("GET_LINE_CODING differs from what was set");
      return enter(Step::line_state);
    default:
      step_ = Step::running;
  }
}

// Transactions

/// Starts the next transaction, if the bus is free and the frame has room.
void UsbHost::begin_transaction(Picoseconds at) {
  if (engine_.busy() || next_frame_ < 0 || last_frame_ < 0) return;
  at = std::max({at, last_frame_ + bit_times(gap_bits), bus_free_});
  if (wait_until_ >= 0) return;  // recovery
  if (!transfer_now_ && !control_queue_.empty()) {
    transfer_now_ = std::move(control_queue_.front());
    control_queue_.pop_front();
  }
  turn_ = choose(at);
  switch (turn_) {
    case Turn::none:
      return;
    case Turn::control:
      return launch(control_transaction(), at);
    case Turn::interrupt:
      interrupt_due_ = last_frame_ + configuration_.port.notify_interval_ms * ps_per_ms;
      return launch({.token = Pid::in, .endpoint = configuration_.port.notify, .data = {}}, at);
    case Turn::bulk_in:
    case Turn::vendor_in:
      return launch({.token = Pid::in, .endpoint = bulk(function_of(turn_)).ends.in, .data = {}},
                    at);
    case Turn::bulk_out:
    case Turn::vendor_out: {
      BulkFunction& function = bulk(function_of(turn_));
      return launch({.token = Pid::out,
                     .endpoint = function.ends.out,
                     .data = function.next_packet(options_.send_zero_length)},
                    at);
    }
  }
}

/// The periodic endpoint first; then in turn control, bulk IN and OUT of both functions.
UsbHost::Turn UsbHost::choose(Picoseconds at) {
  if (can_take(Turn::interrupt, at)) return Turn::interrupt;
  static constexpr std::array<Turn, 5> order = {Turn::control, Turn::bulk_in, Turn::bulk_out,
                                                Turn::vendor_in, Turn::vendor_out};
  const auto last = std::find(order.begin(), order.end(), last_turn_);
  const std::size_t first =
      last == order.end() ? 0 : static_cast<std::size_t>(last - order.begin()) + 1;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Turn turn = order[(first + i) % order.size()];
    if (!can_take(turn, at)) continue;
    last_turn_ = turn;
    return turn;
  }
  return Turn::none;
}

bool UsbHost::can_take(Turn turn, Picoseconds at) const {
  const bool running = step_ == Step::running;
  const BulkFunction& function = bulk(function_of(turn));
  const SerialPort& port = configuration_.port;
  switch (turn) {
    case Turn::control:
      return transfer_now_.has_value() && fits(max_packet, at);
    case Turn::interrupt:
      return running && port.notify != 0 && last_frame_ >= interrupt_due_ &&
             fits(port.notify_size, at);
    case Turn::bulk_in:
    case Turn::vendor_in:
      return running && function.open && function.ends.found() &&
             function.received.size() + function.transfer.size() < options_.read_buffer &&
             fits(function.ends.in_size, at);
    case Turn::bulk_out:
    case Turn::vendor_out:
      return running && function.has_packet() && fits(function.next_size(), at);
    case Turn::none:
      break;
  }
  return false;
}

bool UsbHost::fits(std::size_t payload, Picoseconds at) const {
  return at + bit_times(transaction_bits(payload)) <= next_frame_ - frame_margin;
}

void UsbHost::launch(Transaction transaction, Picoseconds at) {
  transaction.address = address_;
  if (fault_injector_) fault_injector_(transaction);
  engine_.start(transaction, at);
}

void UsbHost::done(const Transaction& transaction, const Result& result) {
  bus_free_ = result.end;
  if (!result.answer) ++statistics_.silences;
  switch (turn_) {
    case Turn::control:
      control_result(transaction, result);
      break;
    case Turn::interrupt:
      interrupt_result(result);
      break;
    case Turn::bulk_in:
    case Turn::vendor_in:
      bulk_in_result(bulk(function_of(turn_)), result);
      break;
    case Turn::bulk_out:
    case Turn::vendor_out:
      bulk_out_result(bulk(function_of(turn_)), result);
      break;
    case Turn::none:
      break;
  }
  begin_transaction(result.end);
}

Transaction UsbHost::control_transaction() {
  ControlTransfer& transfer = *transfer_now_;
  if (transfer.started < 0) transfer.started = transfer.stage_started = wheel_.time();
  Transaction transaction;
  transaction.data.pid = transfer.data1 ? Pid::data1 : Pid::data0;
  if (transfer.stage == Stage::setup) {
    transaction.token = Pid::setup;
    transaction.data.size = 8;
    std::copy(transfer.setup.begin(), transfer.setup.end(), transaction.data.bytes.begin());
    return transaction;
  }
  const bool in = transfer.is_in() == (transfer.stage == Stage::data);
  // Without data stage the status stage is IN (USB 2.0, 8.5.3).
  const bool status_in = transfer.stage == Stage::status && transfer.length() == 0;
  transaction.token = in || status_in ? Pid::in : Pid::out;
  if (transaction.token == Pid::out && transfer.stage == Stage::data) {
    const std::size_t size =
        std::min<std::size_t>(transfer.data.size() - transfer.sent, device_info_.max_packet0);
    std::copy_n(transfer.data.begin() + static_cast<std::ptrdiff_t>(transfer.sent), size,
                transaction.data.bytes.begin());
    transaction.data.size = size;
  }
  return transaction;
}

void UsbHost::control_result(const Transaction& transaction, const Result& result) {
  if (!transfer_now_) return;
  ControlTransfer& transfer = *transfer_now_;
  if (!result.answer) {
    if (++transfer.errors >= max_errors) finish_control({.failed = true, .data = {}}, result.end);
    return;
  }
  transfer.errors = 0;
  if (*result.answer == Pid::stall) {
    ++statistics_.stalls;
    return finish_control({.stalled = true, .data = {}}, result.end);
  }
  if (*result.answer == Pid::nak) {
    if (transfer.stage == Stage::setup) violation("a SETUP packet was answered with NAK");
    if (result.end - transfer.started > control_limit)
      finish_control({.failed = true, .data = {}}, result.end);
    return;
  }
  control_progress(transaction, result);
}

/// A packet of a control transfer has got through.
void UsbHost::control_progress(const Transaction& transaction, const Result& result) {
  ControlTransfer& transfer = *transfer_now_;
  const bool in = transaction.token == Pid::in;
  if (in && result.data.pid != (transfer.data1 ? Pid::data1 : Pid::data0)) {
    ++statistics_.repeated;
    if (transfer.stage == Stage::status) violation("status stage with DATA0");
    return;
  }
  const auto advance = [&](Stage stage) {
    transfer.stage = stage;
    transfer.stage_started = result.end;
    // Data begin with DATA1, the status stage always has DATA1 (USB 2.0, 8.5.3).
    transfer.data1 = true;
  };
  if (transfer.stage == Stage::setup) {
    answer_ = {};
    return advance(transfer.length() != 0 ? Stage::data : Stage::status);
  }
  if (transfer.stage == Stage::status) {
    if (in && result.data.size != 0) violation("status stage with data");
    answer_.done = true;
    return finish_control(answer_, result.end);
  }
  transfer.data1 = !transfer.data1;
  transfer.stage_started = result.end;
  if (!in) {
    transfer.sent += transaction.data.size;
    if (transfer.sent >= transfer.data.size()) advance(Stage::status);
    return;
  }
  const auto bytes = result.data.payload();
  answer_.data.insert(answer_.data.end(), bytes.begin(), bytes.end());
  if (answer_.data.size() > transfer.length()) {
    violation("control transfer with more data than requested");
    answer_.data.resize(transfer.length());
  }
  if (bytes.size() < device_info_.max_packet0 || answer_.data.size() == transfer.length())
    advance(Stage::status);
}

void UsbHost::finish_control(const ControlAnswer& answer, Picoseconds at) {
  const ControlTransfer transfer = std::move(*transfer_now_);
  transfer_now_.reset();
  control_done(transfer, answer, at);
}

/// Each stage of a control transfer has a time limit for the device.
void UsbHost::check_control_times(Picoseconds at) {
  if (!transfer_now_ || transfer_now_->started < 0) return;
  const bool data = transfer_now_->stage == Stage::data && transfer_now_->is_in();
  if (at - transfer_now_->stage_started > (data ? data_limit : status_limit))
    violation("control transfer: a stage took longer than " +
              std::string(data ? "500 ms" : "50 ms"));
}

void UsbHost::interrupt_result(const Result& result) {
  if (!result.answer || *result.answer == Pid::nak) return;
  if (*result.answer == Pid::stall) return stalled(configuration_.port.notify | 0x80);
  if (result.data.pid != (notify_data1_ ? Pid::data1 : Pid::data0)) {
    ++statistics_.repeated;
    return;
  }
  notify_data1_ = !notify_data1_;
  ++statistics_.notifications;
}

void UsbHost::bulk_in_result(BulkFunction& function, const Result& result) {
  if (!result.answer) return;
  if (*result.answer == Pid::nak) {
    ++statistics_.in_naks;
    return;
  }
  if (*result.answer == Pid::stall) return stalled(function.ends.in | 0x80);
  if (result.data.pid != (function.in_data1 ? Pid::data1 : Pid::data0)) {
    ++statistics_.repeated;
    return;
  }
  function.in_data1 = !function.in_data1;
  ++statistics_.in_packets;
  statistics_.in_bytes += result.data.size;
  statistics_.max_bulk_packets_in_frame =
      std::max(statistics_.max_bulk_packets_in_frame, ++bulk_in_frame_);
  if (result.data.size > function.ends.in_size)
    violation("bulk IN packet longer than wMaxPacketSize");
  function.take(result.data.payload(), options_.read_transfer);
}

void UsbHost::bulk_out_result(BulkFunction& function, const Result& result) {
  if (!result.answer || !function.packet) return;
  if (*result.answer == Pid::stall) return stalled(function.ends.out);
  if (*result.answer == Pid::nak) {
    ++statistics_.out_naks;
    if (function.refused_since < 0) function.refused_since = result.end;
  }
  if (function.refused_since >= 0)
    statistics_.max_refused =
        std::max(statistics_.max_refused, result.end - function.refused_since);
  if (*result.answer == Pid::nak) return;
  function.refused_since = -1;
  function.out_data1 = !function.out_data1;
  ++statistics_.out_packets;
  statistics_.out_bytes += function.packet->size;
  statistics_.max_bulk_packets_in_frame =
      std::max(statistics_.max_bulk_packets_in_frame, ++bulk_in_frame_);
  function.packet.reset();
}

/// An endpoint is halted: the driver clears it, after which both ends begin with DATA0.
void UsbHost::stalled(std::uint8_t endpoint_address) {
  ++statistics_.stalls;
  if (endpoint_address == (configuration_.port.notify | 0x80)) notify_data1_ = false;
  for (BulkFunction& function : bulk_) {
    if (endpoint_address == (function.ends.in | 0x80)) function.in_data1 = false;
    if (endpoint_address != function.ends.out) continue;
    function.out_data1 = false;
    if (function.packet) function.packet->pid = Pid::data0;
  }
  ControlTransfer clear;
  clear.setup = setup_packet(0x02, clear_feature, 0, endpoint_address, 0);
  clear.user = true;
  for (const ControlTransfer& queued : control_queue_)
    if (queued.setup == clear.setup) return;
  if (transfer_now_ && transfer_now_->setup == clear.setup) return;
  control_queue_.push_back(std::move(clear));
}

}  // namespace lamplock::sim::chip
