#include "host/cutting/post.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/cutting/post_template.hpp"

namespace lamplock::cutting {
namespace {

constexpr int speed_decimals = 3, time_decimals = 3;

/// Comments of G-code end at a bracket, and lines have one line.
std::string comment_text(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    plain += c == '(' ? '[' : c == ')' ? ']' : byte < 0x20 || byte >= 0x7f || c == ';' ? '_' : c;
  }
  constexpr std::size_t max_comment = 120;
  plain.resize(std::min(plain.size(), max_comment));
  return plain;
}

class ProgramWriter {
 public:
  ProgramWriter(const CutPlan& plan, const std::vector<Operation>& operations, const Post& post,
                const ProgramFrame& frame)
      : plan_(plan), operations_(operations), post_(post), frame_(frame), templates_(post) {
    if (post.machine == MachineType::lathe) safe_radius_ = safe_radius();
  }

  std::string text() {
    numbers_.moves.reserve(move_count());
    comment(frame_.title);
    write(PostEvent::begin);
    for (std::size_t i = 0; i < plan_.cuts.size(); ++i) {
      numbers_.first.push_back(lines_ + 1);
      write_cut(i);
    }
    numbers_.end = lines_ + 1;
    if (post_.machine != MachineType::laser) leave();
    // The next program begins in focus on the surface.
    if (post_.machine == MachineType::laser && !templates_.value(PostValue::z).empty())
      go_to_height(frame_.tooling.surface_mm);
    if (has_air_) write(PostEvent::air_off);
    write(PostEvent::end);
    return std::move(text_);
  }
  /// Of its lines, after text().
  ProgramLines numbers() { return std::move(numbers_); }

 private:
  /// Of one pass, with the ways to its strokes: a vector that grows would need twice the memory of
  /// a large plan.
  std::size_t move_count() const {
    std::size_t count = 0;
    for (const PlannedCut& cut : plan_.cuts)
      for (const Stroke& stroke : cut.strokes) count += stroke.size() + 2;
    return count;
  }
  void write(PostEvent event) { lines_ += templates_.append(event, text_); }
  /// Writes a move to or along this edge of the plan.
  void write_move(PostEvent event, WrittenMove::Kind kind, const Edge& edge) {
    WrittenMove move;
    move.kind = kind;
    move.is_arc = event == PostEvent::arc_cw || event == PostEvent::arc_ccw;
    move.first_line = lines_ + 1;
    write(event);
    move.end_line = lines_ + 1;
    move.edge = edge;
    move.z_mm = z_mm_;
    move.feed_mm_min = operation_ ? operations_[*operation_].feed_mm_min : 0;
    move.s = s_;
    numbers_.moves.push_back(move);
  }
  /// Writes a move to a place.
  void write_move(PostEvent event, WrittenMove::Kind kind, const Vec& to) {
    write_move(event, kind, Edge{to, to, {}, 0});
  }
  void comment(const std::string& text) {
    templates_.set(PostValue::text, comment_text(text));
    write(PostEvent::comment);
  }

  void write_cut(std::size_t number) {
    const PlannedCut& cut = plan_.cuts[number];
    const Operation& operation = operations_[cut.operation];
    if (operation_ != cut.operation) begin_operation(cut.operation);
    comment(fmt::format("{}: {}", cut.number, frame_.names[cut.shape]));
    if (post_.machine != MachineType::laser) return write_passes(cut, operation);
    const std::size_t passes =
        operation.z_mm.empty() ? static_cast<std::size_t>(operation.passes) : operation.z_mm.size();
    for (std::size_t pass = 0; pass < passes; ++pass) {
      if (cut.controller) {
        write_compensated(cut, operation, pass);
        continue;
      }
      for (std::size_t i = 0; i < cut.strokes.size(); ++i) {
        go_to(cut.strokes[i].front().edge.from);
        if (i == 0 && !operation.z_mm.empty()) go_to_height(operation.z_mm[pass]);
        write_stroke(cut.strokes[i], operation);
      }
    }
  }

  /// Along the drawn contour. The entry is dark, along the begin of the contour and twice as long
  /// as the radius of the beam, so that it ends square beside the begin.
  void write_compensated(const PlannedCut& cut, const Operation& operation, std::size_t pass) {
    const Stroke& drawn = cut.controller->drawn;
    const Edge& first = drawn.front().edge;
    go_to(first.from - direction_at(first, 0) * operation.kerf_mm);
    if (!operation.z_mm.empty()) go_to_height(operation.z_mm[pass]);
    templates_.set(PostValue::kerf, post_number(operation.kerf_mm, post_.decimals));
    if (!frame_.is_uncompensated)
      write(cut.controller->is_left ? PostEvent::left : PostEvent::right);
    go_to(first.from);
    write_stroke(drawn, operation);
    if (!frame_.is_uncompensated) write(PostEvent::uncompensated);
  }

