#include "host/run/lost_files.hpp"

#include <fmt/format.h>

#include <exception>

#include "host/output_error.hpp"

namespace lamplock::run {

void LostFiles::attempt(const std::string& file, const std::function<void()>& write) {
  try {
    write();
  } catch (const OutputError& error) {
    all_.push_back({file, error.problem()});
  } catch (const Error& error) {
    all_.push_back({file, fmt::format("cannot be written ({})", error.message())});
  } catch (const std::exception& error) {
    all_.push_back({file, std::string("cannot be written (") + error.what() + ")"});
  }
}

std::vector<std::string> LostFiles::names() const {
  std::vector<std::string> names;
  names.reserve(all_.size());
  for (const LostFile& lost : all_) names.push_back(lost.file);
  return names;
}

Exit LostFiles::report(Exit exit, const std::string& done, Frontend& frontend) const {
  for (const LostFile& lost : all_)
    frontend.notice(
        Error(Exit::job_failed, lost.file, fmt::format("{}, but this file {}", done, lost.reason),
              "do not run it a second time for the file; check folder, permissions and free space")
            .what());
  return exit == Exit::done && !all_.empty() ? Exit::job_failed : exit;
}

}  // namespace lamplock::run
