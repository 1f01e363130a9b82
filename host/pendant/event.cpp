#include "host/pendant/event.hpp"

#include <array>

namespace lamplock::pendant {
namespace {

constexpr auto key_count = static_cast<std::size_t>(Key::count);

/// In the order of Key; empty for keys that a key map cannot name.
constexpr std::array<std::string_view, key_count> key_names_by_value{
    "none",      "",           "stop",       "reset",       "start",     "home",      "zero",
    "zero-x",    "zero-y",     "zero-z",     "go-to-zero",  "safe-z",    "half",      "half-x",
    "half-y",    "rewind",     "probe",      "spindle",     "step",      "mode",      "continuous",
    "feed-plus", "feed-minus", "power-plus", "power-minus", "macro-1",   "macro-2",   "macro-3",
    "macro-4",   "macro-5",    "macro-6",    "macro-7",     "macro-8",   "macro-9",   "macro-10",
    "macro-11",  "macro-12",   "macro-13",   "macro-14",    "macro-15",  "macro-16",  "button-1",
    "button-2",  "button-3",   "button-4",   "button-5",    "button-6",  "button-7",  "button-8",
    "button-9",  "button-10",  "button-11",  "button-12",   "button-13", "button-14", "button-15"};
static_assert(!key_names_by_value.back().empty());

}  // namespace

std::string_view key_name(Key key) { return key_names_by_value[static_cast<std::size_t>(key)]; }

std::optional<Key> key_named(std::string_view name) {
  for (std::size_t i = 1; i < key_count; ++i)
    if (!name.empty() && key_names_by_value[i] == name) return static_cast<Key>(i);
  return std::nullopt;
}

}  // namespace lamplock::pendant
