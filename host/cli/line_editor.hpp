// Lines that the user types in a dialogue, with line editing and a history (libedit).
//
// In:  keys of the terminal. Out: whole lines; the line that is edited stays at the bottom, and
//      text of the program is printed above it. Who: the console, for `lamplock console`.
//
// Reading never waits for the end of a line, because the program talks to a board meanwhile.
// The real-time keys (editor_keys.hpp) are lines of their own at once, whatever is typed, which is
// kept; in a comment they are text. Ctrl-C and Ctrl-Z remain signals. Long pastes are read in
// pieces, so that a pasted hold acts soon.
#pragma once

#include <histedit.h>

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/cli/editor_keys.hpp"
#include "host/cli/quiet_terminal.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// One at a time.
class LineEditor : public run::LineInput {
 public:
  LineEditor();
  ~LineEditor() override;
  LineEditor(const LineEditor&) = delete;
  LineEditor& operator=(const LineEditor&) = delete;

  /// Stdin and stdout are terminals that an editor can be shown on.
  static bool can_edit();
  /// The editor that is shown; null if there is none.
  static LineEditor* shown();

  /// Waits at most this time for the first key.
  std::vector<std::string> lines(std::chrono::milliseconds wait) override;
  void read_ahead() override {}  ///< an editor ends by a key, which lines() reads
  bool ended() const override { return ended_; }
  bool is_typed() const override { return true; }
  std::string begun() const override { return ""; }

  /// Prints text that ends with a line end above the line that is edited.
  void print(const std::string& text);

 private:
  struct End {
    void operator()(EditLine* editor) const { el_end(editor); }
    void operator()(History* history) const { history_end(history); }
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };

  void follow_terminal();
  void erase_line();
  void read_keys(std::vector<std::string>& lines);
  void take_key(const std::string& key, std::vector<std::string>& lines);
  bool is_realtime(std::string_view key) const;
  void begin_line();
  void flush();

  QuietTerminal quiet_{QuietTerminal::Reads::lines};  ///< restores the terminal after a signal
  std::string output_;                                ///< not sent to the terminal yet
  std::unique_ptr<std::FILE, End> collector_;         ///< appends to output_
  std::unique_ptr<History, End> history_;
  std::unique_ptr<EditLine, End> editor_;
  std::size_t columns_;
  EditorKeys keys_;
  std::chrono::steady_clock::time_point key_at_{};
  bool ended_ = false;
};

}  // namespace lamplock::cli
