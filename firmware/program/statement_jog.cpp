// Jogs, `$J=`: a straight move with its own feed, which leaves the modal state as it was.
#include "firmware/program/statement.hpp"

namespace lamplock::program {

Fault Statement::check_jog(std::string_view line) {
  const Modal modal = after_.modal;
  read(line, true);
  if (!fault_) jog();
  if (fault_) plan_.stages = 0;
  after_.modal = modal;
  return fault_;
}

bool Statement::jog() {
  after_.modal.feed_mode = FeedMode::per_minute;
  after_.modal.motion = Motion::line;
  after_.modal.feed = 0;
  plan_.jog = true;
  if (!codes() || !line_number()) return false;
  if (block_.axes() == 0) return fail(GcodeError::no_axis_words, 1);
  return feed() && cut_move() && rest();
}

}  // namespace lamplock::program
