#include "host/cli/separate_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "host/cli/command_line.hpp"
#include "host/run/image_path.hpp"

namespace lamplock::cli {

bool has_separate_program(const Command& command) {
  return !run::file_of_program(command.separate_program()).empty();
}

void run_separate_program(const Command& command, const std::vector<std::string>& arguments) {
  const std::string& name = command.separate_program();
  const std::string where = "lamplock " + command.name();
  std::string file = run::file_of_program(name);
  if (file.empty())
    throw Error(Exit::bad_input, where,
                fmt::format("there is no {} beside lamplock or in its ../share/lamplock", name),
                fmt::format("build it with cmake --build build --target {}", name));
  std::vector<std::string> words(arguments);
  std::vector<char*> list{file.data()};
  for (std::string& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  ::execv(file.c_str(), list.data());
  throw Error(Exit::bad_input, where, fmt::format("{} cannot be started", file),
              "check its permissions");
}

}  // namespace lamplock::cli
