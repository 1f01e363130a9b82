#include "host/cli/line_editor.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cwchar>

#include "host/cli/live_line.hpp"
#include "host/error.hpp"
#include "host/run/console_session.hpp"

namespace lamplock::cli {
namespace {

constexpr std::string_view prompt = "> ";
constexpr int history_lines = 500;
constexpr char ctrl_d = 4;
/// Limit of one call: an input that never pauses must not stop the caller's own work.
constexpr std::size_t max_bytes = 4096;
/// The rest of a key's sequence arrives within this time.
constexpr std::chrono::milliseconds escape_time{50};

LineEditor* shown_editor = nullptr;
/// The rest of the key that libedit reads.
std::string_view key_bytes;

ssize_t append(void* output, const char* bytes, std::size_t size) {
  static_cast<std::string*>(output)->append(bytes, size);
  return static_cast<ssize_t>(size);
}

std::FILE* open_collector(std::string& output) {
  cookie_io_functions_t functions{};
  functions.write = append;
  return ::fopencookie(&output, "w", functions);
}

/// libedit does not change the text.
char* prompt_text(EditLine*) {
  static std::string text(prompt);
  return text.data();
}

/// libedit reads characters here, of one key only; 0: there is no more, without waiting.
int read_character(EditLine*, wchar_t* character) {
  std::mbstate_t state{};
  if (key_bytes.empty()) return 0;
  const std::size_t size = std::mbrtowc(character, key_bytes.data(), key_bytes.size(), &state);
  if (size > key_bytes.size()) {  // not a character of this locale
    key_bytes = {};
    return 0;
  }
  key_bytes.remove_prefix(std::max<std::size_t>(size, 1));
  return 1;
}

}  // namespace

LineEditor::LineEditor()
    : collector_(open_collector(output_)),
      history_(history_init()),
      editor_(el_init_fd("lamplock", stdin, collector_.get(), stderr, STDIN_FILENO, STDOUT_FILENO,
                         STDERR_FILENO)),
      columns_(columns_of(stdout)) {
  if (!editor_ || !history_)
    throw Error(Exit::job_failed, "terminal", "cannot be used for editing lines",
                "set TERM=dumb to type without editing");
  HistEvent event;
  ::history(history_.get(), &event, H_SETSIZE, history_lines);
  ::history(history_.get(), &event, H_SETUNIQUE, 1);
  el_set(editor_.get(), EL_PROMPT, &prompt_text);
  el_set(editor_.get(), EL_EDITOR, "emacs");
  el_set(editor_.get(), EL_HIST, &::history, history_.get());
  el_set(editor_.get(), EL_GETCFN, &read_character);
  // The usual search, and the key that takes the next one literally, would wait for further keys.
  el_set(editor_.get(), EL_BIND, "^R", "ed-search-prev-history", nullptr);
  el_set(editor_.get(), EL_BIND, "^_", "ed-delete-next-char", nullptr);
  el_set(editor_.get(), EL_BIND, "^V", "ed-unassigned", nullptr);
  el_set(editor_.get(), EL_BIND, "^Q", "ed-unassigned", nullptr);
  shown_editor = this;
  begin_line();
  flush();
}

LineEditor::~LineEditor() {
  shown_editor = nullptr;
  erase_line();
  el_set(editor_.get(), EL_UNBUFFERED, 0);
  flush();
}

bool LineEditor::can_edit() {
  return LiveLine::can_show(stdout) && QuietTerminal::in_foreground(STDIN_FILENO);
}

LineEditor* LineEditor::shown() { return shown_editor; }

std::vector<std::string> LineEditor::lines(std::chrono::milliseconds wait) {
  std::vector<std::string> result;
  follow_terminal();
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (!ended_ && ::poll(&watched, 1, static_cast<int>(wait.count())) > 0) {
    if ((watched.revents & POLLIN) == 0 || (watched.revents & POLLHUP) != 0)
      ended_ = true;  // the terminal has gone
    else
      read_keys(result);
  } else if (keys_.inside() && std::chrono::steady_clock::now() - key_at_ >= escape_time) {
    keys_.pause();
  }
  flush();
  return result;
}

void LineEditor::read_keys(std::vector<std::string>& lines) {
  std::array<char, max_bytes> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) {
    ended_ = count == 0 || (errno != EINTR && errno != EAGAIN);
    return;
  }
  key_at_ = std::chrono::steady_clock::now();
  for (const std::string& key : keys_.take({bytes.data(), static_cast<std::size_t>(count)}))
    if (!ended_) take_key(key, lines);
}

/// The width may have changed, and a shell may have reset the modes while the program was stopped.
void LineEditor::follow_terminal() {
  termios present{};
  const bool was_reset = ::tcgetattr(STDIN_FILENO, &present) == 0 &&
                         (present.c_lflag & static_cast<tcflag_t>(ICANON)) != 0;
  if (was_reset && QuietTerminal::in_foreground(STDIN_FILENO)) {
    el_set(editor_.get(), EL_UNBUFFERED, 0);
    begin_line();
  }
  const std::size_t columns = columns_of(stdout);
  if (columns == columns_) return;
  erase_line();
  columns_ = columns;
  el_resize(editor_.get());
  el_set(editor_.get(), EL_REFRESH);
}

void LineEditor::print(const std::string& text) {
  erase_line();
  output_ += text;
  el_set(editor_.get(), EL_REFRESH);
  flush();
}

/// To the begin of the line, which may have several rows, and clear from there (ECMA-48: CUU, ED).
void LineEditor::erase_line() {
  const LineInfo* const line = el_line(editor_.get());
  const std::size_t cursor = prompt.size() + static_cast<std::size_t>(line->cursor - line->buffer);
  if (const std::size_t rows = cursor / columns_; rows > 0)
    output_ += fmt::format("\033[{}A", rows);
  output_ += "\r\033[J";
}

/// A real-time key, and none of the text of a comment.
bool LineEditor::is_realtime(std::string_view key) const {
  if (realtime_word_of(key).empty()) return false;
  const LineInfo* const line = el_line(editor_.get());
  const auto before = static_cast<std::size_t>(line->cursor - line->buffer);
  constexpr char first_printable = ' ';
  return key[0] < first_printable || !run::is_in_comment({line->buffer, before});
}

/// libedit takes one key at each call; a line is complete at its end.
void LineEditor::take_key(const std::string& key, std::vector<std::string>& lines) {
  if (is_realtime(key)) {
    lines.emplace_back(realtime_word_of(key));
    return;
  }
  int size = 0;
  key_bytes = editing_key_of(key);
  if (key_bytes.empty()) return;
  const char* const text = el_gets(editor_.get(), &size);
  key_bytes = {};
  if (text == nullptr || size <= 0) return;  // the key has left the line empty
  std::string line(text, static_cast<std::size_t>(size));
  // Ctrl-D at the begin of a line.
  if (line.size() == 1 && line.front() == ctrl_d) ended_ = true;
  if (line.back() != '\n' && line.back() != '\r') return;
  line.pop_back();
  if (!line.empty()) {
    HistEvent event;
    ::history(history_.get(), &event, H_ENTER, line.c_str());
  }
  lines.push_back(line);
  el_set(editor_.get(), EL_UNBUFFERED, 0);
  begin_line();
}

/// Shows the prompt, and reads key by key from now on.
void LineEditor::begin_line() { el_set(editor_.get(), EL_UNBUFFERED, 1); }

void LineEditor::flush() {
  std::fflush(collector_.get());
  std::fwrite(output_.data(), 1, output_.size(), stdout);
  std::fflush(stdout);
  output_.clear();
}

}  // namespace lamplock::cli
