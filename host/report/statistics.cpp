#include "host/report/statistics.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <fstream>

#include "host/file.hpp"

namespace lamplock::report {
namespace {

/// A field as CSV wants it.
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
};

}  // namespace

std::string date_text(std::chrono::system_clock::time_point when) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(when)));
}

std::string statistics_names() {
  std::string line = "date,end";
  for (const Column& column : columns) line += fmt::format(",{}", column.name);
  return line + "\n";
}

std::string statistics_line(const Report& report, const std::string& end, const std::string& date) {
  std::string line = fmt::format("{},{}", date, field(end));
  for (const Column& column : columns) line += fmt::format(",{}", column.value(report));
  return line + "\n";
}

void append_statistics(const std::filesystem::path& file, const Report& report,
                       const std::string& end, std::chrono::system_clock::time_point when) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(file, ignored);
  const bool begun = !ignored && size > 0;
  const std::string line = statistics_line(report, end, date_text(when));
  // In one piece: several machines may share a file.
  std::ofstream out(file, std::ios::app | std::ios::binary);
  const std::string text = begun ? line : statistics_names() + line;
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.flush();
  if (!out) refuse(file, "cannot be written", "choose another file with --statistics");
}

}  // namespace lamplock::report
