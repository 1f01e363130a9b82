// The token between core and fire stage: its owner, and when it changes.
//
// In:  the present tick, whether firing is permitted, tokens of the core, results of the hardware.
// Out: actions for the hardware: load it, take it back.
// Who: FireUnit (beat interrupt, priority 1). Logic only, no registers, so that it is tested on a
//      PC against the fire stage of the virtual board.
//
//   none --take--> held --not_before--> loaded --edge--> none
//                    |                    |
//                    +----- expired, not permitted: withdraw --> none
#pragma once

#include <cstdint>

#include "firmware/lamp/shot_scheduler.hpp"

namespace lamplock::rp2040 {

/// One token at a time.
class TokenKeeper {
 public:
  enum class Action : std::uint8_t {
    nothing,
    take,      ///< request a token of the core; taken() if there is one
    drop,      ///< held by software only: dropped(), report to the core that it expired
    load,      ///< write it into the hardware, then loaded()
    withdraw,  ///< take it out of the hardware; if that succeeded withdrawn(), report to the core
  };

  /// `tick` is ignored unless a token is out.
  Action next(std::uint64_t tick, bool permitted) const {
    if (state_ == State::none) return permitted ? Action::take : Action::nothing;
    const bool over = !permitted || tick >= token_.expires_tick;
    if (state_ == State::loaded) return over ? Action::withdraw : Action::nothing;
    if (over) return Action::drop;
    return tick >= token_.not_before_tick ? Action::load : Action::nothing;
  }
  /// The tick at which the result of next() may change; false if only an event can change it.
  bool next_tick(std::uint64_t& tick) const {
    if (state_ == State::none) return false;
    tick = state_ == State::held ? token_.not_before_tick : token_.expires_tick;
    return true;
  }

  void taken(const lamp::FireToken& token) { token_ = token, state_ = State::held; }
  void loaded() { state_ = State::loaded; }
  void dropped() { state_ = State::none; }
  void withdrawn() { state_ = State::none; }
  /// A result was read; true if it has spent our token.
  bool result(bool spent) {
    const bool ours = spent && state_ == State::loaded;
    if (ours) state_ = State::none;
    return ours;
  }

  bool is_loaded() const { return state_ == State::loaded; }
  bool is_out() const { return state_ != State::none; }
  const lamp::FireToken& token() const { return token_; }

 private:
  enum class State : std::uint8_t { none, held, loaded };
  State state_ = State::none;
  lamp::FireToken token_;
};

}  // namespace lamplock::rp2040
