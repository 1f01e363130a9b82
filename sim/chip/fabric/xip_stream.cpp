#include "sim/chip/fabric/xip_stream.hpp"

#include <cstring>
#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t count_mask = (1u << 22) - 1u;  // STREAM_CTR (2.6.3.6)

}  // namespace

XipStream::XipStream(TimeWheel& wheel, std::span<std::uint8_t> flash,
                     std::function<std::uint32_t()> word_transfer, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      flash_(flash),
      word_transfer_(std::move(word_transfer)),
      not_modelled_(std::move(not_modelled)) {}

void XipStream::run(Cycle) {
  const Cycle now = wheel_.now();
  if (in_flight_ && end_ <= now) finish();
  if (!in_flight_ && needs() && std::max(end_, resume_) <= now) begin(now);
  plan();
  report_level();
}

void XipStream::begin(Cycle at) {
  in_flight_ = true;
  start_ = at;
  previous_end_ = std::exchange(end_, at + word_transfer_());
}

void XipStream::finish() {
  in_flight_ = false;
  std::memcpy(&fifo_[level_++], &flash_[address_ & (flash_.size() - 1)], sizeof fifo_[0]);
  address_ += sizeof fifo_[0];
  --count_;
}

void XipStream::plan() {
  if (in_flight_)
    wheel_.set(slot_, end_);
  else
    wheel_.set(slot_, needs() ? std::max({wheel_.now(), end_, resume_}) : never_cycle);
}

// The DMA may read the FIFO within this call.
void XipStream::report_level() {
  if (dreqs_ != nullptr) dreqs_->set_level(Dreq::xip_stream, level_);
}

Cycle XipStream::line_transfer(Cycle at, Cycle cycles) {
  if (in_flight_ && start_ >= at) {
    in_flight_ = false;
    end_ = previous_end_;
  }
  const Cycle start = std::max(at, end_);
  resume_ = start + cycles + cooldown;
  if (active()) plan();
  return start;
}

void XipStream::set_readable(bool on) {
  readable_ = on;
  if (!on && in_flight_) in_flight_ = false;
  if (!on && active() && not_modelled_) not_modelled_("XIP stream while no flash is mapped");
  if (active()) plan();
}

void XipStream::write_count(std::uint32_t value) {
  count_ = value & count_mask;
  if (count_ == 0) in_flight_ = false;
  if (active() && !readable_ && not_modelled_) not_modelled_("XIP stream while no flash is mapped");
  plan();
}

std::uint32_t XipStream::pop() {
  if (level_ == 0) {
    if (not_modelled_) not_modelled_("XIP stream FIFO read while empty");
    return 0;
  }
  const std::uint32_t word = std::exchange(fifo_[0], fifo_[1]);
  --level_;
  plan();
  report_level();
  return word;
}

void XipStream::reset() {
  address_ = count_ = 0;
  level_ = 0;
  in_flight_ = false;
  plan();
  report_level();
}

}  // namespace lamplock::sim::chip
