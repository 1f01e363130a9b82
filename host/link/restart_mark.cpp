#include "host/link/restart_mark.hpp"

#include <charconv>
#include <system_error>

namespace lamplock::link {
namespace {

/// Removes `text`; false if the line does not begin with it.
bool take(std::string_view& line, std::string_view text) {
  if (!line.starts_with(text)) return false;
  line.remove_prefix(text.size());
  return true;
}

bool take(std::string_view& line, std::uint32_t& number) {
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc{}) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return true;
}

}  // namespace

std::optional<RestartMark> parse_restart_mark(std::string_view line) {
  constexpr std::string_view job = ", job ";
  if (!line.starts_with("[MSG:Started by ") || !line.ends_with(']')) return std::nullopt;
  line.remove_suffix(1);
  const auto at = line.find(job);
  if (at == std::string_view::npos) return std::nullopt;
  line.remove_prefix(at + job.size());
  RestartMark mark;
  if (!take(line, mark.session) || !take(line, " first point not fired ") ||
      !take(line, mark.first_unfired))
    return std::nullopt;
  mark.may_have_fired = take(line, ", which may have been");
  return line.empty() ? std::optional(mark) : std::nullopt;
}

}  // namespace lamplock::link
