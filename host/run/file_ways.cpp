#include "host/run/file_ways.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/model/input.hpp"
#include "host/run/read_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {
namespace {

FileWay way_of_model(model::InputKind kind, const std::string& file) {
  using model::InputKind;
  switch (kind) {
    case InputKind::mesh:
      return {"is a mesh", way_to_job(file)};
    case InputKind::bitmap:
      return {"is a picture", way_to_job(file)};
    case InputKind::points:
      return {"is a list of points", way_to_job(file)};
    case InputKind::curves:
      return {"is a drawing", way_to_job(file)};
  }
  return {};
}

}  // namespace

FileWay way_of_file(const std::string& file) {
  const std::string name = shell_text({file});
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  if (is_job_file(file))
    return {"is a job",
            fmt::format("run it: lamplock send {0}, show it: lamplock job --show {0}", name)};
  if (is_program_file(file))
    return {"is a program of G-code",
            fmt::format("check it: lamplock check {0}, run it: lamplock send {0}", name)};
  if (const auto kind = model::kind_of(file)) return way_of_model(*kind, file);
  if (glass::is_description(file)) return {"is a job description (TOML)", way_to_job(file)};
  return {};
}

void refuse_empty(const std::string& file) {
  if (is_special(file)) check_is_file(file);
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure) ||
      std::filesystem::file_size(file, failure) != 0 || failure)
    return;
  const std::string name = shell_text({file});
  std::string remedy = "give another file";
  const auto kind = model::kind_of(file);
  if (lower_extension(file) == ".llj")
    remedy = fmt::format(
        "make the job again: lamplock job MODEL -o {0} (points), or lamplock raster PICTURE --feed "
        "MM_MIN --machine FILE.toml -o {0} (rows)",
        name);
  else if (kind == model::InputKind::points)
    remedy = fmt::format(
        "write one point a line: x y z in mm, or make points: lamplock points MODEL -o {}", name);
  else if (kind)
    remedy = "export it again";
  else if (is_program_name(file))
    remedy = "write G-code to it; lamplock check shows what is wrong in it";
  throw Error(Exit::bad_input, file, "the file is empty", remedy);
}

void refuse_finished(const std::string& file) {
  refuse_empty(file);
  if (model::kind_of(file) && !is_job_file(file)) return;
  const FileWay way = way_of_file(file);
  if (way && (is_job_file(file) || is_program_file(file)))
    throw Error(Exit::bad_input, file, way.what + ", not a model, a picture or points", way.remedy);
}

void refuse_for_picture(const std::string& file) {
  refuse_finished(file);
  const auto kind = model::kind_of(file);
  if (!kind || kind == model::InputKind::bitmap) return;
  if (const FileWay way = way_of_file(file))
    throw Error(Exit::bad_input, file, way.what + ", not a picture", way.remedy);
}

}  // namespace lamplock::run
