// Divides the time of a curve in G93 (inverse time) among its straight pieces by their lengths.
//
// Times are differences over the total length run so far, so that the pieces together last exactly
// the programmed time, however many there are.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"

namespace lamplock::program {

class CurveTiming {
 public:
  /// A curve of `pieces` pieces and this length that takes time_us.
  void begin(const Place& start, std::int64_t length_e7, std::uint32_t pieces,
             std::uint32_t time_us);
  /// Time of the next piece, which ends at `end`; never 0.
  std::uint32_t next(const Place& end);
  /// Where the next piece begins, which ends at `end`: for curves without G93.
  Place step_to(const Place& end) {
    const Place from = here_;
    here_ = end;
    return from;
  }

 private:
  Place here_{};
  std::int64_t length_e7_ = 0, done_e7_ = 0;
  std::uint32_t left_ = 0;
  std::uint32_t time_us_ = 0, spent_us_ = 0;
};

/// Straight distance of all axes, 10^-7 mm, with a relative error of 10^-8.
std::int64_t distance_e7(const Place& a, const Place& b);

}  // namespace lamplock::program
