#include "host/program/flow_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/program_error.hpp"

namespace lamplock::program_run {

namespace fs = std::filesystem;

namespace {

/// Throws ProgramError for every error in it.
std::unique_ptr<FlowUnit> unit_in_file(const std::string& path) {
  try {
    return std::make_unique<FlowUnit>(
        flow_unit_of(link::program_lines(read_text_file(path), path), path));
  } catch (const ProgramError&) {
    throw;
  } catch (const Error& error) {
    throw ProgramError(error, path);
  }
}

}  // namespace

const FlowUnit* FlowFiles::with_sub(const std::string& label, const FlowUnit& caller,
                                    const ProgramPlace& where) {
  if (caller.subs.contains(label)) return &caller;
  if (program_.subs.contains(label)) return &program_;
  std::string name = label;
  if (name.front() == '<') name = name.substr(1, name.size() - 2);
  const fs::path folder = fs::path(program_.file).parent_path();
  const bool is_name = name.find_first_of("/\\") == std::string::npos && !name.starts_with('.');
  const fs::path path = folder / (name + ".ngc");
  std::error_code ignored;
  if (!is_name || !fs::is_regular_file(path, ignored))
    throw ProgramError(where,
                       fmt::format("there is no sub o{}, and no file {}", label, path.string()),
                       "write the sub, or a file of this name that has it");
  std::unique_ptr<FlowUnit>& unit = files_[label];
  if (!unit) unit = unit_in_file(path.string());
  if (!unit->subs.contains(label))
    throw ProgramError({path.string()}, fmt::format("has no sub o{}", label),
                       fmt::format("add a line o{} sub and a line o{} endsub", label, label));
  return unit.get();
}

}  // namespace lamplock::program_run
