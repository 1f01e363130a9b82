#include "host/run/image_path.hpp"

#include <fmt/format.h>
#include <sys/auxv.h>

#include <filesystem>
#include <system_error>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

/// From the folder of the program: a build, an installation.
constexpr const char* folders[] = {".", "../share/lamplock"};

/// This program's file; empty if the system does not report it.
fs::path own_file() {
  std::error_code failed;
  fs::path link = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) return link;
  // No /proc, as in a bare chroot: the name that the kernel was given (getauxval(3)).
  // NOLINTNEXTLINE(performance-no-int-to-ptr): getauxval() returns the address as a number
  const auto* name = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  return name == nullptr ? fs::path() : fs::path(name);
}

}  // namespace

std::string file_of_program_at(const std::string& program, const std::string& name) {
  std::error_code failed;
  const fs::path folder = fs::canonical(program, failed).parent_path();
  if (failed) return {};
  for (const char* const there : folders) {
    const fs::path file = (folder / there / name).lexically_normal();
    if (fs::is_regular_file(file, failed)) return file.string();
  }
  return {};
}

std::string file_of_program(const std::string& name) {
  return file_of_program_at(own_file().string(), name);
}

std::string image_path(const std::string& given, const char* name, const std::string& where) {
  if (!given.empty()) return given;
  if (std::string file = file_of_program(name); !file.empty()) return file;
  throw Error(Exit::bad_input, where,
              fmt::format("there is no {} beside the program or in ../share/lamplock", name),
              "build the firmware, or give its file");
}

}  // namespace lamplock::run
