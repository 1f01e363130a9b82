#include "firmware/program/power_list.hpp"

namespace lamplock::program {

[[gnu::hot]] GcodeError PowerList::repetitions(std::uint32_t& pieces) {
  Word word;
  if (!reader_.number(word)) return GcodeError::bad_number;
  if (const GcodeError error = whole(word, pieces); error != GcodeError::none) return error;
  if (pieces == 0) return GcodeError::not_positive;
  return pieces > max_pieces ? GcodeError::out_of_range : GcodeError::none;
}

/// One value of the list; none after the last.
[[gnu::hot]] GcodeError PowerList::entry(PowerRun& run) {
  run = {};
  if (ended_) return GcodeError::none;
  Word word;
  if (!reader_.number(word)) return GcodeError::bad_number;
  if (word.mantissa < 0) return GcodeError::negative_value;
  const std::int64_t milli = scaled(word, 1, 3);
  if (milli >> 32 != 0) return GcodeError::speed_out_of_range;
  run = {static_cast<std::uint32_t>(milli), 1};
  if (reader_.take('*')) {
    if (const GcodeError error = repetitions(run.pieces); error != GcodeError::none) return error;
  }
  ended_ = !reader_.take(':');
  return GcodeError::none;
}

[[gnu::hot]] GcodeError PowerList::next(PowerRun& run) {
  GcodeError error = begun_ ? GcodeError::none : entry(ahead_);
  begun_ = true;
  run = ahead_;
  while (error == GcodeError::none && run.pieces != 0) {
    error = entry(ahead_);
    if (ahead_.pieces == 0 || ahead_.speed_milli != run.speed_milli) break;
    run.pieces += ahead_.pieces;
    if (run.pieces > max_pieces) return GcodeError::out_of_range;
  }
  return error;
}

}  // namespace lamplock::program
