#include "host/run/user_commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds wait_of_step{20};

std::string path_of(const program_run::UserCommand& command, const std::string& folder) {
  return (fs::path(folder) / command.name()).string();
}

void check_executable(const program_run::UserCommand& command, const std::string& folder,
                      const std::string& where) {
  const std::string path = path_of(command, folder);
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
    throw Error(Exit::bad_input, where,
                fmt::format("'{}': there is no file {}", command.name(), path),
                "write this program, or take the line out");
  if (::access(path.c_str(), X_OK) != 0)
    throw Error(Exit::bad_input, where, fmt::format("{} is not executable", path),
                "permit it: chmod +x " + path);
}

}  // namespace

CommandLines user_commands_of(const std::vector<link::ProgramLine>& lines, const std::string& file,
                              const std::string& folder, bool skips_expressions) {
  CommandLines commands;
  if (folder.empty()) return commands;
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw Error(Exit::bad_input, "--user-commands", fmt::format("{}: no such folder", folder),
                "give the folder that has M100 to M199");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = fmt::format("{}:{}", file, lines[i].number);
    if (skips_expressions && lines[i].text.find_first_of("#[") != std::string::npos) continue;
    const auto command = program_run::user_command_of(lines[i], file);
    if (!command) continue;
    check_executable(*command, folder, where);
    commands[i] = *command;
  }
  return commands;
}

/// FILE:LINE, and the place in another file if the line is from there.
std::string UserCommands::place(std::size_t index) const {
  const link::ProgramLine& line = program_.lines[index];
  const std::string in_file = line.origin.empty() ? "" : fmt::format(" (in {})", line.origin);
  return fmt::format("{}:{}{}", program_.file, line.number, in_file);
}

bool UserCommands::run(std::size_t index) {
  const program_run::UserCommand& command = lines_.at(index);
  const std::string path = path_of(command, folder_);
  if (!process_) {
    progress_.note("user command: " + command.name());
    process_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{path, fmt::format("{:.6f}", command.p),
                                 fmt::format("{:.6f}", command.q)},
        place(index));
  }
  const std::optional<std::string> end = process_->wait(wait_of_step);
  if (!end) return false;
  process_.reset();
  if (!end->empty())
    throw Error(Exit::job_failed, place(index),
                fmt::format("{}: {}, so the program ends", path, *end),
                "correct what the command reports, and send the program again");
  return true;
}

}  // namespace lamplock::run
