#include "host/cli/mode_name.hpp"

#include "shared/wire/job_header.hpp"

namespace lamplock::cli {

motion::JoinMode mode_named(const std::string& name) {
  if (name == "path") return motion::JoinMode::path;
  return name == "free" ? motion::JoinMode::free : motion::JoinMode::start_stop;
}

std::string mode_name(std::uint8_t mode) {
  if (mode == wire::mode_rows) return "rows";
  switch (static_cast<motion::JoinMode>(mode)) {
    case motion::JoinMode::start_stop:
      return "start-stop";
    case motion::JoinMode::path:
      return "path";
    case motion::JoinMode::free:
      return "free";
  }
  return "unknown";
}

}  // namespace lamplock::cli
