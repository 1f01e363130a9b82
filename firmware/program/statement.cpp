// Checks the words of a block and what follows from them, in the order of RS274/NGC.
//
// This file stays whole: its functions follow each other for every line, and in several files they
// lie in the flash so that the cache loses them (-1 % lines per second).
#include "firmware/program/statement.hpp"

#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr std::int64_t max_word = 0xffffffff;
constexpr std::uint32_t us_per_minute = 60'000'000;

}  // namespace

bool Statement::fail(GcodeError error, std::uint16_t column) {
  fault_ = {error, column};
  return false;
}

[[gnu::hot]] void Statement::read(std::string_view line, bool jog) {
  plan_.clear();
  fault_ = block_.read(line, options_.axes, expressions_, jog);
}

[[gnu::hot]] Fault Statement::check(std::string_view line) {
  read(line, false);
  if (!fault_) everything();
  if (fault_) plan_.stages = 0;
  return fault_;
}

[[gnu::hot]] bool Statement::everything() {
  if (after_.nurbs.count != 0) [[unlikely]]
    return nurbs_line();
  return before_motion() && data() && motion() && pixels() && stop() && rest();
}

[[gnu::hot]] bool Statement::before_motion() {
  if (block_.is_plain_move()) {
    // Nothing else has anything to do.
    plan_.exact_stop = false;
    return codes() && feed();
  }
  return saved_state() && codes() && line_number() && feed() && speed() && tool() &&
         (block_.has(Group::io) ? io() : no_io()) && spindle() && tool_change() && coolant() &&
         (!block_.has(Group::overrides) || overrides()) && beat_lock() &&
         (!block_.has(Group::pulses) || pulses()) && dwell() &&
         (!block_.has(Group::cutter) || cutter()) && path() && tool_length() &&
         (!block_.has(Group::system) || system()) && (!block_.has(Group::rotation) || rotation());
}

// --- values -----------------------------------------------------------------------------------

bool Statement::fail_at(char letter, GcodeError error) {
  return fail(error, block_.word(letter).column);
}

bool Statement::fail_axes(GcodeError error, std::uint32_t axes) {
  return fail(error, block_.axis_column(axes));
}

/// Marks a word of the line as used.
bool Statement::take(char letter) {
  return block_.take(letter) || fail_at(letter, GcodeError::axis_conflict);
}

bool Statement::needed(char letter, std::uint16_t column) {
  return block_.has(letter) || fail(GcodeError::value_missing, column);
}

bool Statement::length(char letter, std::int64_t& e7) {
  if (!take(letter)) return false;
  const Word& word = block_.word(letter);
  e7 = length_e7(word, after_.modal.inches);
  return inside(e7, max_centre_e7, GcodeError::out_of_range, word.column);
}

bool Statement::integer(char letter, std::uint32_t& number) {
  if (!take(letter)) return false;
  const GcodeError error = whole(block_.word(letter), number);
  return error == GcodeError::none || fail_at(letter, error);
}

bool Statement::seconds(char letter, std::uint32_t& us) {
  return unsigned_value(letter, scaled(block_.word(letter), 1, 6), GcodeError::out_of_range, us);
}

/// Uses a word whose value must fit into 32 bits.
[[gnu::hot]] bool Statement::unsigned_value(char letter, std::int64_t value, GcodeError too_large,
                                            std::uint32_t& number) {
  if (!take(letter)) return false;
  if (value < 0) return fail_at(letter, GcodeError::negative_value);
  if (value > max_word) return fail_at(letter, too_large);
  number = static_cast<std::uint32_t>(value);
  return true;
}

[[gnu::hot]] std::int64_t Statement::axis_e7(int axis) const {
  if (after_.modal.inches) [[unlikely]]
    return inch_axis_e7(axis);
  return length_e7(block_.axis(axis), false);
}

