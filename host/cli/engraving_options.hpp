// The options that decide what is engraved, where and how.
//
// In:  the command line: a file with options, or a description that contains all of them. Out: a
//      description (host/glass/description.hpp), or the request of a job.
// Who: `points`, `frame`, `engrave`, `job`, `estimate`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/glass/description.hpp"
#include "host/run/prepare_job.hpp"

namespace lamplock::cli {

class Command;
class Option;

/// Everything that decides what is engraved, and how.
class EngravingOptions {
 public:
  std::string input{};

  /// Adds all options; the input is optional if the command can do without.
  void add(Command& app, bool input_required);
  /// Adds those that decide where points are: the object, the glass, the machine's profile.
  void add_place(Command& app, bool input_required);
  /// Adds --save.
  void add_save(Command& app);

  /// What was said: by the file if that is a description, else by the options. Throws
  /// Error(bad_input), also if both say something.
  glass::Description description() const;

  /// Refuses every option that decides what is engraved, where something else has decided it: the
  /// first one given is at fault. Throws Error(bad_input).
  void refuse_options(const std::string& why, const std::string& remedy) const;

  /// File of --save; empty: none.
  const std::string& save_file() const { return save_; }
  /// Refuses --save where nothing can be written, before any work is done. Throws Error(bad_input).
  void check_save() const;
  /// The request with these values; its origin is the machine's. Throws Error(bad_input).
  run::JobRequest request() const;

 private:
  void add_section(Command& app, const std::vector<glass::Parameter>& parameters,
                   const std::string& group);

  glass::Description said_{.objects = std::vector<glass::Object>(1)};
  std::vector<Option*> options_;  ///< that a description has keys for
  std::string save_;
};

}  // namespace lamplock::cli
