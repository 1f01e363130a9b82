#include "sim/trace/vcd_file.hpp"

#include <algorithm>
#include <iterator>

namespace lamplock::sim {
namespace {

/// Changes older than this, relative to the newest one, are written without a flush(): slices of
/// time of boards are shorter.
constexpr Picoseconds reorder_window = 100 * ps_per_ms;
constexpr std::size_t first_flush_size = 65'536;

/// Identifier codes are printable characters from '!' on.
char code(std::size_t signal) { return static_cast<char>('!' + signal); }

}  // namespace

VcdFile::VcdFile(std::ostream& out, std::string_view scope, std::span<const Signal> signals)
    : out_(out), flush_size_(first_flush_size) {
  out_ << "$version lamplock $end\n$timescale 1 ps $end\n$scope module " << scope << " $end\n";
  for (std::size_t i = 0; i < signals.size(); ++i)
    out_ << "$var wire 1 " << code(i) << ' ' << signals[i].name << " $end\n";
  out_ << "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n";
  for (std::size_t i = 0; i < signals.size(); ++i)
    out_ << (signals[i].level ? '1' : '0') << code(i) << '\n';
  out_ << "$end\n";
}

void VcdFile::change(std::size_t signal, bool level, Picoseconds at) {
  pending_.push_back({at, signal, level});
  newest_ = std::max(newest_, at);
  if (pending_.size() < flush_size_) return;
  flush(newest_ - reorder_window);
  flush_size_ = std::max(first_flush_size, 2 * pending_.size());
}

void VcdFile::flush(Picoseconds up_to) {
  const auto by_time = [](const Change& a, const Change& b) { return a.at < b.at; };
  std::stable_sort(pending_.begin(), pending_.end(), by_time);
  const auto end = std::partition_point(pending_.begin(), pending_.end(),
                                        [up_to](const Change& c) { return c.at < up_to; });
  write_until(static_cast<std::size_t>(std::distance(pending_.begin(), end)));
}

void VcdFile::write_until(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const Change& change = pending_[i];
    if (change.at < written_to_) ++late_;
    write_time(change.at);
    out_ << (change.level ? '1' : '0') << code(change.signal) << '\n';
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(count));
}

void VcdFile::write_time(Picoseconds at) {
  if (at <= written_to_) return;
  written_to_ = at;
  out_ << '#' << at << '\n';
}

void VcdFile::finish(Picoseconds end) {
  flush(std::max(newest_, end) + 1);
  write_time(end);
  out_.flush();
}

}  // namespace lamplock::sim
