#include "host/run/probe_log_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

std::string log_path(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

}  // namespace

void ProbeLogFiles::check(const std::string& folder, const std::vector<std::string>& names,
                          const std::string& program) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw Error(Exit::bad_input, "--probe-logs", fmt::format("{}: no such folder", folder),
                "make it, or give another one");
  for (const std::string& name : names) {
    const std::string path = log_path(folder, name);
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
      throw Error(Exit::bad_input, path, "a probe log must be a regular file",
                  "change the name in (probeopen NAME)");
    if (fs::equivalent(path, program, ignored))
      throw Error(Exit::bad_input, path, "the probe log would replace the program",
                  "change the name in (probeopen NAME), or give another --probe-logs folder");
    EventStream::check(path);
  }
}

bool ProbeLogFiles::take(const std::string& text, const link::LineSender& sender) {
  const auto answer = answers_.take(text);
  if (!answer) return false;
  const program_run::LoggedProbe& probe = probes_[answer->probe];
  const auto is_refused = [&](const link::LineError& error) { return error.index == probe.line; };
  // The answer to a probe that was not made is that to the one before it.
  if (!answer->place || probe.log.empty() || std::ranges::any_of(sender.errors(), is_refused))
    return true;
  open_to(probe.line);
  if (EventStream* file = file_of(probe.log)) file->add(program_run::log_line(*answer->place));
  return true;
}

void ProbeLogFiles::poll(const link::LineSender& sender) {
  open_to(sender.answered());
  for (const auto& [name, file] : files_)
    if (file) file->poll();
}

/// Opens the logs of all lines before this one, and of this one.
void ProbeLogFiles::open_to(std::size_t line) {
  for (; opened_ < lines_.size() && opened_ <= line; ++opened_)
    for (const std::string& comment : lines_[opened_].logs)
      if (const std::string name = link::probe_log_name(comment); !name.empty()) file_of(name);
}

/// A log that is opened again continues. Null if it cannot be opened.
EventStream* ProbeLogFiles::file_of(const std::string& name) {
  auto& file = files_[name];
  if (file || failed_.contains(name)) return file.get();
  try {
    file = std::make_unique<EventStream>(log_path(folder_, name));
  } catch (const Error& error) {
    failed_[name] = error.message();
  }
  return file.get();
}

void ProbeLogFiles::finish(LostFiles& lost) {
  for (const auto& [name, file] : files_) {
    if (file) file->finish();
    const std::string why = file ? file->loss() : failed_[name];
    if (!why.empty()) lost.attempt(log_path(folder_, name), [&] { throw std::runtime_error(why); });
  }
}

}  // namespace lamplock::run
