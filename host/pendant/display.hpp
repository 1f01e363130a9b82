// Contents of a pendant's display, and the number format of XHC displays.
//
// In:  values. Out: bytes of feature reports. Who: the jogger fills it in, decoders of pendants
//      with a display encode it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/pendant/event.hpp"
#include "shared/units.hpp"

namespace lamplock::pendant {

/// Function of the wheel.
enum class Mode : std::uint8_t { step, continuous, feed };

/// All values that a display may show.
struct Display {
  PerAxis<double> work_mm{}, machine_mm{};
  Selector selector = Selector::off;
  Mode mode = Mode::step;
  double step_mm = 0;
  int feed_percent = 100, power_percent = 100;
  int feed_mm_min = 0, power = 0;  ///< as reported
  bool alarm = false;              ///< locked until $X or a reset

  bool operator==(const Display&) const = default;
};

/// Report id and seven bytes.
using FeatureReport = std::array<std::uint8_t, 8>;

/// A frame of a display of XHC: little endian, cut into feature reports of seven bytes, the last
/// one filled with zeros (LinuxCNC, xhc-hb04 and xhc-whb04b-6).
class XhcFrame {
 public:
  /// Two fixed bytes and a seed. The purpose of the seed is unknown: the checksums that it enters
  /// are not used.
  explicit XhcFrame(std::uint8_t seed) : bytes_{0xfe, 0xfd, seed} {}

  void byte(std::uint8_t value) { bytes_.push_back(value); }
  /// Appends a value, limited to 0..65535.
  void word(long value);
  /// Appends the whole part, then four decimals with the sign in bit 15; limited to +-65535.9999.
  void number(double value);
  /// The frame as feature reports.
  std::vector<FeatureReport> reports() const;

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace lamplock::pendant