[[gnu::hot]] std::int64_t Statement::offset_e7(int axis) const {
  const std::size_t i = index(axis);
  std::int64_t offset = parameters_.systems_e7[after_.modal.system][i];
  if (after_.modal.shifted)
    offset += changes_.has(ParameterRow::shift) ? changes_.place[i] : parameters_.shift_e7[i];
  if (axis == 2 && after_.modal.tool_length)
    offset += changes_.has(ParameterRow::tool_length) ? changes_.tool_length_e7
                                                      : parameters_.tool_length_e7;
  return offset;
}

[[gnu::hot]] bool Statement::inside(std::int64_t e7, std::int64_t most, GcodeError error,
                                    std::uint16_t column) {
  return (e7 <= most && e7 >= -most) || fail(error, column);
}

// --- modal state ------------------------------------------------------------------------------

[[gnu::hot]] bool Statement::saved_state() {
  if (block_.code(Group::saving) != 72) return true;
  if (!saved_.valid) return fail(GcodeError::unsupported, block_.column(Group::saving));
  const Modal before = after_.modal;
  after_.modal = saved_.modal;
  after_.modal.motion = before.motion;
  after_.modal.tool = before.tool;
  after_.modal.loaded_tool = before.loaded_tool;
  if (saved_.modal.spindle != before.spindle || saved_.modal.speed_milli != before.speed_milli)
    plan_.add(Stage::spindle);
  if (saved_.modal.flood != before.flood || saved_.modal.mist != before.mist)
    plan_.add(Stage::coolant);
  if (saved_.modal.overrides_off != before.overrides_off) plan_.add(Stage::overrides);
  if (saved_.modal.beat_lock != before.beat_lock) plan_.add(Stage::beat_lock);
  if (!(saved_.modal.rotation == before.rotation)) turn(saved_.modal.rotation);
  if (saved_.modal.system != before.system) change_system();
  return true;
}

/// Codes that only set a mode.
[[gnu::hot]] bool Statement::codes() {
  Modal& modal = after_.modal;
  if (block_.has(Group::units)) modal.inches = block_.code(Group::units) == 200;
  if (block_.has(Group::plane)) modal.plane = static_cast<Plane>(block_.code(Group::plane));
  if (block_.has(Group::distance)) modal.relative = block_.code(Group::distance) == 910;
  if (block_.has(Group::arc_distance))
    modal.centres_absolute = block_.code(Group::arc_distance) == 901;
  if (block_.has(Group::retract)) modal.retract_to_r = block_.code(Group::retract) == 990;
  if (block_.has(Group::feed_mode)) {
    const auto mode = static_cast<FeedMode>(block_.code(Group::feed_mode));
    if (mode != modal.feed_mode) modal.feed = 0;
    modal.feed_mode = mode;
  }
  if (block_.has(Group::motion)) {
    if (block_.code(Group::motion) == 53) return fail_motion(GcodeError::no_offset_in_plane);
    const auto motion = static_cast<Motion>(block_.code(Group::motion));
    if (is_probe(motion) && !options_.probe)
      return fail(GcodeError::unsupported, block_.column(Group::motion));
    if (motion != modal.motion)
      after_.cycle = {.initial_e7 = after_.cycle.initial_e7,
                      .series = after_.cycle.series && is_cycle(motion)};
    modal.motion = motion;
  }
  return true;
}

[[gnu::hot]] bool Statement::feed() {
  if (!block_.has('F')) return true;
  if (after_.modal.feed_mode == FeedMode::inverse_time) return inverse_time();
  const bool per_turn = after_.modal.feed_mode == FeedMode::per_turn;
  const std::int64_t feed = fine_length('F', per_turn ? 6 : 3);  // nm or um
  return unsigned_value('F', feed, GcodeError::feed_too_high, after_.modal.feed);
}

/// A length in 10^-digits mm.
[[gnu::hot]] std::int64_t Statement::fine_length(char letter, int digits) const {
  const Word& word = block_.word(letter);
  return after_.modal.inches ? scaled(word, 254, digits - 1) : scaled(word, 1, digits);
}

