#include "host/run/kept_progress.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <string>

#include "host/error.hpp"
#include "host/file/append_file.hpp"
#include "host/file/staged_file.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/model/write_points.hpp"
#include "host/output_error.hpp"
#include "host/run/before_firing.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {
namespace {

/// The points of a doubtful part, beside the journal; a part of its own for each end.
std::string write_doubtful(const PreparedJob& prepared, const link::Continuation& rest,
                           const std::filesystem::path& journal) {
  std::string file =
      fmt::format("{}.doubtful-{}-{}.xyz", journal.string(), rest.first, rest.from - 1);
  const std::size_t first = prepared.job.points_before(rest.first);
  const std::size_t count = prepared.job.points_before(rest.from) - first;
  write_whole(file, [&](const std::filesystem::path& path) {
    model::write_xyz(path, std::span(prepared.points).subspan(first, count));
  });
  return file;
}

void list_doubtful(const PreparedJob& prepared, const link::Continuation& rest,
                   const std::filesystem::path& journal, Frontend& frontend) {
  if (!rest.in_doubt()) return;
  std::string text = fmt::format("{} ({}): left out", link::doubt_text(rest, prepared.job.item()),
                                 rest.from - rest.first);
  if (!prepared.job.is_rows()) text += ", written to " + write_doubtful(prepared, rest, journal);
  frontend.phase("doubtful", text);
}

/// Proves that the journal can be written, read back and removed. Throws Error(bad_input).
void check_journal(const std::string& file) {
  const auto refuse = [&file](const std::string& problem) {
    throw Error(Exit::bad_input, file,
                fmt::format("the progress of the job is kept there, but the file {}", problem),
                "choose another file with --progress FILE");
  };
  try {
    if (is_special(file)) refuse("is a device or a folder");
    check_target(file);
    check_appendable(file);
  } catch (const OutputError& error) {
    refuse(error.problem());
  }
}

}  // namespace

std::unique_ptr<link::KeptJob> keep_progress(const PreparedJob& prepared, BoardOptions& options,
                                             link::Transport* port, Frontend& frontend) {
  if (port == nullptr || options.dry || prepared.job.header.dry) return nullptr;
  const std::string file =
      options.progress.empty() ? prepared.input + ".progress" : options.progress;
  check_journal(file);
  auto kept = std::make_unique<link::KeptJob>(file, prepared.job);
  if (options.resume) {
    const link::Continuation rest = before_firing([&] { return kept->find(*port); });
    list_doubtful(prepared, rest, file, frontend);
    if (rest.from >= prepared.job.size())
      throw Error(
          Exit::bad_input, file,
          rest.in_doubt() ? link::doubt_text(rest, prepared.job.item()) + ", nothing else is left"
                          : "nothing is left to fire",
          fmt::format("remove the file, or fire the doubtful ones with --from {}", rest.first));
    options.from = rest.from;
    options.fired = rest.flashes;
    frontend.phase("resume", "at " + link::continuation_options(rest));
  } else if (!options.discard && options.from == 0 && options.fired == 0) {
    kept->require_ended();
    if (const auto at = kept->stopped_at(); at && *at != 0)
      frontend.notice(
          fmt::format("the last run of this job was stopped before {0} {1}, and this one begins at "
                      "{0} 0 again; "
                      "--resume continues the last run",
                      prepared.job.item(), *at));
  }
  kept->begin_at(options.from, options.fired);
  return kept;
}

}  // namespace lamplock::run
