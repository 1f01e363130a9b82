// What a pendant's display shows, and how displays of XHC write numbers.
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

/// What turning the wheel does.
enum class Mode : std::uint8_t { step, continuous, feed };

/// Everything that a display may show.
struct Display {
  PerAxis<double> work_mm{}, machine_mm{};
  Selector selector = Selector::off;
  Mode mode = Mode::step;
  double step_mm = 0;
  int feed_percent = 100, power_percent = 100;
  int feed_mm_min = 0, power = 0;  ///< as reported
  bool alarm = false;              ///< nothing moves until somebody unlocks or resets

  bool operator==(const Display&) const = default;
};

/// Report id and seven bytes.
using FeatureReport = std::array<std::uint8_t, 8>;

/// A frame of a display of XHC: little endian, cut into feature reports of seven bytes, the last
/// one filled with zeros (LinuxCNC, xhc-hb04 and xhc-whb04b-6).
class XhcFrame {
 public:
  /// Its two fixed bytes and a seed; what the seed is for nobody knows: the checksums that it
  /// takes part in are not used.
  explicit XhcFrame(std::uint8_t seed) : bytes_{0xfe, 0xfd, seed} {}

  void byte(std::uint8_t value) { bytes_.push_back(value); }
  /// Cut off at 0 and 65535.
  void word(long value);
  /// Whole part, then four decimals with the sign in bit 15. Beyond +-65535.9999: that.
  void number(double value);
  /// The reports of it.
  std::vector<FeatureReport> reports() const;

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace lamplock::pendant
