#include "host/run/output_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/model/input.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::run {
namespace {

/// Endings of files that this program writes or reads, beside models, pictures and programs.
constexpr std::array<std::string_view, 7> endings{".llj",  ".toml", ".db", ".json",
                                                  ".html", ".csv",  ".vcd"};
constexpr std::string_view any_text = ".txt";

bool has_kind(const std::string& file) {
  const std::string ending = lower_extension(file);
  if (ending == any_text) return false;
  return std::find(endings.begin(), endings.end(), ending) != endings.end() ||
         is_program_name(file) || model::kind_of(file).has_value();
}

}  // namespace

void check_output_name(const std::string& output, std::string_view ending) {
  const std::string given = lower_extension(output);
  if (is_special(output) || given == ending || !has_kind(output)) return;
  throw Error(Exit::bad_input, output,
              fmt::format("'{}' is the ending of another file type", given),
              fmt::format("give a name that ends in {}", ending));
}

}  // namespace lamplock::run
