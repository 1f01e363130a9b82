// Keys that somebody presses in a terminal, out of the bytes that it sends for them.
//
// In:  bytes, in pieces of any size. Out: names of keys, one for each press or repeat.
// Who: `lamplock jog`. Facts: ECMA-48 (CSI), and what xterm, VT220 and the Linux console send for
//      cursor, editing and function keys; with a modifier (";5") a key is not that key.
//
// A terminal tells no key that is let go. An escape that nothing follows is the key Escape: whoever
// reads says when enough time has passed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// True for a printable ASCII character other than a blank, and for names: "up", "page-down",
/// "space", "f1", "ctrl-x" and so on.
bool is_keyboard_name(std::string_view name);

/// The decoder of one terminal.
class TerminalKeys {
 public:
  /// Keys that these bytes complete. Sequences that are not known give none.
  std::vector<std::string> take(std::string_view bytes);
  /// No byte has come for a while: what is begun is not gone on with.
  std::vector<std::string> pause();
  /// Waits for the rest of a sequence, or for pause().
  bool inside() const { return !pending_.empty(); }

 private:
  bool take_one(std::vector<std::string>& keys);

  std::string pending_;
};

}  // namespace lamplock::pendant
