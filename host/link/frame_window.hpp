// Frames of a job that were built and that the machine has not acknowledged, in their order.
//
// In:  a job, the numbers that STATUS acknowledges or shows as lost. Out: the frame to write next,
// encoded for the wire. Who: JobSender. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "host/job/job.hpp"

namespace lamplock::link {

class FrameWindow {
 public:
  /// DATA or END.
  struct Frame {
    std::uint32_t number;             ///< from 1
    std::size_t end_index;            ///< after its last point or line
    std::uint64_t end_places;         ///< entries of the run table used up to its end
    std::vector<std::uint8_t> bytes;  ///< encoded for the wire
  };

  /// The job must outlive the window. `first_index`: first point or line to send; `max_frames`:
  /// built and not acknowledged.
  FrameWindow(const job::Job& job, std::size_t first_index, std::size_t max_frames)
      : job_(job), encoder_(job, first_index), max_frames_(max_frames) {}

  /// Points or lines of a frame, from now on: a quarter of the machine's free space, so that
  /// several frames are under way, at most what one frame may have.
  void choose_frame_size(std::size_t free_points);
  std::size_t frame_points() const { return frame_points_; }

  /// The frame to write next; null if the window is full or every frame is written.
  const Frame* next(std::uint32_t session);
  /// next() was written.
  void written();
  /// The machine has room for `frame` and for all frames on the way to it. `end_of_room`: index up
  /// to which points or lines may be sent; `free_runs`: free entries of its run table.
  bool has_room(const Frame& frame, std::size_t end_of_room, std::uint32_t free_runs) const;

  /// Drops the frames before `next_number`; true if there were any.
  bool acknowledge(std::uint32_t next_number);
  /// Writes again from the frame `number` on, which the machine has not received.
  void write_again(std::uint32_t number);
  /// Writes all frames again: which of them the machine has is unknown.
  void write_all_again() { cursor_ = 0; }

  std::uint32_t last_built() const { return built_; }
  std::uint32_t last_acknowledged() const {
    return built_ - static_cast<std::uint32_t>(frames_.size());
  }
  /// Number of the frame that is written next, built or not.
  std::uint32_t next_number() const {
    return cursor_ < frames_.size() ? frames_[cursor_].number : built_ + 1;
  }
  bool any_on_the_way() const { return cursor_ > 0; }
  bool any_written() const { return written_ > 0; }
  bool all_acknowledged() const { return end_built_ && frames_.empty(); }
  std::uint64_t resent() const { return resent_; }

 private:
  bool build(std::uint32_t session);

  const job::Job& job_;
  job::RecordEncoder encoder_;
  std::size_t max_frames_;
  std::deque<Frame> frames_;
  std::uint64_t places_ = 0;   ///< entries of the run table used by acknowledged frames
  std::size_t cursor_ = 0;     ///< next of frames_ to write
  std::uint32_t built_ = 0;    ///< number of the last frame built
  std::uint32_t written_ = 0;  ///< highest number ever written
  bool end_built_ = false;
  std::size_t frame_points_ = 1;
  std::uint64_t resent_ = 0;
};

}  // namespace lamplock::link
