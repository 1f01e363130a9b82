// Decodes the bytes that a terminal sends for keys.
//
// In:  bytes, in pieces of any size. Out: names of keys, one for each press or repeat.
// Who: `lamplock jog`. Sources: ECMA-48 (CSI); the sequences of xterm, VT220 and the Linux console
//      for cursor, editing and function keys. A key with a modifier (";5") is not reported.
//
// A terminal does not report the release of a key. An escape without further bytes is the key
// Escape: the caller signals by pause() that enough time has passed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// True for a printable ASCII character other than a blank, and for names: "up", "page-down",
/// "space", "f1", "ctrl-x" and so on.
bool is_keyboard_name(std::string_view name);
/// The names that are no single characters.
std::vector<std::string> keyboard_names();

/// The decoder of one terminal.
class TerminalKeys {
 public:
  /// Keys that these bytes complete. Unknown sequences give none.
  std::vector<std::string> take(std::string_view bytes);
  /// No byte has arrived for a while: ends an incomplete sequence.
  std::vector<std::string> pause();
  /// Waits for the rest of a sequence, or for pause().
  bool inside() const { return !pending_.empty(); }

 private:
  bool take_one(std::vector<std::string>& keys);

  std::string pending_;
};

}  // namespace lamplock::pendant