/// F is one over the minutes that the motion takes.
bool Statement::inverse_time() {
  const std::int64_t per_minute_e7 = scaled(block_.word('F'), 1, 7);
  if (per_minute_e7 == 0) return take('F');  // as if it were missing
  const std::int64_t time = (us_per_minute * one_e7 + per_minute_e7 / 2) / per_minute_e7;
  return unsigned_value('F', time == 0 ? 1 : time, GcodeError::out_of_range, plan_.time_us);
}

[[gnu::hot]] bool Statement::speed() {
  if (!block_.has('S')) return true;
  if (!unsigned_value('S', scaled(block_.word('S'), 1, 3), GcodeError::speed_out_of_range,
                      after_.modal.speed_milli))
    return false;
  if (block_.pieces() != 0) after_.modal.speed_milli = block_.last_power_milli();
  return true;
}

/// A list of powers is for a laser along a line at a speed.
[[gnu::hot]] bool Statement::pixels() {
  if (block_.pieces() == 0) return true;
  const Modal& modal = after_.modal;
  if (!options_.laser || !plan_.has(Stage::move) || plan_.motion != Motion::line ||
      modal.feed_mode != FeedMode::per_minute || modal.beat_lock != BeatLock::off)
    return fail_at('S', GcodeError::words_unused);
  plan_.pieces = block_.pieces();
  return true;
}

[[gnu::hot]] bool Statement::tool() {
  if (!block_.has('T')) return true;
  std::uint32_t number = 0;
  if (!integer('T', number)) return false;
  if (number > max_tool) return fail_at('T', GcodeError::tool_too_large);
  after_.modal.tool = number;
  return parameters_.tools.empty() || known_tool(number, block_.word('T').column);
}

/// Without M62 to M68 the line must not have an E word.
[[gnu::hot]] bool Statement::no_io() {
  return !block_.has('E') || fail_at('E', GcodeError::unsupported);
}

/// The spindle is off during the tool change, and after it, unless the line sets it (NIST, section
/// 3.6.3).
[[gnu::hot]] bool Statement::tool_change() {
  if (!block_.has(Group::tool_change)) return true;
  if (block_.code(Group::tool_change) == 61) return set_tool();
  plan_.add(Stage::tool_change);
  after_.modal.loaded_tool = static_cast<std::uint8_t>(after_.modal.tool);
  if (!block_.has(Group::spindle)) after_.modal.spindle = Spindle::off;
  return true;
}

/// M48, M49.
bool Statement::overrides() {
  after_.modal.overrides_off = block_.code(Group::overrides) == 49;
  plan_.add(Stage::overrides);
  return true;
}

[[gnu::hot]] bool Statement::line_number() {
  if (!block_.has('N')) return true;
  if (!integer('N', plan_.line)) return false;
  return plan_.line <= max_line_number || fail_at('N', GcodeError::bad_line_number);
}

[[gnu::hot]] bool Statement::spindle() {
  if (block_.has(Group::spindle)) {
    const std::uint16_t code = block_.code(Group::spindle);
    after_.modal.spindle = code == 3   ? Spindle::constant
                           : code == 4 ? Spindle::proportional
                                       : Spindle::off;
    plan_.add(Stage::spindle);
  } else if (after_.modal.spindle != Spindle::off &&
             (block_.has('S') || (options_.laser && block_.has(Group::motion))) &&
             !(options_.laser && move_is_asked())) {
    plan_.add(Stage::spindle);
  }
  return true;
}

/// Whether the line moves and its moves have the S word.
bool Statement::move_is_asked() const {
  const AxisUse use = block_.axis_use();
  return block_.axes() != 0 && (use == AxisUse::motion || use == AxisUse::none);
}

