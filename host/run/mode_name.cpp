#include "host/run/mode_name.hpp"

#include "shared/wire/job_header.hpp"

namespace lamplock::run {

wire::JoinMode mode_named(const std::string& name) {
  if (name == "path") return wire::JoinMode::path;
  return name == "free" ? wire::JoinMode::free : wire::JoinMode::start_stop;
}

std::string mode_name(std::uint8_t mode) {
  if (mode == wire::mode_rows) return "rows";
  switch (static_cast<wire::JoinMode>(mode)) {
    case wire::JoinMode::start_stop:
      return "start-stop";
    case wire::JoinMode::path:
      return "path";
    case wire::JoinMode::free:
      return "free";
  }
  return "unknown";
}

}  // namespace lamplock::run
