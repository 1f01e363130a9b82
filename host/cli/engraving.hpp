// What is engraved where, and how: what the commands that make points or jobs have in common.
//
// In:  the command line: a file with options, or a description that says it all. Out: a description
//      (host/glass/description.hpp); from that to a job.
// Who: `points`, `frame`, `engrave`, `job`, `estimate`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/work.hpp"
#include "host/glass/description.hpp"
#include "host/glass/volume.hpp"

namespace lamplock::cli {

class Command;
class Console;
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
  /// With --save: writes the description.
  void save(const glass::Description& description, Console& console) const;

 private:
  void add_section(Command& app, const std::vector<glass::Parameter>& parameters,
                   const std::string& group);

  glass::Description said_{.objects = std::vector<glass::Object>(1)};
  std::vector<Option*> options_;  ///< that a description has keys for
  std::string save_;
};

/// Reads, discretises, orders and rounds to steps; with --save also saves. `origin`: where that of
/// the description lies on the machine, mm, if not in its origin; the points of the work are the
/// machine's. Throws Error(bad_input).
Work make_work(const EngravingOptions& options, bool dry, Console& console,
               const std::optional<points::Point>& origin = std::nullopt);

/// The volume for a job, in its own coordinates: objects lie round `origin`, if there is one.
glass::Volume volume_at(const std::optional<points::Point>& origin,
                        const glass::Description& description, const settings::Values& values);
/// From these coordinates to the machine's: moves points and the glass that they are in.
void move_to(const std::optional<points::Point>& origin, points::PointCloud& points,
             glass::Volume& volume);

}  // namespace lamplock::cli
