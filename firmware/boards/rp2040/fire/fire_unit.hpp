// The fire unit: the board's half of firing, around the state machine FIRE.
//
// In:  tokens of the core, results of FIRE, edges of STAMP.
// Out: lamp_edge() for every accepted edge, a shot when its pulse has begun; ARM held low unless a
//      token of the core is loaded.
// Who: service(), or read_results() and handle_token(): beat and edge interrupt (priority 1), and
//      the main loop with them masked, after anything that may have changed outputs(). Budget: 6 us
//      an edge for this code, plus the core's part. cut_off(): any level. stopped(), restart():
//      main loop, beat interrupt masked.
//
// Withdrawing a token: ARM is held low at the pad, so that no decision can be a shot; after 16
// clocks a decision in progress is finished; then either the token is still in the FIFO and is
// removed, or an edge has consumed it and its result follows. Never during a pulse, since pausing
// the state machine would lengthen it by some 30 clocks.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/fire/token_keeper.hpp"
#include "firmware/boards/rp2040/lattice/lattice_output.hpp"
#include "firmware/boards/rp2040/lattice/stamp_reader.hpp"
#include "firmware/boards/rp2040/lattice/tick_feed.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/lamp/shot_delay.hpp"
#include "firmware/machine/controller.hpp"

namespace lamplock::rp2040 {

static_assert(lamp::shot_delay_clocks(settings::range(settings::Id::q_switch_delay).min_milli) >=
              pio::min_delay_clocks);
static_assert(lamp::shot_delay_clocks(settings::range(settings::Id::q_switch_delay).max_milli) <=
              pio::max_delay_clocks);

/// Delay and width in the words of FIRE.
constexpr std::uint32_t token_word(const machine::FireTiming& timing) {
  const std::uint32_t delay = timing.delay_clocks < pio::min_delay_clocks   ? pio::min_delay_clocks
                              : timing.delay_clocks > pio::max_delay_clocks ? pio::max_delay_clocks
                                                                            : timing.delay_clocks;
  const std::uint32_t width =
      timing.width_clocks > pio::fire_width_fixed_clocks
          ? (timing.width_clocks - pio::fire_width_fixed_clocks) / pio::clocks_per_width_count
          : 0;
  return (delay - pio::fire_fixed_clocks) / pio::clocks_per_delay_count | width << 16;
}

class FireUnit {
 public:
  FireUnit(LatticeOutput& lattice, TickFeed& feed, StampReader& stamps)
      : lattice_(lattice), feed_(feed), stamps_(stamps) {}

  /// Q-switch low, program loaded; ARM and Q-switch held low. No state machine runs.
  [[gnu::cold]] void start();
  /// Q-switch off at the pad, FIRE stopped: two stores (e-stop, priority 0).
  [[gnu::always_inline]] void cut_off() const {
    // In this order: a pulse has begun exactly if the state machine's place shows it.
    clear_bits(pio0().ctrl, pio_ctrl::enable(1u << 3));
    force_low(boards::gpio(boards::Role::q_switch));
  }
  /// After cut_off(): reports the outcome of the token to the core. `cut` is the clock of the cut.
  [[gnu::cold]] void stopped(machine::Controller& core, std::uint64_t cut);
  /// Restarts FIRE from its beginning, last of all state machines; the Q-switch pad is unchanged.
  void restart() const;

  /// Reads results, handles tokens. `now()` is the present clock, never ahead of it, at most 1 us
  /// late.
  template <class Now>
  void service(machine::Controller& core, Now&& now) {
    read_results(core, now);
    handle_token(core, now());
  }
  /// Results of FIRE: an edge each.
  template <class Now>
  void read_results(machine::Controller& core, Now&& now) {
    std::uint32_t count = 0;
    read_fifo(count);
    if (count != 0) report(core, count, now());
  }
  bool has_token() const { return keeper_.is_out(); }
  /// FIRE has judged an edge, and the result was not read.
  static bool has_result();
  /// Takes, loads or withdraws the token if it is due; fast if it is not.
  void handle_token(machine::Controller& core, std::uint64_t now) {
    if (is_due(core, now)) change_token(core, now);
  }
  /// New delay, width, source of LAMP SYNC; waits until no token is out.
  void configure(const machine::FireTiming& timing);
  /// When service() should be called next, if that is known.
  bool next_clock(std::uint64_t& clock);

 private:
  static constexpr std::uint32_t max_results = 8;

  void read_fifo(std::uint32_t& count);
  void report(machine::Controller& core, std::uint32_t count, std::uint64_t now);
  std::uint64_t edge_of(std::uint32_t result, std::uint64_t latest, std::uint64_t now);
  /// TokenKeeper::next() may return an action, as far as can be determined without the tick.
  bool is_due(const machine::Controller& core, std::uint64_t now) {
    const bool may = core.shots().permitted();
    std::uint64_t clock = 0;
    if (!keeper_.is_out()) return may;
    return !may || (next_clock(clock) && now >= clock);
  }
  void change_token(machine::Controller& core, std::uint64_t now);
  /// False after cut_off(): a stopped state machine gets no token.
  bool load();
  bool withdraw() const;
  static bool is_running();
  static bool pulse_lasts();

  LatticeOutput& lattice_;
  TickFeed& feed_;
  StampReader& stamps_;
  TokenKeeper keeper_;
  bool has_due_ = false;  ///< due_clock_ is the next clock for the token in keeper_
  std::uint64_t due_clock_ = 0;
  machine::FireTiming timing_;
  std::uint32_t word_ = 0;  ///< delay and width in the format of FIRE
  std::uint32_t results_[max_results] = {};
};

}  // namespace lamplock::rp2040
