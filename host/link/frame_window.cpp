#include "host/link/frame_window.hpp"

#include <algorithm>
#include <utility>

#include "host/link/connection.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/messages.hpp"
#include "shared/wire/row_records.hpp"

namespace lamplock::link {
namespace {

/// Points in one DATA frame at most: an acknowledgement every few dozen points keeps free space
/// and progress up to date, and the header of a frame costs a quarter of a byte per point.
constexpr std::size_t max_points_per_frame = 64;
/// Bytes of frames sent and not acknowledged. A port buffers 4 KiB between two reads of a firmware
/// that plans meanwhile (firmware/boards/rp2040/usb/usb_serial.hpp); the rest is for queries and
/// commands, of some 40 bytes at most, which more frames would delay.
constexpr std::size_t max_in_flight = 4096 - 512;

}  // namespace

void FrameWindow::choose_frame_size(std::size_t free_points) {
  const std::size_t most = job_.is_rows() ? wire::max_lines_a_frame : max_points_per_frame;
  frame_points_ = std::clamp<std::size_t>(free_points / 4, 1, most);
}

const FrameWindow::Frame* FrameWindow::next(std::uint32_t session) {
  if (cursor_ == frames_.size() && !build(session)) return nullptr;
  return &frames_[cursor_];
}

void FrameWindow::written() {
  const std::uint32_t number = frames_[cursor_].number;
  if (number <= written_) ++resent_;
  written_ = std::max(written_, number);
  ++cursor_;
}

bool FrameWindow::has_room(const Frame& frame, std::size_t end_of_room,
                           std::uint32_t free_runs) const {
  std::size_t on_the_way = frame.bytes.size();
  for (std::size_t i = 0; i < cursor_; ++i) on_the_way += frames_[i].bytes.size();
  if (on_the_way > max_in_flight || frame.end_index > end_of_room) return false;
  return frame.end_places <= places_ + free_runs || !job_.is_rows();
}

bool FrameWindow::acknowledge(std::uint32_t next_number) {
  bool any = false;
  while (!frames_.empty() && frames_.front().number < next_number) {
    places_ = frames_.front().end_places;
    frames_.pop_front();
    if (cursor_ > 0) --cursor_;
    any = true;
  }
  return any;
}

void FrameWindow::write_again(std::uint32_t number) {
  if (frames_.empty() || number < frames_.front().number) return;
  cursor_ = std::min<std::size_t>(cursor_, number - frames_.front().number);
}

/// Builds the frame after the last one; false if the window is full or everything has been built.
bool FrameWindow::build(std::uint32_t session) {
  if (end_built_ || frames_.size() >= max_frames_) return false;
  wire::FrameType type = wire::FrameType::data;
  std::vector<std::uint8_t> payload = encoder_.next(wire::max_payload, frame_points_);
  if (payload.empty()) {
    type = wire::FrameType::end;
    payload.resize(sizeof(std::uint32_t));
    wire::ByteWriter out(payload);
    out.put(static_cast<std::uint32_t>(job_.size()));
    end_built_ = true;
  }
  const std::uint32_t number = ++built_;
  frames_.push_back({number, encoder_.index(), encoder_.places(),
                     Connection::encode({type, session, number}, payload)});
  return true;
}

}  // namespace lamplock::link
