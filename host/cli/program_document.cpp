#include "host/cli/program_document.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lamplock::cli {

Json program_json(const run::ProgramOutcome& outcome) {
  const link::LineResult& result = outcome.result;
  Json errors = Json::array();
  for (const link::LineError& e : result.errors)
    errors.push_back({{"line", e.line}, {"error", e.error}, {"text", link::error_text(e.error)}});
  const auto or_null = [](bool there, auto value) { return there ? Json(value) : Json(nullptr); };
  std::vector<std::string> not_written = outcome.lost.names();
  if (!outcome.lost_events.empty()) not_written.push_back(outcome.lost_events);
  return {
      {"program", outcome.file},
      {"end", run::end_name(outcome)},
      {"lines", outcome.lines},
      {"answered", result.answered},
      {"last_line", or_null(result.last_line != 0, result.last_line)},
      {"errors", errors},
      {"alarm", or_null(result.alarm != 0, result.alarm)},
      {"seconds", std::chrono::duration<double>(result.elapsed).count()},
      {"planned_seconds", or_null(outcome.planned_s.has_value(), outcome.planned_s.value_or(0))},
      {"state", result.status.state},
      {"position", result.status.position},
      {"of_work", result.status.of_work},
      {"work_offset", result.status.work_offset},
      {"not_written", not_written}};
}

}  // namespace lamplock::cli
