#include "host/cli/console.hpp"

#include <nlohmann/json.hpp>

#include "host/printable.hpp"

namespace lamplock::cli {

void Console::line(const std::string& text) {
  fmt::print(out_, "{}\n", printable(text));
  std::fflush(out_);
}

void Console::text(const std::string& text) {
  fmt::print(out_, "{}", text);
  std::fflush(out_);
}

void Console::phase(const std::string& name, const std::string& what) {
  const std::chrono::duration<double> taken = Clock::now() - phase_start_;
  say("{:<8} {} ({:.2f} s)", name, what, taken.count());
  restart_clock();
}

void Console::document(const Json& json) {
  if (!json_) return;
  // A file name need not be valid UTF-8.
  fmt::print(stdout, "{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace lamplock::cli
