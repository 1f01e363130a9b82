#include "host/cli/documents.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::cli {

Json bounds_json(const geometry::Bounds& b) {
  return {{"low_mm", {b.low.x, b.low.y, b.low.z}}, {"high_mm", {b.high.x, b.high.y, b.high.z}}};
}

Json spacing_json(const points::SpacingReport& spacing) {
  return {{"smallest_mm", spacing.min_mm},
          {"mean_mm", spacing.mean_mm},
          {"largest_mm", spacing.max_mm},
          {"duplicates", spacing.duplicates}};
}

Json job_json(const run::JobOutcome& outcome) {
  Json json = Json::parse(report::to_json(outcome.report));
  json["flashes_fired"] = outcome.result.flashes_fired;
  json["warnings"] = outcome.run.warnings;
  json["not_written"] = outcome.lost.names();
  return json;
}

}  // namespace lamplock::cli
