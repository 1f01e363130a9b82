#include "shared/settings_text.hpp"

#include <limits>

namespace lamplock::settings {
namespace {

constexpr int decimals = 3;

/// Removes decimal digits from the front; false if there is none or the number does not fit.
bool take_digits(std::string_view& text, std::int64_t& value) {
  if (text.empty() || text.front() < '0' || text.front() > '9') return false;
  while (!text.empty() && text.front() >= '0' && text.front() <= '9') {
    value = value * 10 + (text.front() - '0');
    if (value > std::numeric_limits<std::int32_t>::max()) return false;
    text.remove_prefix(1);
  }
  return true;
}

/// Removes the decimals after a point; more than three are refused rather than rounded.
bool take_decimals(std::string_view& text, std::int64_t& milli) {
  int scale = 1000;
  for (int i = 0; i < decimals && !text.empty() && text.front() >= '0' && text.front() <= '9';
       ++i) {
    scale /= 10;
    milli += scale * (text.front() - '0');
    text.remove_prefix(1);
  }
  return text.empty();
}

/// Reads the whole text as a number in thousandths.
bool read_milli(std::string_view text, std::int64_t& milli) {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative || (!text.empty() && text.front() == '+')) text.remove_prefix(1);
  std::int64_t whole = 0;
  if (!take_digits(text, whole)) return false;
  milli = whole * 1000;
  if (!text.empty()) {
    if (text.front() != '.') return false;
    text.remove_prefix(1);
    if (!take_decimals(text, milli)) return false;
  }
  if (negative) milli = -milli;
  return true;
}

}  // namespace

SettingLine read_setting(std::string_view line) {
  SettingLine result;
  std::int64_t number = 0;
  line.remove_prefix(1);
  if (!take_digits(line, number) || line.empty() || line.front() != '=' ||
      number > std::numeric_limits<std::uint16_t>::max()) {
    result.error = GcodeError::unknown_command;
    return result;
  }
  line.remove_prefix(1);
  result.number = static_cast<std::uint16_t>(number);
  result.id = find_number(result.number);
  std::int64_t milli = 0;
  if (result.id == Id::count) {
    result.error = GcodeError::unknown_command;
  } else if (!read_milli(line, milli)) {
    result.error = GcodeError::bad_number;
  } else {
    const Range& row = range(result.id);
    if (milli < row.min_milli || milli > row.max_milli || (row.whole && milli % 1000 != 0))
      result.error = GcodeError::setting_out_of_range;
    else
      result.milli = static_cast<std::int32_t>(milli);
  }
  return result;
}

void write_setting(TextLine& line, Id id, const Values& values) {
  const Range& row = range(id);
  line.add("$").add(std::int64_t{number(id)}).add("=");
  if (row.whole)
    line.add(std::int64_t{values.whole(id)});
  else
    line.add_milli(values.milli(id));
  line.add("\r\n");
}

}  // namespace lamplock::settings
