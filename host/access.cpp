#include "host/access.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lamplock {
namespace {

/// The group that may read and write the node; empty if that is root's, or there is none.
std::string group_with_access(const std::filesystem::path& node) {
  struct stat status {};
  constexpr mode_t both = S_IRGRP | S_IWGRP;
  if (::stat(node.c_str(), &status) != 0 || status.st_gid == 0 || (status.st_mode & both) != both)
    return "";
  const group* const found = ::getgrgid(status.st_gid);
  return found == nullptr ? "" : found->gr_name;
}

/// Chips of lines: the installed rules grant no access to them by default.
bool is_line_chip(const std::filesystem::path& node) {
  return node.filename().string().starts_with("gpiochip");
}

}  // namespace

bool is_denied(int error) { return error == EACCES || error == EPERM; }

std::string access_remedy(const std::filesystem::path& node) {
  if (const std::string group = group_with_access(node); !group.empty())
    return fmt::format("join its group: sudo adduser $USER {}, then log in again", group);
  if (is_line_chip(node))
    return "enable the rule for lines that is a comment in 60-lamplock.rules, or run the program "
           "as "
           "root";
  return "install 60-lamplock.rules (cmake --install, or the Debian package), then plug in again";
}

AccessProblem access_problem(const std::filesystem::path& node) {
  if (::access(node.c_str(), R_OK | W_OK) == 0) return {};
  const int failure = errno;
  if (failure == ENOENT)
    return {fmt::format("there is no {}", node.string()),
            "in a container give access to the computer's /dev, otherwise plug in again"};
  if (!is_denied(failure))
    return {fmt::format("{} cannot be used ({})", node.string(), std::strerror(failure)),
            "plug in again"};
  return {fmt::format("no permission to use {}", node.string()), access_remedy(node)};
}

}  // namespace lamplock
