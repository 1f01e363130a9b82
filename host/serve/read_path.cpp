#include "host/serve/read_path.hpp"

#include <vector>

#include "host/link/program_lines.hpp"
#include "host/run/read_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/check_file.hpp"
#include "host/serve/material_choice.hpp"

namespace lamplock::serve {

ShownPath read_path(const std::string& path, const run::MachineOptions& machine,
                    const run::ProcessChoice& material) {
  if (run::kind_of_sent_file(path) == run::SentKind::job) {
    refuse_for_jobs(material);
    const run::PreparedJob prepared = run::read_prepared_job(path);
    return ShownPath(prepared.job.is_rows() ? places_of(prepared.job) : std::vector<PathPlace>());
  }
  const run::CheckOptions options = check_options(path, machine, material);
  std::vector<std::size_t> sent;
  for (const link::ProgramLine& line : link::program_lines(run::read_program_text(path), path))
    sent.push_back(line.number);
  return ShownPath(places_of(run::check_program(options), sent));
}

}  // namespace lamplock::serve
