#include "host/model/svg_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "host/model/curve_collector.hpp"
#include "host/model/spline.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using std::numbers::pi;

Point sum(const Point& p, const Point& q) { return {p.x + q.x, p.y + q.y, 0}; }

/// Point reflection of `at` in `middle`.
Point mirrored(const Point& at, const Point& middle) {
  return {2 * middle.x - at.x, 2 * middle.y - at.y, 0};
}

struct ArcShape {
  double x_radius, y_radius, turn_deg;
  bool large, sweep;
};

/// Converts end points to the centre (appendix F.6.5); scales up radii that are too small (F.6.6).
Arc arc_between(const Point& from, const Point& to, const ArcShape& shape) {
  const geometry::Affine turn = geometry::turned_about_z(shape.turn_deg);
  double rx = std::abs(shape.x_radius), ry = std::abs(shape.y_radius);
  const Point half =
      geometry::turned_back(turn).turn({(from.x - to.x) / 2, (from.y - to.y) / 2, 0});  // x1', y1'
  const double excess = std::hypot(half.x / rx, half.y / ry);
  if (excess > 1) {
    rx *= excess;
    ry *= excess;
  }
  const double x = half.x / rx, y = half.y / ry, square = x * x + y * y;
  const double root = std::sqrt(std::max(0.0, 1 / square - 1));
  const double side = shape.large != shape.sweep ? root : -root;
  const Point middle{side * y, -side * x, 0};  // centre of the unit circle: cx'/rx, cy'/ry
  const double start = std::atan2(y - middle.y, x - middle.x);
  double sweep = std::atan2(-y - middle.y, -x - middle.x) - start;
  if (shape.sweep && sweep < 0) sweep += 2 * pi;
  if (!shape.sweep && sweep > 0) sweep -= 2 * pi;
  const Point centre = turn.turn({middle.x * rx, middle.y * ry, 0});
  return {{centre.x + (from.x + to.x) / 2, centre.y + (from.y + to.y) / 2, 0},
          turn.turn({rx, 0, 0}),
          turn.turn({0, ry, 0}),
          start,
          start + sweep};
}

/// A pen that executes the commands.
class Pen {
 public:
  Pen(std::string_view data, const FilePosition& place) : scanner_(data, place) {}

  std::vector<Path> draw() {
    while (!scanner_.at_end()) {
      const char command = scanner_.take();
      const bool relative = command >= 'a' && command <= 'z';
      const char kind = relative ? static_cast<char>(command - 'a' + 'A') : command;
      if (kind == 'Z') {
        close();
        continue;
      }
      if (std::string_view("MLHVCSQTA").find(kind) == std::string_view::npos)
        scanner_.place().refuse(
            fmt::format("the path data have the unknown command '{}'", shown(command)),
            "export the drawing again");
      if (kind != 'M' && !begun_)
        scanner_.place().refuse("the path data do not begin with M", "export the drawing again");
      follow(kind, relative);
    }
    finish();
    return std::move(paths_);
  }

 private:
  /// A character in a form that may be printed in a line of text.
  static std::string shown(char c) {
    return c > ' ' && c <= '~' ? std::string(1, c)
                               : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }

  /// Executes one command for each set of its arguments.
  void follow(char kind, bool relative) {
    do {
      origin_ = relative ? at_ : Point{};
      step(kind);
      if (kind == 'M') kind = 'L';  // further pairs are lines
      if (path_.pieces.size() > max_pieces)
        scanner_.place().refuse("a path has too many pieces", "simplify the drawing");
    } while (scanner_.begins_number());
  }

  void step(char kind) {
    Point control = at_;  // reflected by the next S or T
    if (kind == 'M') {
      move_to(next_point());
      control = at_;
    } else if (kind == 'L') {
      line_to(next_point());
    } else if (kind == 'H') {
      line_to({origin_.x + scanner_.number(), at_.y, 0});
    } else if (kind == 'V') {
      line_to({at_.x, origin_.y + scanner_.number(), 0});
    } else if (kind == 'A') {
      arc();
    } else {
      control = bezier_to(kind);
    }
    const bool keeps = kind == 'C' || kind == 'S' || kind == 'Q' || kind == 'T';
    control_ = keeps ? control : at_;
    last_ = kind;
  }

  Point next_point() {
    const double x = scanner_.number(), y = scanner_.number();
    return sum(origin_, {x, y, 0});
  }

  void move_to(const Point& to) {
    finish();
    begun_ = true;
    at_ = begin_ = to;
  }

  void line_to(const Point& to) {
    append_line(path_, at_, to);
    at_ = to;
  }

  void arc() {
    ArcShape shape{};
    shape.x_radius = scanner_.number();
    shape.y_radius = scanner_.number();
    shape.turn_deg = scanner_.number();
    shape.large = scanner_.flag();
    shape.sweep = scanner_.flag();
    const Point to = next_point();
    if (shape.x_radius == 0 || shape.y_radius == 0) return line_to(to);
    if (to != at_) path_.pieces.emplace_back(arc_between(at_, to, shape));
    at_ = to;
  }

  /// Draws and returns the last control point.
  Point bezier_to(char kind) {
    const bool cubic = kind == 'C' || kind == 'S';
    const bool after_like = cubic ? last_ == 'C' || last_ == 'S' : last_ == 'Q' || last_ == 'T';
    std::vector<Point> poles{at_};
    if (kind == 'S' || kind == 'T') {
      poles.push_back(after_like ? mirrored(control_, at_) : at_);
    } else {
      poles.push_back(next_point());
    }
    if (cubic) poles.push_back(next_point());
    const Point control = poles.back();
    poles.push_back(next_point());
    at_ = poles.back();
    const bool goes = std::any_of(poles.begin(), poles.end(),
                                  [&](const Point& pole) { return pole != poles.front(); });
    if (goes) path_.pieces.emplace_back(bezier(std::move(poles)));
    return control;
  }

  void close() {
    if (!begun_)
      scanner_.place().refuse("the path data do not begin with M", "export the drawing again");
    append_line(path_, at_, begin_);
    path_.closed = true;
    finish();
    at_ = control_ = begin_;
    last_ = 'Z';
  }

  void finish() {
    if (!path_.pieces.empty()) paths_.push_back(std::move(path_));
    path_ = {};
  }

  SvgScanner scanner_;
  std::vector<Path> paths_;
  Path path_;
  Point at_, begin_, control_, origin_;
  bool begun_ = false;
  char last_ = 0;
};

}  // namespace

std::vector<Path> svg_path(std::string_view data, const FilePosition& place) {
  return Pen(data, place).draw();
}

}  // namespace lamplock::model
