#include "sim/trace/vcd.hpp"

#include <algorithm>
#include <iterator>

#include "sim/world/pin_names.hpp"

namespace lamplock::sim {
namespace {

/// Changes older than this against the newest are written without being told: no board delivers
/// slices of time as long as this.
constexpr Picoseconds reorder_window = 100 * ps_per_ms;
constexpr std::size_t first_flush_size = 65'536;

/// Identifier codes are printable characters from '!' on.
char code(std::size_t pin) { return static_cast<char>('!' + pin); }

}  // namespace

VcdWriter::VcdWriter(std::ostream& out, PinBus& bus) : out_(out), flush_size_(first_flush_size) {
  write_header(bus);
  for (std::size_t pin = 0; pin < pin_count; ++pin) bus.listen(static_cast<Pin>(pin), *this);
}

VcdWriter::~VcdWriter() { finish(); }

void VcdWriter::write_header(const PinBus& bus) {
  out_ << "$version lamplock $end\n$timescale 1 ps $end\n$scope module machine $end\n";
  for (std::size_t pin = 0; pin < pin_count; ++pin)
    out_ << "$var wire 1 " << code(pin) << ' ' << pin_names[pin] << " $end\n";
  out_ << "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n";
  for (std::size_t pin = 0; pin < pin_count; ++pin)
    out_ << (bus.level(static_cast<Pin>(pin)) ? '1' : '0') << code(pin) << '\n';
  out_ << "$end\n";
}

void VcdWriter::pin_changed(Pin pin, bool level, Picoseconds at) {
  pending_.push_back({at, pin, level});
  newest_ = std::max(newest_, at);
  if (pending_.size() < flush_size_) return;
  flush(newest_ - reorder_window);
  flush_size_ = std::max(first_flush_size, 2 * pending_.size());
}

void VcdWriter::flush(Picoseconds up_to) {
  const auto by_time = [](const Change& a, const Change& b) { return a.at < b.at; };
  std::stable_sort(pending_.begin(), pending_.end(), by_time);
  const auto end = std::partition_point(pending_.begin(), pending_.end(),
                                        [up_to](const Change& c) { return c.at < up_to; });
  write_until(static_cast<std::size_t>(std::distance(pending_.begin(), end)));
}

void VcdWriter::write_until(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const Change& change = pending_[i];
    if (change.at < written_to_) ++late_;
    write_time(change.at);
    out_ << (change.level ? '1' : '0') << code(static_cast<std::size_t>(change.pin)) << '\n';
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(count));
}

void VcdWriter::write_time(Picoseconds at) {
  if (at <= written_to_) return;
  written_to_ = at;
  out_ << '#' << at << '\n';
}

void VcdWriter::finish(Picoseconds end) {
  flush(std::max(newest_, end) + 1);
  write_time(end);
  out_.flush();
}

}  // namespace lamplock::sim
