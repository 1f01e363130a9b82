#include "host/former_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <string>

#include "host/printable.hpp"
#include "host/remark.hpp"

namespace lamplock {

std::string_view present_name(std::string_view name) {
  const auto* const found =
      std::find_if(former_names.begin(), former_names.end(),
                   [name](const FormerName& known) { return known.former == name; });
  return found == former_names.end() ? name : found->present;
}

void note_former_name(std::string_view where, std::string_view former) {
  static std::mutex mutex;
  static std::set<std::string> printed;  // a command may read its profile twice
  const std::string note = printable(
      fmt::format("note: {}: '{}' is now named '{}'", where, former, present_name(former)));
  const std::lock_guard lock(mutex);
  if (printed.insert(note).second) write_remark(note + '\n');
}

}  // namespace lamplock