  /// The passes of a tool. It leaves the sheet between strokes.
  void write_passes(const PlannedCut& cut, const Operation& operation) {
    PassHeights heights{frame_.tooling.surface_mm, 0, 0};
    if (!operation.z_mm.empty()) heights.final_mm = operation.z_mm.back();
    const std::vector<double> passes =
        operation.z_mm.empty() ? std::vector<double>{0} : operation.z_mm;
    for (const double z : passes) {
      heights.to_mm = z;
      for (const Stroke& stroke : cut.strokes) write_moves(tool_path(stroke, heights));
      heights.from_mm = z;
    }
  }

  std::vector<ToolMove> tool_path(const Stroke& stroke, const PassHeights& heights) {
    switch (post_.machine) {
      case MachineType::knife:
        return knife_path(stroke, heights, frame_.tooling, heading_);
      case MachineType::lathe:
        return lathe_path(stroke, heights, frame_.tooling);
      case MachineType::mill:
      case MachineType::laser:
        break;
    }
    return mill_path(stroke, heights, frame_.tooling);
  }

  void write_moves(const std::vector<ToolMove>& moves) {
    leave();
    const bool is_lathe = post_.machine == MachineType::lathe;
    const Vec first = moves.front().edge.from;
    const double power = operations_[*operation_].power;
    if (is_lathe) {
      const Vec outside{first.x, safe_radius_};
      set_place(outside);
      write_move(PostEvent::rapid, WrittenMove::Kind::rapid, outside);
      set_place(first);
      write_move(PostEvent::sink, WrittenMove::Kind::sink, first);
    } else {
      go_to(first);
    }
    set_power(power);
    write(PostEvent::shape_begin);
    for (const ToolMove& move : moves) {
      if (!is_lathe && set_height(move.z_from_mm))
        write_move(PostEvent::sink, WrittenMove::Kind::sink, move.edge.from);
      set_height(move.z_to_mm);
      write_edge(move.edge);
    }
    write(PostEvent::shape_end);
  }

  /// To where rapids are free: above the sheet, or around the contours of a lathe.
  void leave() {
    if (post_.machine == MachineType::lathe) {
      const Vec outside{at_ ? at_->x : 0, safe_radius_};
      set_place(outside);
      at_.reset();
      write_move(PostEvent::height, WrittenMove::Kind::height, outside);
    } else if (set_height(frame_.tooling.surface_mm + frame_.tooling.clearance_mm)) {
      write_move(PostEvent::height, WrittenMove::Kind::height, at_.value_or(Vec{}));
    }
  }

  double safe_radius() const {
    double radius = 0, allowance = 0;
    for (const PlannedCut& cut : plan_.cuts) {
      const std::vector<double>& z_mm = operations_[cut.operation].z_mm;
      if (!z_mm.empty()) allowance = std::max(allowance, z_mm.front() - z_mm.back());
      for (const Stroke& stroke : cut.strokes)
        for (const CutMove& move : stroke) radius = std::max(radius, box_of(move.edge).high.y);
    }
    return radius + allowance + frame_.tooling.away_mm + frame_.tooling.clearance_mm;
  }

  void begin_operation(std::size_t number) {
    const Operation& operation = operations_[number];
    operation_ = number;
    templates_.set(PostValue::tool, fmt::format("{}", number + 1));
    templates_.set(PostValue::operation, comment_text(operation.name));
    templates_.set(PostValue::feed, post_number(operation.feed_mm_min, speed_decimals));
    set_power(operation.power);
    power_ = operation.power;
    write(PostEvent::operation);
    if (operation.has_air != has_air_)
      write(operation.has_air ? PostEvent::air_on : PostEvent::air_off);
    has_air_ = operation.has_air;
  }

  void set_power(double power) {
    s_ = power * frame_.max_s;
    templates_.set(PostValue::power, post_number(s_, speed_decimals));
  }

  /// The power of the next moves. Templates whose moves have no power get a line for it.
  void change_power(double power) {
    set_power(power);
    if (power != power_) write(PostEvent::power);
    power_ = power;
  }

  /// A stroke that begins dark has no light at its begin either.
  void write_stroke(const Stroke& stroke, const Operation& operation) {
    change_power(operation.power * stroke.front().power);
    write(PostEvent::shape_begin);
    if (operation.pierce_s > 0) {
      templates_.set(PostValue::seconds, post_number(operation.pierce_s, time_decimals));
      write(PostEvent::pierce);
    }
    for (const CutMove& move : stroke) {
      change_power(operation.power * move.power);
      write_edge(move.edge);
    }
    set_power(operation.power);
    write(PostEvent::shape_end);
  }

  double rounded(double value) const { return std::round(value * scale_) / scale_; }
  Vec rounded(const Vec& at) const { return {rounded(at.x), rounded(at.y)}; }

