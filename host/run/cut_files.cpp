#include "host/run/cut_files.hpp"

#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "host/cutting/plan_picture.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/output_files.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/run/frontend.hpp"
#include "host/run/sent_file.hpp"
#include "host/run/unsaved_option.hpp"

namespace lamplock::run {
namespace {

/// Files that are all written or none.
class CutFiles {
 public:
  void add(const std::string& file, std::string_view text) {
    if (file.empty()) return;
    files_.push_back(std::make_unique<StagedFile>(file));
    write_file(files_.back()->path(), text);
  }
  void commit() {
    for (const auto& file : files_) file->commit();
  }

 private:
  std::vector<std::unique_ptr<StagedFile>> files_;
};

cutting::PlanPage page_of(const CutMade& made, const std::string& picture) {
  cutting::PlanPage page{made.title, picture};
  for (const cutting::PlannedCut& cut : made.plan.cuts)
    page.cuts.push_back({cut.number, made.names[cut.shape], made.operations[cut.operation].name});
  return cut_page(std::move(page), made.program, made.result);
}

/// A description is a job, which is run from its first cut, with light.
void check_saved_options(const CutRequest& request) {
  refuse_unsaved(request.save, request.is_dry, "--dry");
  refuse_unsaved(request.save, request.is_frame, "--frame");
  refuse_unsaved(request.save, request.first != 1, "--from");
}

}  // namespace

void check_cut_outputs(const CutRequest& request) {
  check_saved_options(request);
  const DrawingChoice& drawing = request.description.drawing;
  check_distinct(
      {{"-o", request.output},
       {"--picture", request.picture},
       {"--page", request.page},
       {"--save", request.save}},
      {drawing.file, request.description.machine.profile, request.description.machine.post});
  if (!request.output.empty()) check_program_name(request.output);
  require_extension(request.picture, ".svg", "pictures of a plan are written as SVG");
  require_extension(request.page, ".html", "pages are written as HTML");
  if (!request.save.empty() && !glass::is_description(request.save))
    throw Error(Exit::bad_input, request.save, "is not the name of a description", "name it .toml");
  for (const std::string& file : {request.output, request.picture, request.page, request.save})
    if (!file.empty()) check_target(file);
}

CutReport report_of(const CutMade& made) {
  return {page_of(made, cutting::plan_svg(made.plan, made.shapes, made.operations, made.title)),
          made.operations};
}

void write_cut_files(const CutRequest& request, const CutMade& made, Frontend& frontend) {
  CutFiles files;
  if (!request.picture.empty() || !request.page.empty()) {
    const std::string picture =
        cutting::plan_svg(made.plan, made.shapes, made.operations, made.title);
    files.add(request.picture, picture);
    if (!request.page.empty())
      files.add(request.page, cutting::plan_page(page_of(made, picture), made.operations));
  }
  if (!request.save.empty())
    files.add(request.save,
              to_text(request.description, std::filesystem::absolute(request.save).parent_path()));
  files.add(request.output, made.result.program);
  files.commit();
  for (const std::string& file : {request.output, request.picture, request.page, request.save})
    if (!file.empty()) frontend.phase("written", file);
}

}  // namespace lamplock::run
