// Converts records of the pulse stream to targets (docs/wire-format.md, section 4).
//
// In:  the payload of one DATA frame at a time, in order (the link ensures that).
// Out: targets in the point queue: all of a frame, or none.
// Who: the controller's on_data, at main-loop level; an estimated 100 cycles a target. Each target
//      is parsed twice, because a whole frame is checked before its first target is pushed.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/motion/point_queue.hpp"
#include "shared/result.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/records.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program {

/// Decoder of one job's records.
class PulseDecoder {
 public:
  /// Starts a job: deltas count from the header's origin, indices from its first index. `channels`:
  /// a bit for each channel that may fire.
  void begin(const wire::JobHeader& header, std::uint8_t channels = all_channels);

  /// Decodes one payload into the queue, whose end() must be the index of the payload's first
  /// target. Results: ok; no_space (retry later); bad_frame (malformed); bad_value (channel, shots,
  /// or more points than the header announced); out_of_bounds (outside `limits`, or beyond 32
  /// bits); unsupported (a channel that may not fire). Unless ok, queue and decoder are unchanged.
  Result decode(std::span<const std::uint8_t> records, motion::PointQueue& queue,
                const StepLimits& limits);

  /// Index in the job of the last refused target.
  std::uint32_t refused_index() const { return refused_index_; }

 private:
  static constexpr std::uint8_t all_channels = (2u << wire::max_channel) - 1;
  wire::RecordState state_;
  std::uint32_t points_total_ = 0;
  std::uint32_t refused_index_ = 0;
  int axes_ = 0;
  std::uint8_t channels_ = all_channels;
};

}  // namespace lamplock::program
