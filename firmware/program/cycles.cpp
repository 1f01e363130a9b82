#include "firmware/program/cycles.hpp"

namespace lamplock::program {

void DrillCycle::begin(const CycleRequest& request) {
  request_ = request;
  here_ = request.start;
  last_depth_e7_ = request.retract_e7;
  phase_ = Phase::rise;
}

bool DrillCycle::next(CycleMove& move) {
  while (phase_ != Phase::done)
    if (advance(move)) return true;
  return false;
}

bool DrillCycle::to_level(CycleMove& move, std::int64_t level_e7, CycleMove::Kind kind) {
  const bool moves = here_[request_.normal] != level_e7;
  here_[request_.normal] = level_e7;
  move = {kind, false, here_};
  return moves;
}

bool DrillCycle::cross(CycleMove& move) {
  Place to = request_.first;
  to[request_.normal] = here_[request_.normal];
  const bool moves = !same_place(to, here_);
  here_ = to;
  move = {CycleMove::Kind::rapid, false, here_};
  return moves;
}

bool DrillCycle::cut(CycleMove& move) {
  const bool pecks =
      request_.kind == Motion::drill_peck || request_.kind == Motion::drill_chip_break;
  // Compares with the last peck, not the last level: a peck is what is cut.
  if (pecks && last_depth_e7_ - request_.depth_e7 > request_.peck_e7) {
    last_depth_e7_ -= request_.peck_e7;
    phase_ = Phase::clear;
  } else {
    last_depth_e7_ = request_.depth_e7;
    phase_ = has_dwell(request_.kind) ? Phase::dwell : after_dwell();
  }
  to_level(move, last_depth_e7_, CycleMove::Kind::cut);
  move.bottom = phase_ != Phase::clear;
  return true;
}

DrillCycle::Phase DrillCycle::after_dwell() const {
  switch (request_.kind) {
    case Motion::bore:
    case Motion::bore_dwell:
      return Phase::bore_out;
    case Motion::bore_stop:
      return Phase::stop;
    default:
      return Phase::leave;
  }
}

std::int64_t DrillCycle::above_last_peck() const {
  const std::int64_t level = last_depth_e7_ + request_.clearance_e7;
  return level < request_.retract_e7 ? level : request_.retract_e7;
}

bool DrillCycle::clear(CycleMove& move) {
  const bool leaves = request_.kind == Motion::drill_peck;
  phase_ = leaves ? Phase::enter : Phase::cut;
  return to_level(move, leaves ? request_.retract_e7 : above_last_peck(), CycleMove::Kind::rapid);
}

void DrillCycle::next_hole() {
  last_depth_e7_ = request_.retract_e7;
  phase_ = --request_.holes == 0 ? Phase::done : Phase::cross;
  for (std::size_t i = 0; i < request_.first.size(); ++i) request_.first[i] += request_.step[i];
}

bool DrillCycle::advance(CycleMove& move) {
  constexpr auto rapid = CycleMove::Kind::rapid;
  switch (phase_) {
    case Phase::rise:
      phase_ = Phase::cross;
      return here_[request_.normal] < request_.retract_e7 &&
             to_level(move, request_.retract_e7, rapid);
    case Phase::cross:
      phase_ = Phase::approach;
      return cross(move);
    case Phase::approach:
      phase_ = Phase::cut;
      return to_level(move, request_.retract_e7, rapid);
    case Phase::cut:
      return cut(move);
    case Phase::clear:
      return clear(move);
    case Phase::enter:
      phase_ = Phase::cut;
      return to_level(move, above_last_peck(), rapid);
    case Phase::dwell:
      phase_ = after_dwell();
      move = {CycleMove::Kind::dwell, false, here_};
      return true;
    case Phase::stop:
      phase_ = Phase::leave;
      move = {CycleMove::Kind::spindle_off, false, here_};
      return true;
    case Phase::bore_out:
      phase_ = Phase::leave;
      return to_level(move, request_.kind == Motion::bore ? request_.retract_e7 : request_.end_e7,
                      CycleMove::Kind::cut);
    case Phase::leave: {
      const bool moves = to_level(move, request_.end_e7, rapid);
      if (request_.kind == Motion::bore_stop)
        phase_ = Phase::start;
      else
        next_hole();
      return moves;
    }
    case Phase::start:
      next_hole();
      move = {CycleMove::Kind::spindle_on, false, here_};
      return true;
    case Phase::done:
      break;
  }
  return false;
}

}  // namespace lamplock::program
