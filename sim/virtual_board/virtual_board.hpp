// The virtual board: the firmware core on a virtual clock, with the simulated world on its pins.
//
// In:  bytes of the host, a world (lamp, drives, switches).
// Out: bytes to the host, pins, time. Deterministic: no threads, no wall clock.
// It calls the Controller as a real board does, with its own times: steps are filled 2 ms ahead,
// tick lengths 0.3 ms ahead (0.8 ms on the RP2040), and the main loop runs every 250 us. A model of
// the hardware fires. Steps are computed in closed form, not tick by tick.
//
// A continuous laser: its gate opens and shuts on the ticks of the lattice, as on a real board. Its
// power changes where a power cell or a block begins, and is that of the last tick of the cell in
// the block. A real board puts out the same powers of the same cells in its own raster, up to 100
// us earlier or later.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "firmware/machine/controller.hpp"
#include "sim/board.hpp"
#include "sim/virtual_board/axis_output.hpp"
#include "sim/virtual_board/fire_stage.hpp"
#include "sim/virtual_board/receive_queue.hpp"
#include "sim/virtual_board/step_edges.hpp"
#include "sim/virtual_board/tick_line.hpp"
#include "sim/virtual_board/tick_listener.hpp"
#include "sim/world/world.hpp"

namespace lamplock::sim {

/// One board in its world.
class VirtualBoard final : public Board, private PinListener {
 public:
  /// With settings, and the state that programs have stored, as a board finds them after power-up.
  VirtualBoard(const settings::Values& stored, const WorldConfig& world,
               const machine::PersistentState& kept = {});
  ~VirtualBoard() override;
  VirtualBoard(const VirtualBoard&) = delete;
  VirtualBoard& operator=(const VirtualBoard&) = delete;

  std::string_view name() const override { return "virtual"; }

  std::size_t write(std::span<const std::uint8_t> bytes) override;
  std::size_t read(std::span<std::uint8_t> bytes) override;
  bool has_output() const override { return !to_host_.empty(); }
  void reconnect() override;
  void set_host_present(bool present) override;

  void run_until(Picoseconds until) override;
  Picoseconds now() const override { return now_; }

  PinBus& bus() override { return bus_; }
  World& world() override { return *world_; }
  const World& world() const override { return *world_; }
  const std::vector<LatticeShot>& lattice_shots() const override { return lattice_shots_; }
  /// Time that the main loop needs to plan one window; 0 unless a slow processor is imitated.
  /// Interrupts continue meanwhile.
  void set_planning_time(Picoseconds time) { planning_time_ = time; }
  /// Enables the continuous laser as the core would: for tests without a program.
  void enable_laser(bool on) { laser_enabled_by_hand_ = on; }
  /// Reports ticks to one listener from now on; it must live as long as the board runs.
  void listen(TickListener& listener) { listener_ = &listener; }
  /// Settings that the board would start with after power-up.
  const settings::Values& stored_settings() const { return stored_; }
  const machine::PersistentState& kept_state() const { return kept_; }
  const machine::Controller& controller() const { return *controller_; }
  machine::Controller& controller() { return *controller_; }

 private:
  void pin_changed(Pin pin, bool level, Picoseconds at) override;
  void report_input(Pin pin);
  StepPosition present_position() const;
  Picoseconds next_event() const;
  Picoseconds next_look() const;
  Picoseconds next_change() const;
  void play_changes();
  void put_switched_outputs();
  Picoseconds token_expiry() const;
  void service();
  void main_loop();
  std::uint16_t sensor_level() const;
  void feed_lattice();
  void next_span();
  void play(Picoseconds until);
  void forget();
  void begin_block(const stepper::TickBlock& block);
  void play_block(const stepper::TickBlock& block, std::uint64_t to_tick);
  void report_ticks(const stepper::TickBlock& block, std::uint64_t to_tick);
  void apply_bits(std::uint8_t bits, Picoseconds at);
  void play_power(const stepper::TickBlock& block, std::uint64_t to_tick);
  void put_gate(Picoseconds at);
  void put_power(Picoseconds at);
  void decide();
  void report_shot(bool fired);
  void take_token();
  void withdraw_token();
  void check_outputs();
  void apply_beam();
  void stop_dead();
  StepPosition position_at_tick(std::uint64_t tick) const;
  StepPosition load_at_tick(std::uint64_t tick) const;

  settings::Values stored_;
  machine::PersistentState kept_;
  machine::InputSet told_inputs_ = 0;  ///< active, as reported to the core
  PinBus bus_;
  std::unique_ptr<World> world_;
  std::unique_ptr<machine::Controller> controller_;
  FireStage fire_;
  TickLine ticks_;
  std::deque<stepper::TickBlock> blocks_;
  std::deque<stepper::TickBlock> recent_blocks_;  ///< already played
  std::uint64_t played_ = 0;                      ///< first tick not yet put out
  std::uint64_t filled_ = 0;                      ///< first tick not yet filled
  Picoseconds bits_change_ = never;               ///< when the lattice bits change next
  std::uint8_t bits_ = 0;
  bool laser_enabled_ = false, laser_enabled_by_hand_ = false;
  std::uint16_t power_ = 0;        ///< of the present power cell
  PerAxis<StepCursor> cursors_{};  ///< of the block being played; refer into it
  PerAxis<AxisOutput> axes_{};
  bool token_held_ = false;
  lamp::FireToken token_;
  Verdict shot_;  ///< decided, its pulse has not begun
  bool own_edges_ = false;
  static constexpr std::uint64_t no_tick = ~std::uint64_t{0};
  std::uint64_t new_times_tick_ = no_tick;  ///< from here on pulses have the stored times
  Picoseconds max_lag_ = 0;  ///< of the drives: so far back the board's ticks are asked for
  Picoseconds now_ = 0;
  Picoseconds next_service_ = 0;
  Picoseconds planning_time_ = 0;
  Picoseconds planned_at_ = never;  ///< while the main loop plans: time of the end
  ReceiveQueue from_host_;
  std::deque<std::uint8_t> to_host_;
  std::vector<LatticeShot> lattice_shots_;
  TickListener* listener_ = nullptr;
};

}  // namespace lamplock::sim
