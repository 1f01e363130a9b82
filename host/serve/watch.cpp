#include "host/serve/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/serve/rpc_client.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

/// An end by the user is noticed after this time.
constexpr auto look_interval = 50ms;

std::string job_text(const Json& job) {
  const std::string name = job.value("name", "");
  if (name.empty()) return "";
  if (!job.value("running", false)) {
    const std::string end = job.value("end", ""), message = job.value("message", "");
    return end.empty()
               ? ""
               : fmt::format("; {}: {}{}{}", name, end, message.empty() ? "" : ": ", message);
  }
  std::string text =
      fmt::format("; {}: {} of {}", name, job.value("done", 0L), job.value("total", 0L));
  for (const char* key : {"word", "speed"})
    if (const std::string word = job.value(key, ""); !word.empty()) text += ", " + word;
  if (job.value("dry", false)) text += ", laser off";
  if (const auto left = job.find("left_s"); left != job.end() && left->is_number())
    text += fmt::format(", {:.0f} s left", left->get<double>());
  return text;
}

/// Waits, and says whether the user has ended it.
bool is_ended(std::chrono::milliseconds wait, const run::Interrupts& interrupts) {
  for (; wait > 0ms && interrupts.count() == 0; wait -= look_interval)
    std::this_thread::sleep_for(std::min<std::chrono::milliseconds>(wait, look_interval));
  return interrupts.count() > 0;
}

}  // namespace

std::string status_text(const Json& status) {
  const Json& board = status.at("board");
  if (!board.value("connected", false))
    return "no board: " + board.value("problem", std::string("not connected"));
  std::string text = board.value("state", "");
  const Json place = board.value("machine", Json::array());
  constexpr std::string_view axes = "XYZA";
  for (std::size_t i = 0; i < std::min(place.size(), axes.size()); ++i)
    text += fmt::format("{} {} {:.3f}", i == 0 ? " " : "", axes[i], place[i].get<double>());
  if (!place.empty()) text += " mm";
  return text + job_text(status.at("job"));
}

void watch(const WatchOptions& options, const WatchSink& sink, run::Frontend& frontend) {
  RpcClient client(parse_page_address(options.page));
  if (options.once) return sink(client.call("status", Json::object()));
  const auto interrupts = frontend.interrupts();
  Json shown;
  std::uint64_t line = 0;
  do {
    Json status = client.call("status", Json::object());
    const Json lines = client.call("console.lines", {{"after", line}});
    if (status == shown && lines.empty()) continue;
    shown = status;
    if (!lines.empty()) line = lines.back().at("number");
    status["console"] = lines;
    sink(status);
  } while (!is_ended(options.every, *interrupts));
}

}  // namespace lamplock::serve
