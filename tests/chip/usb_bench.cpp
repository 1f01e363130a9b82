#include "tests/chip/usb_bench.hpp"

#include <algorithm>

namespace lamplock::sim::chip::rigs {

namespace {

namespace in = usb::interrupt;
namespace st = usb::sie_status;

Bytes string_descriptor(const std::string& text) {
  Bytes bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char c : text) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  return bytes;
}

}  // namespace

FakeCdc::FakeCdc(UsbBench& bench, FakeOptions fake_options) : options(fake_options), bench_(bench) {
  device_descriptor = {18, 1, 0x00, 0x02, 0xef, 2, 1, 64, 0x8a, 0x2e, 0x0a, 0, 0, 1, 1, 2, 3, 1};
  configuration_descriptor = {9, 2,    75,   0,    2,  1,  0,  0xa0, 50,  // configuration
                              8, 11,   0,    2,    2,  2,  0,  0,         // association
                              9, 4,    0,    0,    1,  2,  2,  0,    0,   // control interface
                              5, 0x24, 0,    0x10, 1,                     // header
                              5, 0x24, 1,    0,    1,                     // call management
                              4, 0x24, 2,    2,                           // ACM
                              5, 0x24, 6,    0,    1,                     // union
                              7, 5,    0x81, 3,    16, 0,  16,            // notifications
                              9, 4,    1,    0,    2,  10, 0,  0,    0,   // data interface
                              7, 5,    0x82, 2,    64, 0,  0,             // bulk IN
                              7, 5,    0x02, 2,    64, 0,  0};            // bulk OUT
}

void FakeCdc::start() {
  bench_.write(reg::usb_muxing, 1 | 8);
  bench_.write(reg::usb_pwr, 4 | 8);
  bench_.write(reg::main_ctrl, 1);
  bench_.write(reg::sie_ctrl, usb::sie_ctrl::ep0_int_1buf);
  bench_.write(reg::inte, in::buff_status | in::bus_reset | in::setup_req | in::dev_suspend |
                              in::dev_resume_from_host | in::dev_sof);
  const std::uint32_t flags = 1u << 31 | 1u << 29 | (options.doubled ? 1u << 30 : 0);
  bench_.store(0x08, 1u << 31 | 1u << 29 | 3u << 26 | 0x180);  // EP1 IN
  bench_.store(0x10, flags | 2u << 26 | 0x200);                // EP2 IN
  bench_.store(0x14, flags | 2u << 26 | 0x300);                // EP2 OUT
  bench_.write(reg::sie_ctrl, usb::sie_ctrl::ep0_int_1buf | usb::sie_ctrl::pullup_en);
}

void FakeCdc::interrupt() {
  const std::uint32_t status = bench_.read(reg::ints);
  if ((status & in::dev_sof) != 0) {
    frame_at_ = bench_.now();
    bench_.read(reg::sof_rd);
    if (configured) feed_in();
  }
  if ((status & in::bus_reset) != 0) {
    bench_.write(reg::sie_status, st::bus_reset);
    bus_reset();
  }
  if ((status & in::dev_suspend) != 0) {
    if ((bench_.read(reg::sie_status) & st::suspended) != 0) ++suspends;
    bench_.write(reg::sie_status, st::suspended);
  }
  if ((status & in::dev_resume_from_host) != 0) {
    ++resumes;
    bench_.write(reg::sie_status, st::resume);
  }
  // Handles buffers before the setup packet: they belong to the previous transfer.
  if ((status & in::buff_status) != 0) {
    const std::uint32_t done = bench_.read(reg::buff_status);
    for (std::uint32_t index = 0; index < 32; ++index)
      if ((done & 1u << index) != 0) buffer_done(index);
  }
  if ((status & in::setup_req) != 0) {
    bench_.write(reg::sie_status, st::setup_rec);
    setup();
  }
}

