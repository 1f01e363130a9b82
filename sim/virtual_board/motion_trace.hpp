// The exact commanded motion of a virtual board's axes: every stretch of constant acceleration
// between two ticks, every beat, every shot.
//
// In:  the board's ticks (tick_listener.hpp) and pins. Out: pieces, beats and shots in order of
// time. Who: pictures of motion (host/report/motion_series.hpp), tests.
//
// Beats are counted from the first shot or, where nothing is fired, from the beat in which motion
// begins. Only the window of beats is kept, so a job of any length can be traced; motion before
// beat 0 leads to the first point.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/wire/status.hpp"
#include "sim/virtual_board/tick_listener.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

class VirtualBoard;

/// Ticks in which every axis has constant acceleration.
struct MotionPiece {
  std::uint64_t first_tick = 0;
  std::uint32_t ticks = 0;
  wire::MachineState state = wire::MachineState::idle;  ///< of the board at that time
  PerAxis<stepper::AxisRun> axis{};                     ///< from its first tick on

  std::uint64_t end_tick() const { return first_tick + ticks; }
  bool moves() const;
};

/// Where a beat of the lattice begins.
struct TracedBeat {
  std::uint64_t tick = 0;
  Picoseconds at = 0;
};

/// Beats of a trace, counted from its beat 0.
struct BeatWindow {
  std::int64_t from = 0, to = 0;
};

/// Traces a board from construction on.
class MotionTrace final : private TickListener, private PinListener {
 public:
  /// Event at which a trace begins: its beat 0.
  enum class Zero { first_shot, first_motion };

  /// The board must not run after the trace has been destroyed.
  MotionTrace(VirtualBoard& board, const BeatWindow& window, Zero zero);
  MotionTrace(const MotionTrace&) = delete;
  MotionTrace& operator=(const MotionTrace&) = delete;

  /// From the first motion on; no gap in ticks between them.
  const std::vector<MotionPiece>& pieces() const { return pieces_; }
  const std::vector<TracedBeat>& beats() const { return beats_; }
  /// Index in beats() of beat 0; empty if it has not come.
  std::optional<std::size_t> zero() const { return zero_; }
  /// Start times of Q-switch pulses, and of LAMP SYNC pulses without runts.
  const std::vector<Picoseconds>& shots() const { return shots_; }
  const std::vector<Picoseconds>& flashes() const { return flashes_; }
  /// The beat whose lattice tick is nearest; there must be beats.
  std::size_t nearest_beat(Picoseconds at) const;

 private:
  void ticks_played(const PlayedTicks& ticks) override;
  void beat_begins(std::uint64_t tick, Picoseconds at) override;
  void pin_changed(Pin pin, bool level, Picoseconds at) override;

  VirtualBoard& board_;
  BeatWindow window_;
  Zero zero_kind_;
  std::vector<MotionPiece> pieces_;
  std::vector<TracedBeat> beats_;
  std::vector<Picoseconds> shots_, flashes_;
  Picoseconds sync_rise_ = 0;
  std::optional<std::size_t> zero_;
  bool complete_ = false;  ///< the window is over
};

}  // namespace lamplock::sim
