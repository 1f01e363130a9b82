// A report folder, which is proved writable before a job and filled after it, and reports read
// back.
//
// In:  a judged run, or a folder. Out: the folder with its files, or the report. Who: run_job(),
// report_job(), compare.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/file/reserved_file.hpp"
#include "host/file/unfinished_paths.hpp"
#include "host/report/report.hpp"
#include "host/run/lost_files.hpp"

namespace lamplock::run {

/// The files of a report in a folder; none of no folder ("").
std::vector<std::filesystem::path> files_of_report(const std::filesystem::path& folder);

/// Proves that a report can be written there, before there is one, and leaves nothing. Throws
/// Error(bad_input).
void check_report_folder(const std::filesystem::path& folder);

/// Refuses a folder with the report of a run that ended early: the report of the rest of the job
/// would replace it. Throws Error(bad_input), which names a free folder.
void refuse_first_part(const std::filesystem::path& folder);

/// The folder of a report that will be written once a job has been run. Without write_numbers()
/// nothing is left of it.
class ReportFolder {
 public:
  /// Makes the folder if needed and reserves space for report.json. Throws Error(bad_input).
  explicit ReportFolder(std::filesystem::path folder);
  ~ReportFolder();
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;

  /// Writes report.json, once. All files of an older report in the folder go first: files of two
  /// jobs must not be mixed.
  void write_numbers(const report::Report& report, LostFiles& lost);
  /// Writes report.json and report.html of a program that was run, instead of those of a job.
  void write_program(std::string_view numbers, std::string_view page, LostFiles& lost);
  /// Writes the other files, each whole or not at all; pictures last.
  void write_rest(const report::Report& report, const report::JobRun& run, LostFiles& lost) const;

 private:
  void write_json(std::string_view text, LostFiles& lost);
  void make_folders();
  void remove_folders();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< by this object, the innermost one first
  /// The same, the outermost one first, until a file is in them.
  std::deque<UnfinishedPath> unfinished_;
  std::optional<ReservedFile> numbers_;
};

/// Names of two reports for people: the ends of their paths, as long as needed to differ.
std::array<std::string, 2> report_names(const std::filesystem::path& first,
                                        const std::filesystem::path& second);

/// Reads report.json of a folder. Throws Error(bad_input) if it is not there or not ours.
report::Report read_report(const std::filesystem::path& folder);

}  // namespace lamplock::run
