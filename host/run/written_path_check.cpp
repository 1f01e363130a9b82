#include "host/run/written_path_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/error.hpp"
#include "host/gcode_comments.hpp"

namespace lamplock::run {
namespace {

using cutting::MachineType;
using cutting::PostEvent;
using cutting::PostValue;
using cutting::Vec;
using cutting::WrittenMove;
using program_run::Piece;
using program_run::Pieces;

constexpr std::size_t axis_x = 0, axis_y = 1, axis_z = 2;
/// Feeds and powers are written with three decimals.
constexpr double word_tolerance = 0.001;

const std::vector<PostEvent> move_events{PostEvent::line, PostEvent::arc_cw, PostEvent::arc_ccw};

std::vector<PostEvent> with_moves(std::vector<PostEvent> events) {
  events.insert(events.end(), move_events.begin(), move_events.end());
  return events;
}

class PathComparison {
 public:
  PathComparison(const program_run::ProgramRun& run, const WrittenProgram& program,
                 const std::string& where)
      : pieces_(run.pieces), program_(program), where_(where), machine_(program.post.machine) {
    const cutting::Post& post = program.post;
    place_mm_ = place_tolerance_mm(post);
    way_mm_ = way_tolerance_mm(post, program.arc_tolerance_mm);
    compares_feed_ = writes_value(
        post, with_moves({PostEvent::operation, PostEvent::shape_begin, PostEvent::sink}),
        PostValue::feed);
    compares_power_ =
        machine_ != MachineType::knife &&
        writes_value(post,
                     with_moves({PostEvent::operation, PostEvent::shape_begin, PostEvent::power}),
                     PostValue::power);
    has_heights_ = writes_value(post, with_moves({PostEvent::height}), PostValue::z);
  }

  void compare() {
    for (const WrittenMove& move : program_.moves) {
      for (; next_ < pieces_.size() && pieces_[next_].line < move.first_line; ++next_)
        take_other(pieces_[next_]);
      // Lines at the begin may move the focus; from here on the plan has its height.
      if (!height_mm_) height_mm_ = at_[axis_z];
      if (has_heights_ && move.z_mm) height_mm_ = *move.z_mm;
      const std::size_t first = next_;
      while (next_ < pieces_.size() && pieces_[next_].line < move.end_line) ++next_;
      if (move.kind == WrittenMove::Kind::cut)
        take_cut(move, first);
      else
        take_way(move, first);
    }
    for (; next_ < pieces_.size(); ++next_) take_other(pieces_[next_]);
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& what) const {
    throw Error(Exit::bad_input, where_,
                fmt::format("the path of its program is not that of the plan: line {}, '{}', {}",
                            line, line_of(program_.text, line), what),
                "correct its templates, with G21 G90 at the begin, or write checked = false for "
                "another controller");
  }
  std::size_t line_before(const WrittenMove& move) const {
    return std::max<std::size_t>(1, move.end_line - 1);
  }

  bool is_laser() const { return machine_ == MachineType::laser; }
  /// Of a lathe x is along Z, and y is X.
  Vec place_of(const PerAxis<double>& at) const {
    return machine_ == MachineType::lathe ? Vec{at[axis_z], at[axis_x]}
                                          : Vec{at[axis_x], at[axis_y]};
  }

  void require_dark(const Piece& piece) const {
    if (!is_laser() || piece.s == 0) return;
    const bool moves = distance(place_of(piece.from), place_of(piece.to)) > place_mm_;
    if (piece.rapid && (program_.has_dark_rapids || !moves)) return;
    refuse(piece.line, fmt::format("moves with S{:g} where the plan has no light", piece.s));
  }
  /// A tool does not cut between its contours.
  void require_clear(const Piece& piece) const {
    if (is_laser()) return;
    const bool is_cut =
        machine_ == MachineType::lathe
            ? !piece.rapid
            : std::min(piece.from[axis_z], piece.to[axis_z]) < program_.surface_mm - place_mm_;
    if (is_cut && distance(place_of(piece.from), place_of(piece.to)) > place_mm_)
      refuse(piece.line, "moves through the workpiece between contours");
  }

  void take_other(const Piece& piece) {
    require_dark(piece);
    require_clear(piece);
    at_ = piece.to;
  }

  void require_place(const WrittenMove& move, const Vec& planned, const char* verb) const {
    const Vec at = place_of(at_);
    if (distance(at, planned) <= place_mm_) return;
    refuse(line_before(move), fmt::format("{} at ({:.3f}, {:.3f}) mm, the plan at ({:.3f}, {:.3f})",
                                          verb, at.x, at.y, planned.x, planned.y));
  }
  void require_height(const WrittenMove& move) const {
    if (machine_ == MachineType::lathe || std::abs(at_[axis_z] - *height_mm_) <= place_mm_) return;
    refuse(line_before(move),
           fmt::format("ends at Z {:.3f} mm, the plan at {:.3f}", at_[axis_z], *height_mm_));
  }

  /// To the begin of a stroke, or to a height.
  void take_way(const WrittenMove& move, std::size_t first) {
    for (std::size_t i = first; i < next_; ++i) {
      if (move.kind != WrittenMove::Kind::sink) {
        take_other(pieces_[i]);
        continue;
      }
      at_ = pieces_[i].to;
      if (machine_ != MachineType::lathe) require_place(move, move.edge.to, "sinks");
    }
    const bool is_height = move.kind == WrittenMove::Kind::height;
    if (is_height && machine_ == MachineType::lathe)
      require_place(move, {place_of(at_).x, move.edge.to.y}, "ends");
    if (!is_height) require_place(move, move.edge.to, "ends");
    if (move.kind == WrittenMove::Kind::sink || (is_height && !is_laser())) require_height(move);
  }

