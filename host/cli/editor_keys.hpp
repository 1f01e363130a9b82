// Makes whole keys of the bytes that a terminal sends while a line is edited.
//
// In:  bytes, in pieces of any size.
// Out: one text for each key: a character, or the escape sequence of an arrow or function key.
// Who: the line editor, whose library would otherwise wait for the rest of a sequence, and would
//      take its last byte, often `~`, for a key.
//
// Sources: ECMA-48 (CSI), UTF-8, xterm. Esc alone is no key of the editor.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::cli {

/// The bytes of one terminal.
class EditorKeys {
 public:
  /// Keys that these bytes complete. Esc before a real-time key (`!`, `~`, `?`, Ctrl-X) is dropped,
  /// so that a hold is never part of a sequence.
  std::vector<std::string> take(std::string_view bytes);
  /// No byte has arrived for a while: drops an incomplete key.
  void pause() { pending_.clear(); }
  /// Waits for the rest of a key, or for pause().
  bool inside() const { return !pending_.empty(); }

 private:
  bool is_complete() const;

  std::string pending_{};
};

/// The word of `lamplock console` that a key sends at once: "!", "~", "?", ":reset" for Ctrl-X;
/// empty for other keys.
std::string_view realtime_word_of(std::string_view key);

/// What the line editor gets for a key: a control character for a sequence that moves or deletes,
/// nothing for other sequences, of which its library would take a part for text.
std::string_view editing_key_of(std::string_view key);
/// The character of the key Delete; the other ones have their meaning in Emacs.
inline constexpr char delete_next = 31;

}  // namespace lamplock::cli
