#include "host/cutting/post_needs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "host/error.hpp"

namespace lamplock::cutting {
namespace {

std::string name_of(PostEvent event) { return post_event_names[static_cast<std::size_t>(event)]; }
std::string braced(PostValue value) {
  return fmt::format("{{{}}}", post_value_names[static_cast<std::size_t>(value)]);
}

/// What the moves of a plan have.
struct PlanUse {
  std::set<PostEvent> moves;  ///< line, arc_cw, arc_ccw
  std::set<double> powers;    ///< of its operations
  bool has_dark_begin = false;
  bool changes_power = false;  ///< within strokes
};

PlanUse use_of(const CutPlan& plan, const std::vector<Operation>& operations) {
  PlanUse use;
  for (const PlannedCut& cut : plan.cuts) {
    use.powers.insert(operations[cut.operation].power);
    for (const Stroke& stroke :
         cut.controller ? std::vector<Stroke>{cut.controller->drawn} : cut.strokes) {
      use.has_dark_begin = use.has_dark_begin || stroke.front().power <= 0;
      for (const CutMove& move : stroke) {
        use.changes_power = use.changes_power || move.power != 1;
        use.moves.insert(move.edge.is_line()   ? PostEvent::line
                         : move.edge.sweep > 0 ? PostEvent::arc_ccw
                                               : PostEvent::arc_cw);
      }
    }
  }
  return use;
}

class Needs {
 public:
  Needs(const Post& post, const std::string& where, const CutPlan& plan,
        const std::vector<Operation>& operations)
      : post_(post),
        where_(where),
        plan_(plan),
        operations_(operations),
        use_(use_of(plan, operations)) {}

  std::vector<std::string> require() {
    for (const PlannedCut& cut : plan_.cuts) require_cut(cut, operations_[cut.operation]);
    if (post_.machine != MachineType::laser) require_tool();
    if (post_.machine == MachineType::laser) require_light();
    if (post_.machine != MachineType::knife) require_power();
    if (!is_written_always(PostValue::feed))
      warnings_.push_back(fmt::format("{}: no line writes the feed, {{feed}}", where_));
    return std::move(warnings_);
  }

 private:
  bool writes(PostEvent event, PostValue value) const {
    const std::vector<std::string>& lines = post_.of(event);
    return std::any_of(lines.begin(), lines.end(), [text = braced(value)](const auto& line) {
      return line.find(text) != std::string::npos;
    });
  }
  /// All moves of the plan do, also those that write it only where it changes.
  bool moves_write(PostValue value) const {
    return std::all_of(use_.moves.begin(), use_.moves.end(),
                       [&](PostEvent event) { return writes(event, value); });
  }
  bool is_written_always(PostValue value) const {
    return writes(PostEvent::operation, value) || writes(PostEvent::shape_begin, value) ||
           moves_write(value);
  }
  /// The lines are there, but empty: the machine needs none.
  bool is_needless(PostEvent event) const {
    const std::vector<std::string>& lines = post_.of(event);
    return !lines.empty() && std::all_of(lines.begin(), lines.end(),
                                         [](const std::string& line) { return line.empty(); });
  }
  /// A word S with a number other than 0.
  bool fixes_power(PostEvent event) const {
    const std::vector<std::string>& lines = post_.of(event);
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      for (std::size_t at = line.find_first_of("Ss"); at < line.size();
           at = line.find_first_of("Ss", at + 1)) {
        const std::size_t digit = line.find_first_not_of("0. ", at + 1);
        if (digit < line.size() && line[digit] >= '1' && line[digit] <= '9') return true;
      }
      return false;
    });
  }

  [[noreturn]] void refuse(const std::string& line, const std::string& what,
                           const std::string& otherwise) const {
    throw Error(Exit::bad_input, where_, fmt::format("[lines] has no {}, for {}", line, what),
                "write it, or " + otherwise);
  }
  void require_event(PostEvent event, const std::string& what) const {
    if (post_.of(event).empty()) refuse("'" + name_of(event) + "'", what, "leave that out");
  }
  void require_value(PostEvent event, PostValue value, const std::string& what) const {
    if (!writes(event, value) && !is_needless(event))
      refuse(fmt::format("'{}' with {}", name_of(event), braced(value)), what, "leave that out");
  }

  void require_cut(const PlannedCut& cut, const Operation& operation) const {
    if (operation.has_air) {
      require_event(PostEvent::air_on, "air");
      require_event(PostEvent::air_off, "air");
    }
    if (operation.pierce_s > 0)
      require_value(PostEvent::pierce, PostValue::seconds, "a pierce time");
    if (cut.controller) {
      constexpr const char* what = "compensation by the controller";
      require_event(cut.controller->is_left ? PostEvent::left : PostEvent::right, what);
      require_event(PostEvent::uncompensated, what);
    }
    if (post_.machine == MachineType::laser && !operation.z_mm.empty() &&
        !moves_write(PostValue::z))
      require_value(PostEvent::height, PostValue::z, "passes with depths");
  }

  void require_tool() const {
    const PostValue height =
        post_.machine == MachineType::lathe ? PostValue::diameter : PostValue::z;
    const std::string what =
        fmt::format("a {}", machine_type_names[static_cast<std::size_t>(post_.machine)]);
    const auto require_line = [&](PostEvent event) {
      if (!writes(event, height))
        refuse(fmt::format("'{}' with {}", name_of(event), braced(height)), what,
               "give another post-processor");
    };
    require_line(PostEvent::height);
    require_line(PostEvent::sink);
    if (post_.machine != MachineType::mill) return;
    // The ramp runs back along the contour, too.
    const bool has_arcs =
        use_.moves.contains(PostEvent::arc_cw) || use_.moves.contains(PostEvent::arc_ccw);
    require_line(PostEvent::line);
    if (!has_arcs) return;
    require_line(PostEvent::arc_cw);
    require_line(PostEvent::arc_ccw);
  }

  /// The light is off where the plan is dark, and in a dry run everywhere.
  void require_light() const {
    const bool is_dry = use_.powers.contains(0);
    const bool is_begun =
        writes(PostEvent::shape_begin, PostValue::power) ||
        (writes(PostEvent::operation, PostValue::power) && !fixes_power(PostEvent::shape_begin));
    if (is_dry && !is_begun && !moves_write(PostValue::power))
      refuse("{power} in 'line', 'arc_cw' and 'arc_ccw', nor in 'operation' or 'shape_begin'",
             "a program without light", "give another post-processor: the light would be on");
    const bool is_changed =
        writes(PostEvent::power, PostValue::power) && !fixes_power(PostEvent::shape_begin);
    if (!is_dry && use_.changes_power && !is_changed && !moves_write(PostValue::power))
      refuse("'power' with {power}, nor {power} in 'line', 'arc_cw' and 'arc_ccw'",
             use_.has_dark_begin ? "dark moves of an engraving" : "tabs",
             "leave that out: the light would stay on");
  }

  void require_power() {
    if (is_written_always(PostValue::power)) return;
    if (use_.powers.size() > 1)
      refuse("'operation' with {power}", "operations with different powers",
             "cut them by a program each");
    if (!use_.powers.contains(0))
      warnings_.push_back(fmt::format("{}: no line writes the power, {{power}}", where_));
  }

  const Post& post_;
  const std::string& where_;
  const CutPlan& plan_;
  const std::vector<Operation>& operations_;
  PlanUse use_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> require_lines(const Post& post, const std::string& where,
                                       const CutPlan& plan,
                                       const std::vector<Operation>& operations) {
  return Needs(post, where, plan, operations).require();
}

}  // namespace lamplock::cutting