  void require_words(const WrittenMove& move, const Piece& piece) const {
    if (compares_power_ && std::abs(piece.s - move.s) > word_tolerance)
      refuse(piece.line, fmt::format("has S{:g}, the plan S{:g}", piece.s, move.s));
    if (compares_feed_ && std::abs(piece.feed_mm_min - move.feed_mm_min) >
                              word_tolerance * (1 + move.feed_mm_min * word_tolerance))
      refuse(piece.line, fmt::format("has a feed of {:.3f} mm/min, the plan {:.3f}",
                                     piece.feed_mm_min, move.feed_mm_min));
  }

  /// Along an edge: each piece begins and ends on it and continues in its direction.
  void take_cut(const WrittenMove& move, std::size_t first) {
    require_place(move, move.edge.from, "begins");
    double passed = 0;  // mm, or radians of an arc
    for (std::size_t i = first; i < next_; ++i) {
      const Piece& piece = pieces_[i];
      at_ = piece.to;
      const bool is_dark_rapid =
          piece.rapid && is_laser() && move.s == 0 && program_.has_dark_rapids;
      // A tool in the air, or one that only the height moves.
      if (piece.rapid && !is_dark_rapid) {
        if (distance(place_of(piece.from), place_of(piece.to)) > place_mm_)
          refuse(piece.line, "is a rapid, the plan a move with a feed");
        continue;
      }
      if (is_laser() && move.s == 0) require_dark(piece);
      if (!is_dark_rapid) require_words(move, piece);
      passed = move.is_arc ? along_arc(move, piece, passed) : along_line(move, piece, passed);
    }
    require_place(move, move.edge.to, "ends");
    require_height(move);
    if (move.is_arc && std::abs(passed - move.edge.sweep) > max_turn)
      refuse(line_before(move), fmt::format("turns by {:.1f} degrees, the plan by {:.1f}",
                                            passed * degrees, move.edge.sweep * degrees));
  }

  [[noreturn]] void refuse_way(const Piece& piece) const {
    refuse(piece.line, fmt::format("runs by ({:.3f}, {:.3f}) mm, which is not on the plan's edge",
                                   piece.to[axis_x], piece.to[axis_y]));
  }

  double along_line(const WrittenMove& move, const Piece& piece, double passed) const {
    const Vec begin = move.edge.from, way = move.edge.to - begin, to = place_of(piece.to) - begin;
    const double length = norm(way);
    if (length <= place_mm_) return passed;  // its ends are compared
    const double along = dot(to, way) / length;
    if (std::abs(cross(way, to)) / length > way_mm_ || along < passed - place_mm_)
      refuse_way(piece);
    return along;
  }

  double along_arc(const WrittenMove& move, const Piece& piece, double passed) const {
    const Vec from = place_of(piece.from) - move.edge.centre,
              to = place_of(piece.to) - move.edge.centre;
    const double radius = radius_of(move.edge);
    const double turn = std::atan2(cross(from, to), dot(from, to));
    const auto is_on = [&](const Vec& at) { return std::abs(norm(at) - radius) <= way_mm_; };
    // The middle of a chord is the farthest from the arc.
    if (!is_on(to) || !is_on((from + to) * 0.5)) refuse_way(piece);
    if (turn * move.edge.sweep < 0 && std::abs(turn) * radius > way_mm_) refuse_way(piece);
    return passed + turn;
  }

  /// Radians; another turn of the same arc differs by a whole one.
  static constexpr double max_turn = 1, degrees = 57.29577951308232;

  const Pieces& pieces_;
  const WrittenProgram& program_;
  const std::string& where_;
  const MachineType machine_;
  double place_mm_ = 0, way_mm_ = 0;
  bool compares_feed_ = false, compares_power_ = false, has_heights_ = false;
  std::size_t next_ = 0;             ///< piece
  PerAxis<double> at_{};             ///< of the machine
  std::optional<double> height_mm_;  ///< Z of the plan
};

}  // namespace

double place_tolerance_mm(const cutting::Post& post) {
  // Both coordinates are rounded by half a unit of the last decimal; the interpreter's is 1e-7 mm.
  constexpr double own_mm = 1e-6;
  return std::pow(10, -post.decimals) + own_mm;
}

double way_tolerance_mm(const cutting::Post& post, double arc_tolerance_mm) {
  // The ends of an arc, its begin and the way from it to its centre are rounded.
  constexpr double roundings = 3;
  return roundings * place_tolerance_mm(post) + arc_tolerance_mm;
}

bool writes_value(const cutting::Post& post, const std::vector<PostEvent>& events,
                  PostValue value) {
  const std::string braced =
      fmt::format("{{{}}}", cutting::post_value_names[static_cast<std::size_t>(value)]);
  return std::ranges::any_of(events, [&](PostEvent event) {
    return std::ranges::any_of(post.of(event), [&](const std::string& line) {
      return without_comments(line).find(braced) != std::string::npos;
    });
  });
}

std::string_view line_of(std::string_view text, std::size_t number) {
  for (std::size_t i = 1; i < number; ++i) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

void require_written_path(const program_run::ProgramRun& run, const WrittenProgram& program,
                          const std::string& where) {
  PathComparison(run, program, where).compare();
}

}  // namespace lamplock::run
