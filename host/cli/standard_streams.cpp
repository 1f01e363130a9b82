#include "host/cli/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <iostream>
#include <streambuf>
#include <string>
#include <system_error>

#include "host/error.hpp"

namespace lamplock::cli {
namespace {

/// Why text for stdout was lost first; 0: no text was lost.
int lost_output = 0;

/// Sends the text of std::cout, which does not report why it fails, through write_text().
class OutputBuffer : public std::streambuf {
 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    write_text(stdout, {text, static_cast<std::size_t>(size)});
    return size;
  }
  int_type overflow(int_type character) override {
    const char one = traits_type::to_char_type(character);
    xsputn(&one, 1);
    return character;
  }
};

std::string reason_text() {
  return lost_output == 0 ? "" : " (" + std::generic_category().message(lost_output) + ")";
}

Error lost_output_error() {
  return {Exit::job_failed, "standard output", "cannot be written" + reason_text(),
          "check where it is sent to and its free space"};
}

}  // namespace

void prepare_streams() {
  static OutputBuffer& buffer = *new OutputBuffer;  // std::cout is used until the program has ended
  std::cout.rdbuf(&buffer);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // Opened the other way round: stdin cannot be read, stdout and stderr cannot be written. The
    // lowest free descriptor is the missing one.
    if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

void write_text(std::FILE* stream, std::string_view text) {
  const bool is_written =
      std::fwrite(text.data(), 1, text.size(), stream) == text.size() && std::fflush(stream) == 0;
  if (!is_written && stream == stdout && lost_output == 0) lost_output = errno;
}

int check_output(int status) {
  std::cout.flush();
  const bool is_flushed = std::fflush(stdout) == 0;
  if (!is_flushed && lost_output == 0) lost_output = errno;
  if (is_flushed && lost_output == 0 && std::ferror(stdout) == 0) return status;
  if (status != static_cast<int>(Exit::done)) return status;
  const Error error = lost_output_error();
  write_text(stderr, std::string(error.what()) + '\n');
  return static_cast<int>(error.exit());
}

void require_output() {
  if (lost_output != 0) throw lost_output_error();
}

}  // namespace lamplock::cli