  void set_place(const Vec& at) {
    at_ = rounded(at);
    templates_.set(PostValue::x, post_number(at_->x, post_.decimals));
    templates_.set(PostValue::y, post_number(at_->y, post_.decimals));
    if (templates_.uses(PostValue::diameter))
      templates_.set(PostValue::diameter,
                     post_number(at_->y * (frame_.has_radii ? 1 : 2), post_.decimals));
  }

  void go_to(const Vec& at) {
    if (at_ == rounded(at)) return;
    set_place(at);
    set_power(0);
    write_move(PostEvent::rapid, WrittenMove::Kind::rapid, at);
  }

  void go_to_height(double z_mm) {
    if (!set_height(z_mm)) return;
    set_power(0);
    write_move(PostEvent::height, WrittenMove::Kind::height, at_.value_or(Vec{}));
  }
  /// True if it is another one.
  bool set_height(double z_mm) {
    std::string z = post_number(z_mm, post_.decimals);
    if (z == templates_.value(PostValue::z)) return false;
    templates_.set(PostValue::z, std::move(z));
    z_mm_ = z_mm;
    return true;
  }

  /// True if the arc with rounded ends and centre, which is now at `at_`, is still one. grbl
  /// refuses arcs whose radii at both ends differ by more than 0.005 mm and 0.1 % (gcode.c;
  /// LinuxCNC from 0.028 mm on), and one whose turn has another sign or size is another arc.
  bool is_round(const Vec& from, const Vec& to_centre, const Edge& edge) const {
    constexpr double max_apart_mm = 0.0045, max_apart = 0.0009, max_turn = 0.5;
    const Vec centre = from + to_centre, begin = to_centre * -1, end = *at_ - centre;
    const double radius = norm(begin), apart_mm = std::abs(norm(end) - radius);
    double sweep = std::atan2(cross(begin, end), dot(begin, end));
    if (sweep * edge.sweep < 0)
      sweep += edge.sweep > 0 ? 2 * std::numbers::pi : -2 * std::numbers::pi;
    return apart_mm <= std::max(max_apart_mm, radius * max_apart) &&
           std::abs(sweep - edge.sweep) <= max_turn;
  }

  /// An arc beyond half a circle becomes two, so that its end is never near its begin, where
  /// rounding would turn a small arc into a full circle and back.
  void write_edge(const Edge& edge) {
    if (!edge.is_line() && std::abs(edge.sweep) > std::numbers::pi * (1 + 1e-9)) {
      const Vec middle = point_at(edge, 0.5);
      write_edge(cut_out(edge, 0, 0.5, edge.from, middle));
      write_edge(cut_out(edge, 0.5, 1, middle, edge.to));
      return;
    }
    if (at_ == rounded(edge.to)) return;
    const Vec from = *at_;
    set_place(edge.to);
    // An arc that is as flat as the rounding is a line.
    const double flat = 0.5 / scale_;
    const bool is_flat = edge.is_line() || radius_of(edge) * (1 - std::cos(edge.sweep / 2)) < flat;
    if (is_flat) return write_move(PostEvent::line, WrittenMove::Kind::cut, edge);
    const Vec to_centre = rounded(edge.centre - from);
    if (!is_round(from, to_centre, edge)) {
      set_place(from);
      const Vec middle = point_at(edge, 0.5);
      write_edge(cut_out(edge, 0, 0.5, edge.from, middle));
      return write_edge(cut_out(edge, 0.5, 1, middle, edge.to));
    }
    templates_.set(PostValue::i, post_number(to_centre.x, post_.decimals));
    templates_.set(PostValue::j, post_number(to_centre.y, post_.decimals));
    write_move(edge.sweep > 0 ? PostEvent::arc_ccw : PostEvent::arc_cw, WrittenMove::Kind::cut,
               edge);
  }

  const CutPlan& plan_;
  const std::vector<Operation>& operations_;
  const Post& post_;
  const ProgramFrame& frame_;
  PostTemplates templates_;
  const double scale_ = std::pow(10, post_.decimals);  ///< of positions
  std::string text_;
  std::size_t lines_ = 0;
  ProgramLines numbers_;
  std::optional<Vec> at_;
  std::optional<std::size_t> operation_;
  std::optional<double> z_mm_;  ///< of the last moves
  double s_ = 0;                ///< S word of the next moves
  double power_ = 0;            ///< of the last line for it
  bool has_air_ = false;
  double safe_radius_ = 0;  ///< of a lathe, around all contours
  Vec heading_{1, 0};       ///< of the blade of a knife; along X at first
};

}  // namespace

std::string cut_program(const CutPlan& plan, const std::vector<Operation>& operations,
                        const Post& post, const ProgramFrame& frame, ProgramLines* lines) {
  ProgramWriter writer(plan, operations, post, frame);
  std::string text = writer.text();
  if (lines != nullptr) *lines = writer.numbers();
  return text;
}

}  // namespace lamplock::cutting
