#include "host/run/read_job.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/description_file.hpp"
#include "host/job/job_file.hpp"
#include "host/model/input.hpp"
#include "host/run/file_ways.hpp"
#include "host/run/job_points.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {

std::string way_to_job(const std::string& file) {
  using model::InputKind;
  const std::optional<InputKind> kind = model::kind_of(file);
  if (!kind && !glass::is_description(file)) return "";
  const std::string job =
      shell_text({std::filesystem::path(file).replace_extension(".llj").string()});
  const std::string name = shell_text({file});
  std::string points = fmt::format("make a job of it: lamplock job {} -o {}", name, job);
  if (kind == InputKind::curves) {
    const std::string program =
        shell_text({std::filesystem::path(file).replace_extension(".ngc").string()});
    return fmt::format("cut it: lamplock cut {} --power PERCENT --feed MM_MIN -o {}, or {}", name,
                       program, points);
  }
  if (kind != InputKind::bitmap) return points;
  return fmt::format(
      "{} (points in glass), or lamplock raster {} --feed MM_MIN --machine FILE.toml -o {} (rows)",
      points, name, job);
}

job::Job read_job(const std::string& file) {
  check_is_file(file);
  refuse_empty(file);
  if (!job::starts_with_job(file))
    if (const FileWay way = way_of_file(file); way && lower_extension(file) != ".llj")
      throw Error(Exit::bad_input, file, way.what + ", not a lamplock job file", way.remedy);
  return job::read_job_file(file);
}

PreparedJob read_prepared_job(const std::string& file) {
  PreparedJob prepared{file, {}, read_job(file)};
  if (!prepared.job.is_rows()) prepared.points = points_of(prepared.job);
  return prepared;
}

}  // namespace lamplock::run
