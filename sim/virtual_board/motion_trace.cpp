#include "sim/virtual_board/motion_trace.hpp"

#include <algorithm>

#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::sim {
namespace {

/// Position_after() counts in 32 bits.
constexpr std::uint64_t max_piece = std::uint64_t{1} << 30;
/// Beats kept after the window.
constexpr std::int64_t beats_behind = 2;

MotionPiece piece_of(const PlayedTicks& played, wire::MachineState state,
                     const Kinematics& kinematics) {
  MotionPiece piece;
  piece.first_tick = played.from;
  piece.ticks = static_cast<std::uint32_t>(played.to - played.from);
  piece.state = state;
  const auto n = static_cast<std::uint32_t>(played.from - played.block.first_tick);
  for (std::size_t a = 0; a < piece.axis.size(); ++a) {
    const stepper::AxisRun& run = played.block.axis[a];
    piece.axis[a].position_q64 = run.position_after(n);
    if (!played.block.moving) continue;
    piece.axis[a].rate_q62 = run.rate_q62 + run.accel_q62 * static_cast<std::int64_t>(n);
    piece.axis[a].accel_q62 = run.accel_q62;
  }
  piece.axis = stepper::axis_runs(kinematics, piece.axis);
  return piece;
}

/// True if `next` continues the motion of `piece` without a change.
bool continues(const MotionPiece& piece, const MotionPiece& next) {
  if (next.first_tick != piece.end_tick() || next.state != piece.state) return false;
  if (std::uint64_t{piece.ticks} + next.ticks > max_piece) return false;
  for (std::size_t a = 0; a < piece.axis.size(); ++a) {
    const stepper::AxisRun &run = piece.axis[a], &next_run = next.axis[a];
    if (next_run.accel_q62 != run.accel_q62) return false;
    const std::int64_t rate = run.rate_q62 + run.accel_q62 * std::int64_t{piece.ticks};
    if (next_run.rate_q62 != rate) return false;
  }
  return true;
}

}  // namespace

bool MotionPiece::moves() const {
  return std::any_of(axis.begin(), axis.end(), [](const stepper::AxisRun& run) {
    return run.rate_q62 != 0 || run.accel_q62 != 0;
  });
}

MotionTrace::MotionTrace(VirtualBoard& board, const BeatWindow& window, Zero zero)
    : board_(board), window_(window), zero_kind_(zero) {
  board.listen(*this);
  board.bus().listen(Pin::q_switch, *this);
  board.bus().listen(Pin::lamp_sync, *this);
}

std::size_t MotionTrace::nearest_beat(Picoseconds at) const {
  const auto not_before =
      std::lower_bound(beats_.begin(), beats_.end(), at,
                       [](const TracedBeat& beat, Picoseconds time) { return beat.at < time; });
  const auto i = static_cast<std::size_t>(not_before - beats_.begin());
  if (i == 0) return 0;
  if (i == beats_.size() || at - beats_[i - 1].at < beats_[i].at - at) return i - 1;
  return i;
}

void MotionTrace::ticks_played(const PlayedTicks& played) {
  if (complete_) return;
  const MotionPiece piece = piece_of(played, board_.controller().state(),
                                     board_.controller().runner().generator().kinematics());
  if (!zero_ && pieces_.empty() && !piece.moves()) return;
  if (!zero_ && zero_kind_ == Zero::first_motion && !beats_.empty())
    zero_ = nearest_beat(played.start);
  if (!pieces_.empty() && continues(pieces_.back(), piece))
    pieces_.back().ticks += piece.ticks;
  else
    pieces_.push_back(piece);
}

void MotionTrace::beat_begins(std::uint64_t tick, Picoseconds at) {
  if (complete_) return;
  beats_.push_back({tick, at});
  if (!zero_) return;
  const auto beat = static_cast<std::int64_t>(beats_.size() - 1 - *zero_);
  // The pieces of a beat are added after its start, so all present pieces lie before it.
  if (beat <= window_.from) pieces_.clear();
  complete_ = beat > window_.to + beats_behind;
}

void MotionTrace::pin_changed(Pin pin, bool level, Picoseconds at) {
  if (complete_) return;
  if (pin == Pin::lamp_sync) {
    if (level)
      sync_rise_ = at;
    else if (at - sync_rise_ > lamp::min_sync_clocks * ps_per_clock)
      flashes_.push_back(sync_rise_);
    return;
  }
  if (!level) return;
  shots_.push_back(at);
  if (!zero_ && zero_kind_ == Zero::first_shot && !beats_.empty()) zero_ = nearest_beat(at);
}

}  // namespace lamplock::sim
