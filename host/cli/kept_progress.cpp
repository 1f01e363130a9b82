#include "host/cli/kept_progress.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <string>

#include "host/cli/console.hpp"
#include "host/cli/staged_file.hpp"
#include "host/error.hpp"
#include "host/model/write_points.hpp"

namespace lamplock::cli {
namespace {

/// The points of a doubtful part, beside the journal; a part of its own for each end.
std::string write_doubtful(const Work& work, const link::Continuation& rest,
                           const std::filesystem::path& journal) {
  std::string file =
      fmt::format("{}.doubtful-{}-{}.xyz", journal.string(), rest.first, rest.from - 1);
  const std::size_t first = work.job.points_before(rest.first);
  const std::size_t count = work.job.points_before(rest.from) - first;
  write_whole(file, [&](const std::filesystem::path& path) {
    model::write_xyz(path, std::span(work.points).subspan(first, count));
  });
  return file;
}

void list_doubtful(const Work& work, const link::Continuation& rest,
                   const std::filesystem::path& journal, Console& console) {
  if (!rest.in_doubt()) return;
  std::string text = fmt::format("{} ({}): left out", link::doubt_text(rest, work.job.item()),
                                 rest.from - rest.first);
  if (!work.job.is_rows()) text += ", written to " + write_doubtful(work, rest, journal);
  console.phase("doubtful", text);
}

}  // namespace

std::unique_ptr<link::KeptJob> keep_progress(const Work& work, BoardOptions& options,
                                             link::Transport* port, Console& console) {
  if (port == nullptr || options.dry || work.job.header.dry) return nullptr;
  const std::string file = options.progress.empty() ? work.input + ".progress" : options.progress;
  auto kept = std::make_unique<link::KeptJob>(file, work.job);
  if (options.resume) {
    const link::Continuation rest = kept->find(*port);
    list_doubtful(work, rest, file, console);
    if (rest.from >= work.job.size())
      throw Error(
          Exit::job_failed, file,
          rest.in_doubt() ? link::doubt_text(rest, work.job.item()) + ", nothing else is left"
                          : "nothing is left to fire",
          fmt::format("remove the file, or fire the doubtful ones with --from {}", rest.first));
    options.from = rest.from;
    options.fired = rest.flashes;
    console.phase("resume", "at " + link::go_on_options(rest));
  } else if (!options.discard && options.from == 0 && options.fired == 0) {
    kept->require_ended();
  }
  kept->begin_at(options.from, options.fired);
  return kept;
}

}  // namespace lamplock::cli
