#include "host/cli/file_options.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/file/output_files.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/output_name.hpp"
#include "host/run/report_folder.hpp"

namespace lamplock::cli {
namespace {

/// The name that the user gave; empty: none.
std::string file_of(const Option& option) {
  return std::visit(
      [](const auto* place) -> std::string {
        using Value = std::remove_cv_t<std::remove_pointer_t<decltype(place)>>;
        if constexpr (std::is_same_v<Value, std::string>) return *place;
        if constexpr (std::is_same_v<Value, std::optional<std::string>>) return place->value_or("");
        return "";
      },
      option.target());
}

/// The first name of an option as users know it: "-o", "--report", "OUTPUT".
std::string short_name(const Option& option) {
  return option.is_positional() ? option.name() : option.typed_names().front();
}

bool prints_json(const Command& command) {
  return std::ranges::any_of(command.options(), [](const Option& option) {
    return option.name() == "--json" && option.is_given();
  });
}

/// In one file the messages of the command and its output would overwrite each other, and in a pipe
/// a JSON document would not be alone. A pipe without --json receives messages and output.
void check_is_not_standard_output(const Command& command, const std::string& file) {
  const bool is_mixed = prints_json(command) || !is_special(file);
  if (!is_mixed || !is_standard_output(file)) return;
  throw Error(Exit::bad_input, file, "is the standard output, to which this command prints",
              "give a file name");
}

}  // namespace

void check_files(const Command& command) {
  std::vector<Output> outputs;
  std::vector<std::string> inputs;
  for (const Option& option : command.options()) {
    const std::string file = file_of(option);
    if (file.empty()) continue;
    if (option.file_use() == FileUse::read) inputs.push_back(file);
    if (option.file_use() == FileUse::write) outputs.push_back({short_name(option), file});
    if (option.file_use() == FileUse::write_report)
      for (const std::filesystem::path& part : run::files_of_report(file))
        outputs.push_back({short_name(option), part.string()});
  }
  for (const Output& output : outputs) check_is_not_standard_output(command, output.file);
  check_distinct(outputs, inputs);
  for (const Option& option : command.options())
    if (const std::string file = file_of(option); !file.empty() && !option.file_ending().empty())
      run::check_output_name(file, option.file_ending());
}

}  // namespace lamplock::cli
