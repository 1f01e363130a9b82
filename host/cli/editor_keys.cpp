#include "host/cli/editor_keys.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace lamplock::cli {
namespace {

constexpr char escape_byte = 27;
/// A longer sequence is noise.
constexpr std::size_t max_sequence_size = 16;

constexpr char ctrl(char letter) { return static_cast<char>(letter - '@'); }

/// Sequences of xterm, VT220, rxvt and the Linux console; the characters of Emacs.
struct EditingKey {
  std::string_view sequence;
  char character;
};
constexpr std::array editing_keys{
    EditingKey{"\x1b[A", ctrl('P')},   EditingKey{"\x1bOA", ctrl('P')},  // up, down
    EditingKey{"\x1b[B", ctrl('N')},   EditingKey{"\x1bOB", ctrl('N')},
    EditingKey{"\x1b[C", ctrl('F')},   EditingKey{"\x1bOC", ctrl('F')},  // right, left
    EditingKey{"\x1b[D", ctrl('B')},   EditingKey{"\x1bOD", ctrl('B')},
    EditingKey{"\x1b[H", ctrl('A')},   EditingKey{"\x1bOH", ctrl('A')},  // Home
    EditingKey{"\x1b[1~", ctrl('A')},  EditingKey{"\x1b[7~", ctrl('A')},
    EditingKey{"\x1b[F", ctrl('E')},   EditingKey{"\x1bOF", ctrl('E')},  // End
    EditingKey{"\x1b[4~", ctrl('E')},  EditingKey{"\x1b[8~", ctrl('E')},
    EditingKey{"\x1b[3~", delete_next}};

/// Bytes of a character in UTF-8 by its first one.
std::size_t size_of_character(char first) {
  const auto byte = static_cast<unsigned char>(first);
  constexpr unsigned two = 0xC0, three = 0xE0, four = 0xF0;
  return byte >= four ? 4 : byte >= three ? 3 : byte >= two ? 2 : 1;
}

}  // namespace

std::string_view realtime_word_of(std::string_view key) {
  constexpr char ctrl_x = 24;
  if (key == "!" || key == "~" || key == "?") return key;
  return key.size() == 1 && key[0] == ctrl_x ? ":reset" : "";
}

std::string_view editing_key_of(std::string_view key) {
  for (const EditingKey& known : editing_keys)
    if (known.sequence == key) return {&known.character, 1};
  constexpr std::size_t size_with_alt = 2;
  return key[0] == escape_byte && key.size() > size_with_alt ? "" : key;
}

std::vector<std::string> EditorKeys::take(std::string_view bytes) {
  std::vector<std::string> keys;
  for (const char byte : bytes) {
    // A sequence that has not got further than its escape; a second escape begins another one.
    const bool is_begun = pending_.size() == 1 && pending_[0] == escape_byte;
    if (is_begun && (byte == escape_byte || !realtime_word_of({&byte, 1}).empty()))
      pending_.clear();
    pending_ += byte;
    if (is_complete()) keys.push_back(std::exchange(pending_, {}));
  }
  return keys;
}

bool EditorKeys::is_complete() const {
  if (pending_[0] != escape_byte) return pending_.size() >= size_of_character(pending_[0]);
  if (pending_.size() < 2) return false;
  if (pending_[1] == 'O') return pending_.size() == 3;
  if (pending_[1] != '[') return true;
  if (pending_.size() < 3) return false;
  // The Linux console's function keys have a second bracket.
  if (pending_.size() == 3 && pending_[2] == '[') return false;
  const char last = pending_.back();
  return (last >= '@' && last <= '~') || pending_.size() >= max_sequence_size;
}

}  // namespace lamplock::cli
