#include "host/run/sent_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/gcode_comments.hpp"
#include "host/job/job_file.hpp"
#include "host/run/file_ways.hpp"
#include "host/run/output_name.hpp"
#include "host/run/read_job.hpp"
#include "host/shell_text.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

constexpr const char* job_extension = ".llj";
constexpr std::array program_extensions{".gcode", ".nc", ".ngc", ".gc", ".tap", ".cnc"};
/// So many lines with words show what a file is.
constexpr int lines_to_judge = 50;

bool has_program_name(const std::string& file) {
  const std::string extension = lower_extension(file);
  return std::find(program_extensions.begin(), program_extensions.end(), extension) !=
         program_extensions.end();
}

/// The line without comments, block delete and blanks at its ends.
std::string executed_text(std::string_view line) {
  const std::string text = without_comments(line);
  std::string_view rest = trimmed(text);
  if (rest.starts_with('/')) rest = trimmed(rest.substr(1));
  return std::string(rest);
}

/// Words of G-code: letters, each with a number after it.
bool has_words(std::string_view line) {
  while (!line.empty()) {
    if (std::isalpha(static_cast<unsigned char>(line.front())) == 0) return false;
    line = trimmed(line.substr(1));
    const std::size_t size = std::min(line.find_first_not_of("+-.0123456789"), line.size());
    if (size == 0) return false;
    line = trimmed(line.substr(size));
  }
  return true;
}

/// Enough of a file for so many lines, the last one whole.
std::string first_lines(const std::string& file) {
  constexpr std::size_t bytes = 1 << 16;
  check_is_file(file);
  std::string text(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() == bytes) text.erase(text.find_last_of("\r\n") + 1);
  return text;
}

/// The first lines are words of G-code, lines for the board, or the % round a program.
bool looks_like_program(std::string_view text) {
  int judged = 0;
  for (text = without_byte_order_mark(text); !text.empty() && judged < lines_to_judge;) {
    const std::string line = executed_text(take_line(text));
    if (line.empty() || line == "%") continue;
    if (!line.starts_with('$') && !has_words(line)) return false;
    ++judged;
  }
  return judged > 0;
}

/// A line that begins with a number, as those of a list of points do.
bool has_numbers(std::string_view text) {
  for (int line = 0; line < lines_to_judge && !text.empty(); ++line) {
    const std::string_view first = trimmed(take_line(text));
    if (!first.empty() && std::string_view("+-.0123456789").find(first.front()) != text.npos)
      return true;
  }
  return false;
}

/// What to do with a file that is neither a job nor a program.
std::string way_from_other_file(const std::string& file) {
  if (lower_extension(file) == ".txt" && !has_numbers(first_lines(file)))
    return fmt::format("correct its lines, which lamplock check {} lists", shell_text({file}));
  const std::string way = way_to_job(file);
  return way.empty() ? "give a job (lamplock job MODEL -o FILE.llj) or a program of G-code" : way;
}

}  // namespace

SentKind kind_of_sent_file(const std::string& file) {
  if (is_job_file(file)) return SentKind::job;
  refuse_empty(file);
  if (has_program_name(file) || lower_extension(file) == ".txt")
    read_program_text(file);  // refuses a file that is missing or cannot be read, and UTF-16
  else
    read_file(file);
  if (is_program_file(file)) return SentKind::program;
  throw Error(Exit::bad_input, file, "is neither a job nor a program of G-code",
              way_from_other_file(file));
}

bool is_job_file(const std::string& file) {
  return lower_extension(file) == job_extension || job::starts_with_job(file);
}

bool is_program_file(const std::string& file) {
  if (job::starts_with_job(file)) return false;
  if (has_program_name(file)) return true;
  try {
    return looks_like_program(first_lines(file));
  } catch (const Error&) {
    return false;  // a file that is empty or cannot be read
  }
}

bool is_program_name(const std::string& file) { return has_program_name(file); }

void require_program(const std::string& file) {
  refuse_empty(file);
  // A text may be a program whose first line is wrong.
  if (is_program_file(file)) return;
  if (lower_extension(file) == ".txt" && !is_job_file(file)) return;
  if (const FileWay way = way_of_file(file))
    throw Error(Exit::bad_input, file, way.what + ", not a program of G-code", way.remedy);
}

std::string read_program_text(const std::string& file) { return read_text_file(file); }

Error no_line_to_send(const std::string& file, bool has_flow) {
  if (has_flow)
    return {Exit::bad_input, file, "its O-words lead to no line for the machine",
            "check the conditions of its branches and loops, and that its subs are called"};
  return {Exit::bad_input, file, "has no line to send", "is this the right file?"};
}

void check_job_name(const std::string& output) {
  if (is_special(output) || lower_extension(output) == job_extension) return;
  throw Error(Exit::bad_input, output, "is not a name for a job, which is a binary file",
              "give a name that ends in .llj");
}

void check_program_name(const std::string& output) {
  if (lower_extension(output) == job_extension)
    throw Error(Exit::bad_input, output, "is a name for a job, not for G-code",
                "give a name that ends in .ngc");
  if (!has_program_name(output)) check_output_name(output, ".ngc");
}

}  // namespace lamplock::run
