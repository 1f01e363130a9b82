#include "host/serve/history.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "host/material/job_history.hpp"
#include "host/run/material_records.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/or_null.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

constexpr std::size_t max_shown = 100;

std::string utc_text(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

material::JobRecord record_of(const std::string& board, const EndedJob& job) {
  material::JobRecord record;
  record.file = job.view.name;
  record.board = board;
  record.begin = utc_text(job.begin);
  record.end = utc_text(job.end);
  record.result = job.view.end;
  record.message = job.view.message;
  record.item = job.item;
  record.is_dry = job.view.is_dry;
  record.done = static_cast<std::int64_t>(job.view.done);
  record.total = static_cast<std::int64_t>(job.view.total);
  record.wasted_beats = job.wasted_beats;
  if (job.report) record.report = Reports::new_name(record.begin);
  return record;
}

void keep_record(const std::string& library, const material::JobRecord& record) {
  const std::string file = run::library_file(library);
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  material::add_job(file, record);
}

}  // namespace

void History::add(std::vector<EndedJob> jobs) {
  for (EndedJob& job : jobs) unkept_.push_back(std::move(job));
}

void History::poll() {
  try {
    writing_.take();
  } catch (const std::exception& error) {
    note_("history of jobs: " + message_of(error));
  }
  if (writing_.is_busy() || unkept_.empty()) return;
  writing_.start([this, jobs = std::exchange(unkept_, {})] {
    keep(jobs);
    return true;
  });
}

/// The records first: they do not depend on space for a report.
void History::keep(const std::vector<EndedJob>& jobs) const {
  std::vector<material::JobRecord> records;
  records.reserve(jobs.size());
  for (const EndedJob& job : jobs) records.push_back(record_of(board_, job));
  for (const material::JobRecord& record : records) keep_record(library_, record);
  std::exception_ptr failure;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!jobs[i].report) continue;
    try {
      reports_.keep(records[i].report, jobs[i].report(records[i]));
    } catch (...) {
      failure = std::current_exception();  // the others may have less to write
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void History::end() {
  writing_ = {};  // waits
  try {
    keep(unkept_);
  } catch (const std::exception& error) {
    note_("history of jobs: " + message_of(error));
  }
}

Json history_json(const std::string& library, const Reports& reports) {
  const std::set<std::string> names = reports.names();
  Json jobs = Json::array();
  for (const material::JobRecord& job :
       material::last_jobs(run::library_file(library), max_shown)) {
    jobs.push_back({{"file", job.file},
                    {"board", job.board},
                    {"begin", job.begin},
                    {"end", job.end},
                    {"result", job.result},
                    {"message", job.message},
                    {"item", job.item},
                    {"dry", job.is_dry},
                    {"done", job.done},
                    {"total", job.total},
                    {"wasted_beats", or_null(job.wasted_beats)},
                    {"report", names.contains(job.report) ? Json(job.report) : Json()}});
  }
  return jobs;
}

Json materials_json(const std::string& library) {
  Json rows = Json::array();
  for (const material::Setting& setting :
       run::library_for_reading(library).all<material::Setting>())
    rows.push_back({{"material", setting.material},
                    {"laser", setting.laser},
                    {"operation", setting.operation},
                    {"thickness", or_null(setting.thickness_mm)},
                    {"feed", setting.feed_mm_min},
                    {"power", setting.power_w},
                    {"passes", setting.passes},
                    {"kerf", or_null(setting.kerf_mm)},
                    {"note", setting.note}});
  return rows;
}

}  // namespace lamplock::serve