void FakeCdc::bus_reset() {
  ++resets;
  bench_.write(reg::addr_endp, 0);
  bench_.write(reg::buff_status, 0xffffffff);
  bench_.write(reg::buff_status, 0xffffffff);
  for (std::uint32_t index = 0; index < 6; ++index) bench_.store(0x80 + 4 * index, 0);
  configured = false;
  new_address_ = -1;
  line_coding_due_ = false;
  to_send_.clear();
}

void FakeCdc::setup() {
  ++setups;
  bench_.store(0x80, 0);
  bench_.store(0x84, 0);
  new_address_ = -1;
  line_coding_due_ = false;
  const Bytes packet(bench_.dpram.begin(), bench_.dpram.begin() + 8);
  const std::size_t length = static_cast<std::size_t>(packet[6] | packet[7] << 8);
  if (packet[0] == 0x21 && packet[1] == 0x20) {
    line_coding_due_ = true;
    bench_.arm(1, 0, bc::pid | 64);
  } else if (packet[0] == 0xa1 && packet[1] == 0x21) {
    answer(line_coding_, length);
  } else if (packet[0] == 0x21 && packet[1] == 0x22) {
    dtr = (packet[2] & 1) != 0;
    answer({}, 0);
  } else if (packet[0] == 0x40 && packet[1] == 0x7e) {  // never answered
  } else {
    standard(packet);
  }
}

void FakeCdc::standard(const Bytes& packet) {
  const std::size_t length = static_cast<std::size_t>(packet[6] | packet[7] << 8);
  switch (packet[1]) {
    case 5:
      new_address_ = packet[2];
      return answer({}, 0);
    case 9:
      configure();
      return answer({}, 0);
    case 1:  // CLEAR_FEATURE, endpoint halt
      reset_pipe(packet[4] == 0x82 ? in_ : out_);
      answer({}, 0);
      feed_in();
      return feed_out();
    case 6:
      break;
    default:
      return stall_ep0();
  }
  if (packet[3] == 1) return answer(device_descriptor, length);
  if (packet[3] == 2) return answer(configuration_descriptor, length);
  if (packet[3] == 3 && packet[2] == 0) return answer({4, 3, 9, 4}, length);
  if (packet[3] == 3 && packet[2] <= strings.size())
    return answer(string_descriptor(strings[packet[2] - 1u]), length);
  stall_ep0();
}

void FakeCdc::answer(Bytes data, std::size_t length) {
  ep0_data_ = std::move(data);
  if (ep0_data_.size() > length) ep0_data_.resize(length);
  ep0_sent_ = 0;
  ep0_data1_ = true;
  ep0_in_ = length != 0;
  send_ep0();
}

void FakeCdc::send_ep0() {
  const std::size_t size = std::min<std::size_t>(64, ep0_data_.size() - ep0_sent_);
  std::copy_n(ep0_data_.begin() + static_cast<std::ptrdiff_t>(ep0_sent_), size,
              bench_.dpram.begin() + 0x100);
  ep0_sent_ += size;
  // The host may enter the status stage although its last ACK was lost.
  if (ep0_in_ && ep0_sent_ == ep0_data_.size()) accept_status();
  const std::uint32_t fields = bc::full | (ep0_data1_ ? bc::pid : 0u);
  ep0_data1_ = !ep0_data1_;
  bench_.arm(0, 0, fields | static_cast<std::uint32_t>(size));
}

void FakeCdc::accept_status() { bench_.arm(1, 0, bc::pid | 64); }

void FakeCdc::stall_ep0() {
  bench_.write(reg::ep_stall_arm, 3);
  bench_.store_half(0x80, bc::stall);
  bench_.store_half(0x84, bc::stall);
}

