#include "host/serve/running_job.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;
using std::chrono::system_clock;

constexpr std::chrono::seconds write_interval{1};

std::int64_t seconds_of(system_clock::time_point time) { return system_clock::to_time_t(time); }

/// How to continue. A board that was held may have lines that were sent and not executed.
std::string remedy_of(const EndedJob& left) {
  if (left.item == "point")
    return "the server ended during this job; start it again with 'continue the last run', "
           "which fires no point twice";
  return fmt::format(
      "the server ended during this program, of which at least {} lines were done; resume or stop "
      "what the board still has of it; after a stop, find the line at the position of the machine, "
      "and start from it",
      left.view.done);
}

}  // namespace

std::optional<EndedJob> RunningJob::take_left() const {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored)) return std::nullopt;
  EndedJob left;
  try {
    const Json json = Json::parse(read_file(file_));
    left.view.name = json.at("name");
    left.view.is_dry = json.at("dry");
    left.view.done = json.at("done");
    left.view.total = json.at("total");
    left.item = lower_extension(left.view.name) == ".llj" ? "point" : "line";
    left.begin = system_clock::from_time_t(json.at("begin"));
    left.end = system_clock::from_time_t(json.at("seen"));
  } catch (const std::exception&) {
    left = {};
  }
  std::filesystem::remove(file_, ignored);
  if (left.view.name.empty()) return std::nullopt;
  left.view.end = "interrupted";
  left.view.message = remedy_of(left);
  return left;
}

void RunningJob::note(const JobView& job, Clock::time_point now) {
  try {
    writing_.take();
  } catch (const std::exception&) {
    written_at_ = {};  // a full disk: the next second tries again
  }
  if (writing_.is_busy()) return;
  if (!job.is_running) {
    if (noted_.is_running) end();
    return;
  }
  if (!noted_.is_running || noted_.name != job.name) begun_ = system_clock::now();
  const bool is_new = !noted_.is_running;
  if (!is_new && (job.done == noted_.done || now - written_at_ < write_interval)) return;
  noted_ = job;
  written_at_ = now;
  const Json json{{"name", job.name},
                  {"dry", job.is_dry},
                  {"done", job.done},
                  {"total", job.total},
                  {"begin", seconds_of(begun_)},
                  {"seen", seconds_of(system_clock::now())}};
  writing_.start([file = file_, text = json.dump()] {
    write_whole(file, text);
    return true;
  });
}

void RunningJob::end() {
  writing_ = {};  // waits
  noted_ = {};
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace lamplock::serve
