// Signals of one bit as a Value Change Dump (IEEE 1364-2005, clause 18), for GTKWave and others.
//
// In:  changes, which need not come in order of time: they are kept and sorted before they are
//      written. Changes at the same time keep their order.
// Out: text on a stream, timescale 1 ps, the same bytes for the same run.
// Who: the traces of boards and chips, which know the signals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// One file; at most 94 signals.
class VcdFile {
 public:
  struct Signal {
    std::string_view name;
    bool level = false;  ///< at time 0
  };
  /// Writes the header.
  VcdFile(std::ostream& out, std::string_view scope, std::span<const Signal> signals);
  VcdFile(const VcdFile&) = delete;
  VcdFile& operator=(const VcdFile&) = delete;

  void change(std::size_t signal, bool level, Picoseconds at);
  /// No change before `up_to` will come any more: writes all earlier ones.
  void flush(Picoseconds up_to);
  /// Writes the rest and, if later than the last change, the end of time `end`.
  void finish(Picoseconds end);
  /// Changes that came after their time had been written; they appear at the time reached.
  std::uint64_t late_changes() const { return late_; }

 private:
  struct Change {
    Picoseconds at;
    std::size_t signal;
    bool level;
  };
  void write_until(std::size_t count);
  void write_time(Picoseconds at);

  std::ostream& out_;
  std::vector<Change> pending_;
  std::size_t flush_size_;
  Picoseconds newest_ = 0;
  Picoseconds written_to_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace lamplock::sim
