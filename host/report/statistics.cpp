#include "host/report/statistics.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <vector>

#include "host/file.hpp"
#include "host/file/append_file.hpp"

namespace lamplock::report {
namespace {

/// A field in CSV syntax.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted.push_back('"');
    quoted.push_back(c);
  }
  return quoted + '"';
}

template <class T>
std::string number(const std::optional<T>& value) {
  return value ? fmt::to_string(*value) : "";
}

struct Column {
  const char* name;
  std::string (*value)(const Report&);
};

/// The columns after date and end.
constexpr std::array columns{
    Column{"input", [](const Report& r) { return field(r.input); }},
    Column{"mode", [](const Report& r) { return r.mode; }},
    Column{"board", [](const Report& r) { return field(r.board); }},
    Column{"lamp_hz", [](const Report& r) { return fmt::format("{:g}", r.lamp_hz); }},
    Column{"points", [](const Report& r) { return fmt::to_string(r.points); }},
    Column{"shots", [](const Report& r) { return fmt::to_string(r.shots); }},
    Column{"beats", [](const Report& r) { return fmt::to_string(r.beats); }},
    Column{"beats_before", [](const Report& r) { return fmt::to_string(r.beats_before); }},
    Column{"utilisation", [](const Report& r) { return fmt::format("{:.6f}", r.utilisation); }},
    Column{"time_s", [](const Report& r) { return fmt::format("{:.3f}", r.time_s); }},
    Column{"missed", [](const Report& r) { return number(r.missed); }},
    Column{"doubled", [](const Report& r) { return number(r.doubled); }},
    Column{"sensor_made", [](const Report& r) { return fmt::to_string(r.checks.made); }},
    Column{"sensor_not_made", [](const Report& r) { return fmt::to_string(r.checks.not_made); }},
    Column{"sensor_repeats", [](const Report& r) { return fmt::to_string(r.checks.repeats); }},
    Column{"points_fired", [](const Report& r) { return fmt::to_string(r.points_fired); }},
};

/// Number of columns in the first version of these files.
constexpr std::size_t min_columns = 2 + 15;
/// Maximum length of the line of names.
constexpr std::size_t max_names_size = 1 << 16;

std::vector<std::string> names() {
  std::vector<std::string> all{"date", "end"};
  for (const Column& column : columns) all.emplace_back(column.name);
  return all;
}

std::vector<std::string> values(const Report& report, const std::string& end,
                                const std::string& date) {
  std::vector<std::string> all{date, field(end)};
  for (const Column& column : columns) all.push_back(column.value(report));
  return all;
}

std::string line_of(const std::vector<std::string>& fields) {
  return fmt::format("{}\n", fmt::join(fields, ","));
}

/// State of an existing file: the columns of its names, and its last line.
struct Begun {
  std::size_t columns = 0;  ///< 0: there is no line of names yet
  bool line_open = false;   ///< its last line has no end
};

[[noreturn]] void refuse_other(const std::filesystem::path& file) {
  refuse(file, "is not a statistics file: it does not begin with the names of its columns",
         "choose another file with --statistics");
}

/// Reads the line of names. Throws Error.
Begun begun_file(const std::filesystem::path& file) {
  std::error_code ignored;
  // A device or a pipe is not read.
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  if (std::filesystem::file_size(file, ignored) == 0) return {};
  std::ifstream in(file, std::ios::binary);
  std::string line(max_names_size, '\0');
  in.read(line.data(), static_cast<std::streamsize>(line.size()));
  line.resize(static_cast<std::size_t>(in.gcount()));
  line.resize(std::min(line.size(), line.find('\n')));
  if (line.ends_with('\r')) line.pop_back();  // rewritten by another program
  Begun begun;
  const std::vector<std::string> known = names();
  std::istringstream fields(line);
  for (std::string name; std::getline(fields, name, ','); ++begun.columns)
    if (begun.columns < known.size() && name != known[begun.columns]) refuse_other(file);
  if (begun.columns < min_columns) refuse_other(file);
  in.clear();
  in.seekg(-1, std::ios::end);
  begun.line_open = in.get() != '\n';
  return begun;
}

}  // namespace

std::string date_text(std::chrono::system_clock::time_point when) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(when)));
}

std::string statistics_names() { return line_of(names()); }

void check_statistics(const std::filesystem::path& file) {
  begun_file(file);
  check_appendable(file);
}

void append_statistics(const std::filesystem::path& file, const Report& report,
                       const std::string& end, std::chrono::system_clock::time_point when) {
  const Begun begun = begun_file(file);
  std::vector<std::string> fields = values(report, end, date_text(when));
  std::string text = begun.line_open ? "\n" : "";
  if (begun.columns == 0)
    text += statistics_names();
  else
    fields.resize(begun.columns);
  text += line_of(fields);
  append_whole(file, text);  // several machines may share a file
}

}  // namespace lamplock::report