void FakeCdc::buffer_done(std::uint32_t index) {
  const std::uint32_t buffer = bench_.read(reg::buff_cpu_should_handle) >> index & 1u;
  const std::uint16_t word = bench_.load_half(UsbBench::control_word(index, buffer));
  bench_.write(reg::buff_status, 1u << index);
  if (index == 0) {
    if (new_address_ >= 0) bench_.write(reg::addr_endp, static_cast<std::uint32_t>(new_address_));
    new_address_ = -1;
    if (ep0_in_ && ep0_sent_ < ep0_data_.size()) send_ep0();
  } else if (index == 1) {
    // If the ACK was lost the host repeats DATA1: it is acknowledged and dropped only while a
    // buffer for DATA0 is armed, else refused for ever.
    bench_.arm(1, 0, 64);
    if (!line_coding_due_) return;
    line_coding_due_ = false;
    std::copy_n(bench_.dpram.begin() + 0x100, 7, line_coding_.begin());
    answer({}, 0);
  } else if (index == 4) {
    --in_.armed;
    feed_in();
  } else if (index == 5) {
    --out_.armed;
    const auto first = bench_.dpram.begin() + address(out_, buffer);
    auto& queue = to_send_;
    if (options.echo)
      queue.insert(queue.end(), first, first + (word & 0x3ff));
    else
      received.insert(received.end(), first, first + (word & 0x3ff));
    feed_in();
    feed_out();
  }
}

void FakeCdc::configure() {
  configured = true;
  to_send_.clear();
  zero_length_due_ = false;
  reset_pipe(in_);
  reset_pipe(out_);
  feed_out();
}

void FakeCdc::reset_pipe(Pipe& pipe) {
  // First aborts the buffers that the controller holds.
  bench_.write(reg::ep_abort, 1u << pipe.index);
  bench_.write(reg::ep_abort_done, 1u << pipe.index);
  bench_.store(UsbBench::control_word(pipe.index), 0);
  bench_.write(reg::ep_abort, 0);
  pipe.next = pipe.armed = 0;
  pipe.data1 = false;
  pipe.reset_select = true;
}

void FakeCdc::arm(Pipe& pipe, std::uint32_t length, bool full) {
  std::uint32_t fields = length | (pipe.data1 ? bc::pid : 0u) | (full ? bc::full : 0u);
  if (pipe.reset_select && pipe.next == 0) fields |= bc::select_reset;
  pipe.reset_select = false;
  bench_.arm(pipe.index, pipe.next, fields);
  pipe.data1 = !pipe.data1;
  pipe.next = (pipe.next + 1) % buffers();
  ++pipe.armed;
}

bool FakeCdc::late() const {
  return options.avoid_e15 && bench_.now() - frame_at_ > 790 * ps_per_us;
}

void FakeCdc::feed_in() {
  while (in_.armed < buffers() && (!to_send_.empty() || zero_length_due_) && !late()) {
    const std::size_t size = std::min<std::size_t>(64, to_send_.size());
    std::copy_n(to_send_.begin(), size, bench_.dpram.begin() + address(in_, in_.next));
    to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(size));
    zero_length_due_ = options.zero_length && size == 64 && to_send_.empty();
    arm(in_, static_cast<std::uint32_t>(size), true);
  }
  if (configured && to_send_.size() < options.room) feed_out();
}

void FakeCdc::feed_out() {
  while (configured && !paused && out_.armed < buffers() && to_send_.size() < options.room)
    arm(out_, 64, false);
}

void FakeCdc::send(const Bytes& bytes) {
  to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
  feed_in();
}

void FakeCdc::stall_bulk(bool in) {
  Pipe& pipe = in ? in_ : out_;
  bench_.store_half(UsbBench::control_word(pipe.index), bc::stall);
  bench_.store_half(UsbBench::control_word(pipe.index, 1), 0);
}

void FakeCdc::wake_host() {
  bench_.write(reg::sie_ctrl, bench_.read(reg::sie_ctrl) | usb::sie_ctrl::resume);
}

}  // namespace lamplock::sim::chip::rigs
