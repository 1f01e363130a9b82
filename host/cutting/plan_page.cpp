#include "host/cutting/plan_page.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/json_in_script.hpp"

namespace lamplock::cutting {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view plan_place = "@PLAN@", data_place = "@DATA@";
constexpr std::array<const char*, 4> kind_names{"cut", "score", "engrave", "ignore"};

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

Json path_json(const std::vector<TimedPiece>& path) {
  constexpr double per_mm = 1000, per_power = 1000, per_s = 100;
  Json numbers = Json::array();
  if (path.size() > max_page_pieces) return numbers;
  for (const TimedPiece& piece : path) {
    numbers.push_back(rounded(piece.to.x, per_mm));
    numbers.push_back(rounded(piece.to.y, per_mm));
    numbers.push_back(rounded(piece.power, per_power));
    numbers.push_back(piece.is_rapid ? 1 : 0);
    numbers.push_back(rounded(piece.end_s, per_s));
  }
  return numbers;
}

Json operations_json(const std::vector<Operation>& operations) {
  Json rows = Json::array();
  for (const Operation& one : operations) {
    if (one.kind == OperationKind::ignore) continue;
    const std::size_t passes =
        one.z_mm.empty() ? static_cast<std::size_t>(one.passes) : one.z_mm.size();
    rows.push_back({one.name, kind_names[static_cast<std::size_t>(one.kind)],
                    fmt::format("{:g}", 100 * one.power), fmt::format("{:g}", one.feed_mm_min),
                    fmt::format("{}", passes), fmt::format("{:g}", one.kerf_mm)});
  }
  return rows;
}

Json cuts_json(const std::vector<PageCut>& cuts) {
  Json rows = Json::array();
  for (const PageCut& cut : cuts)
    rows.push_back({{"number", cut.number},
                    {"name", cut.name},
                    {"operation", cut.operation},
                    {"begin_s", cut.begin_s},
                    {"end_s", cut.end_s}});
  return rows;
}

Json page_json(const PlanPage& page, const std::vector<Operation>& operations) {
  Json numbers = Json::array();
  for (const auto& [name, value] : page.numbers) numbers.push_back({name, value});
  return {{"title", page.title},
          {"warnings", page.warnings},
          {"tiles", numbers},
          {"operations", operations_json(operations)},
          {"cuts", cuts_json(page.cuts)},
          {"start", {page.start.x, page.start.y}},
          {"path", path_json(page.path)}};
}

}  // namespace

std::string plan_page(const PlanPage& page, const std::vector<Operation>& operations) {
  const std::string_view whole = plan_page_text();
  const std::size_t plan = whole.find(plan_place), data = whole.find(data_place);
  std::string text(whole.substr(0, plan));
  text += page.svg;
  text += whole.substr(plan + plan_place.size(), data - plan - plan_place.size());
  text += json_in_script(page_json(page, operations));
  text += whole.substr(data + data_place.size());
  return text;
}

}  // namespace lamplock::cutting
