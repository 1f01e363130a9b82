#include "host/pendant/terminal_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lamplock::pendant {
namespace {

constexpr char escape = 0x1b;
/// A longer sequence is noise.
constexpr std::size_t max_sequence_size = 16;

struct Sequence {
  std::string_view bytes;  ///< after the escape
  std::string_view name;
};
constexpr std::array sequences{
    Sequence{"[A", "up"},         Sequence{"[B", "down"},    Sequence{"[C", "right"},
    Sequence{"[D", "left"},       Sequence{"OA", "up"},      Sequence{"OB", "down"},
    Sequence{"OC", "right"},      Sequence{"OD", "left"},    Sequence{"[5~", "page-up"},
    Sequence{"[6~", "page-down"}, Sequence{"[H", "home"},    Sequence{"[F", "end"},
    Sequence{"OH", "home"},       Sequence{"OF", "end"},     Sequence{"[1~", "home"},
    Sequence{"[4~", "end"},       Sequence{"[2~", "insert"}, Sequence{"[3~", "delete"},
    Sequence{"OP", "f1"},         Sequence{"OQ", "f2"},      Sequence{"OR", "f3"},
    Sequence{"OS", "f4"},         Sequence{"[[A", "f1"},     Sequence{"[[B", "f2"},
    Sequence{"[[C", "f3"},        Sequence{"[[D", "f4"},     Sequence{"[[E", "f5"},
    Sequence{"[15~", "f5"},       Sequence{"[17~", "f6"},    Sequence{"[18~", "f7"},
    Sequence{"[19~", "f8"},       Sequence{"[20~", "f9"},    Sequence{"[21~", "f10"},
    Sequence{"[23~", "f11"},      Sequence{"[24~", "f12"}};

struct Control {
  char byte;
  std::string_view name;
};
constexpr std::array controls{Control{' ', "space"},      Control{'\r', "enter"},
                              Control{'\n', "enter"},     Control{'\t', "tab"},
                              Control{0x7f, "backspace"}, Control{'\b', "backspace"}};

constexpr bool is_printable(char c) { return c > ' ' && c < 0x7f; }

/// The key of one byte; empty if the byte is no key.
std::string key_of(char byte) {
  for (const Control& control : controls)
    if (control.byte == byte) return std::string(control.name);
  if (is_printable(byte)) return {byte};
  constexpr char letters = 26, before_a = 'a' - 1;
  if (byte >= 1 && byte <= letters)
    return fmt::format("ctrl-{}", static_cast<char>(before_a + byte));
  return "";
}

/// Length of the sequence after an escape; 0 if it is incomplete.
std::size_t sequence_length(std::string_view bytes) {
  if (bytes.empty()) return 0;
  if (bytes[0] == 'O') return bytes.size() < 2 ? 0 : 2;
  if (bytes[0] != '[') return 1;
  // The Linux console's function keys have a second bracket.
  if (bytes.substr(1).starts_with('[')) return bytes.size() < 3 ? 0 : 3;
  const std::size_t looked_at = std::min(bytes.size(), max_sequence_size);
  for (std::size_t i = 1; i < looked_at; ++i)
    if (bytes[i] >= '@' && bytes[i] <= '~') return i + 1;
  return bytes.size() < max_sequence_size ? 0 : max_sequence_size;
}

}  // namespace

bool is_keyboard_name(std::string_view name) {
  if (name.size() == 1) return is_printable(name[0]);
  if (name.size() == 6 && name.starts_with("ctrl-")) return name[5] >= 'a' && name[5] <= 'z';
  const auto named = [name](const auto& row) { return row.name == name; };
  return name == "escape" || std::any_of(sequences.begin(), sequences.end(), named) ||
         std::any_of(controls.begin(), controls.end(), named);
}

std::vector<std::string> keyboard_names() {
  std::vector<std::string> names{"escape"};
  for (const Sequence& sequence : sequences) names.emplace_back(sequence.name);
  for (const Control& control : controls) names.emplace_back(control.name);
  for (char letter = 'a'; letter <= 'z'; ++letter) names.push_back(fmt::format("ctrl-{}", letter));
  return names;
}

std::vector<std::string> TerminalKeys::take(std::string_view bytes) {
  std::vector<std::string> keys;
  pending_ += bytes;
  while (take_one(keys)) {
  }
  return keys;
}

std::vector<std::string> TerminalKeys::pause() {
  std::vector<std::string> keys;
  if (pending_ == std::string(1, escape)) keys.emplace_back("escape");
  pending_.clear();
  return keys;
}

/// False if no bytes are pending, or only the beginning of a sequence.
bool TerminalKeys::take_one(std::vector<std::string>& keys) {
  if (pending_.empty()) return false;
  if (pending_[0] != escape) {
    if (std::string key = key_of(pending_[0]); !key.empty()) keys.push_back(std::move(key));
    pending_.erase(0, 1);
    return true;
  }
  const std::string_view rest = std::string_view(pending_).substr(1);
  // Escape twice: the first one was the key.
  if (rest.starts_with(escape)) {
    keys.emplace_back("escape");
    pending_.erase(0, 1);
    return true;
  }
  const std::size_t length = sequence_length(rest);
  if (length == 0) return false;
  // Alt with a key looks like escape and that key: an escape to stop must not be missed.
  if (length == 1) {
    keys.emplace_back("escape");
    pending_.erase(0, 1);
    return true;
  }
  for (const Sequence& known : sequences)
    if (known.bytes == rest.substr(0, length)) keys.emplace_back(known.name);
  pending_.erase(0, 1 + length);
  return true;
}

}  // namespace lamplock::pendant