[[gnu::hot]] bool Statement::coolant() {
  if (!block_.has(Group::coolant)) return true;
  const std::uint16_t code = block_.code(Group::coolant);
  if (code == 7) after_.modal.mist = true;
  if (code == 8) after_.modal.flood = true;
  if (code == 9) after_.modal.mist = after_.modal.flood = false;
  plan_.add(Stage::coolant);
  return true;
}

[[gnu::hot]] bool Statement::beat_lock() {
  if (!block_.has(Group::beat_lock)) return true;
  plan_.add(Stage::beat_lock);
  after_.modal.beat_lock = BeatLock::off;
  if (block_.code(Group::beat_lock) == 131) return true;
  if (!options_.beat_lock) return fail(GcodeError::unsupported, block_.column(Group::beat_lock));
  std::uint32_t free = 0;
  if (!needed('P', block_.column(Group::beat_lock)) || !integer('P', free)) return false;
  if (free > 1) return fail_at('P', GcodeError::out_of_range);
  after_.modal.beat_lock = free == 1 ? BeatLock::free : BeatLock::path;
  return true;
}

[[gnu::hot]] bool Statement::dwell() {
  if (block_.code(Group::once) != 40) return true;
  plan_.add(Stage::dwell);
  return needed('P', block_.column(Group::once)) && seconds('P', plan_.dwell_us);
}

[[gnu::hot]] bool Statement::path() {
  plan_.exact_stop = block_.has(Group::exact_stop);
  if (!block_.has(Group::path)) return true;
  Modal& modal = after_.modal;
  modal.path = static_cast<PathMode>(block_.code(Group::path));
  modal.blend_um = 0;
  if (modal.path != PathMode::blend) return true;
  modal.blend_um = options_.blend_um;
  if (block_.has('P') &&
      !unsigned_value('P', fine_length('P', 3), GcodeError::out_of_range, modal.blend_um))
    return false;
  // LinuxCNC joins lines that are straight within Q; the planner needs no help with those.
  std::uint32_t unused = 0;
  return !block_.has('Q') ||
         unsigned_value('Q', fine_length('Q', 3), GcodeError::out_of_range, unused);
}

// --- offsets ----------------------------------------------------------------------------------

[[gnu::hot]] bool Statement::tool_length() {
  if (!block_.has(Group::tool_length)) return true;
  if (block_.code(Group::tool_length) == 490) {
    if (parameters_.tool_length_e7 != 0) {
      changes_.tool_length_e7 = 0;
      changes_.add(static_cast<int>(ParameterRow::tool_length));
    }
    after_.modal.tool_length = false;
    return true;
  }
  return block_.code(Group::tool_length) == 431 ? tool_length_of_axis() : tool_length_of_table();
}

/// Commands that act once and are not modal: table 8, line 19.
[[gnu::hot]] bool Statement::data() {
  switch (block_.code(Group::once)) {
    case 100:
      return set_system();
    case 280:
    case 300:
      return at_home();
    case 281:
    case 301: {
      const bool g28 = block_.code(Group::once) == 281;
      changes_.add(static_cast<int>(g28 ? ParameterRow::home_g28 : ParameterRow::home_g30));
      changes_.place = after_.machine_e7;
      return true;
    }
    case 920:
      return shift();
    case 921:
      changes_.add(static_cast<int>(ParameterRow::shift));
      changes_.place = {};
      after_.modal.shifted = false;
      return true;
    case 922:
      after_.modal.shifted = false;
      return true;
    case 923:
      after_.modal.shifted = true;
      return true;
    default:
      return true;
  }
}

// --- the end of the line ----------------------------------------------------------------------

[[gnu::hot]] bool Statement::stop() {
  if (!block_.has(Group::stopping)) return true;
  plan_.add(Stage::stop);
  plan_.stop = block_.code(Group::stopping);
  return true;
}

[[gnu::hot]] bool Statement::rest() {
  const std::uint16_t column = block_.first_unused();
  return column == 0 || fail(GcodeError::words_unused, column);
}

}  // namespace lamplock::program
