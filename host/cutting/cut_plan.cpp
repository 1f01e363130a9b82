#include "host/cutting/cut_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "host/cutting/cut_order.hpp"
#include "host/cutting/drawn_contours.hpp"
#include "host/cutting/engraving.hpp"
#include "host/cutting/offset.hpp"
#include "host/error.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

// Longest edges on which another start point is tried if a lead or a tab does not fit.
constexpr std::size_t max_tried_edges = 24;

constexpr double s_per_min = 60;

std::string place_text(const Vec& at) { return fmt::format("({:.3f}, {:.3f})", at.x, at.y); }

/// "the contour at (x, y)", for errors.
std::string contour_text(const Contour& contour) {
  const Vec middle = (box_of(contour).low + box_of(contour).high) * 0.5;
  return fmt::format("contour of {:.3f} mm at {}", length_of(contour), place_text(middle));
}

bool is_part(const ContourPlace& place) { return place.kind != ContourKind::hole; }

/// mm to the right of the direction.
double distance_of(const Shape& shape, const Contour& contour, const Operation& operation) {
  const double half = operation.kerf_mm / 2;
  const bool is_ccw = is_counter_clockwise(contour);
  switch (operation.compensation) {
    case Compensation::none:
      return 0;
    case Compensation::left:
      return -half;
    case Compensation::right:
      return half;
    case Compensation::automatic:
    case Compensation::controller:
      if (!contour.closed) return 0;
      return is_part(shape.place) == is_ccw ? half : -half;
    case Compensation::inside:
    case Compensation::outside:
      break;
  }
  const bool is_outside = operation.compensation == Compensation::outside;
  if (!contour.closed)
    throw Error(Exit::bad_input, operation.name,
                fmt::format("the open {} has no {}", contour_text(contour),
                            is_outside ? "outside" : "inside"),
                "close it in the drawing, or use compensation left, right, auto or none");
  return is_outside == is_ccw ? half : -half;
}

/// The side that is thrown away: that of the beam, without compensation by the tree.
WasteSide waste_of(const Shape& shape, const Contour& contour, double distance_mm) {
  const bool is_right =
      distance_mm != 0 ? distance_mm > 0 : is_part(shape.place) == is_counter_clockwise(contour);
  return is_right ? WasteSide::right : WasteSide::left;
}

/// True if the operation fixes the direction of the cut: by its direction, or by a beam to the left
/// or right of it.
bool has_direction(const Operation& operation) {
  return operation.direction == Direction::drawn || operation.direction == Direction::reversed ||
         operation.compensation == Compensation::left ||
         operation.compensation == Compensation::right;
}

/// The beam along one shape.
struct ShapeBeam {
  OffsetContours offset;
  WasteSide waste = WasteSide::right;
  std::optional<Contour> drawn;  ///< where the controller compensates
  bool is_moved = false;         ///< runs beside the drawn contour
};

/// Contours as the beam runs along them.
struct Beams {
  std::vector<Contour> contours;
  std::vector<std::size_t> shapes;  ///< of each
  std::vector<WasteSide> waste;
  std::vector<std::optional<Contour>> drawn;  ///< where the controller compensates
  std::vector<bool> is_moved;                 ///< runs beside the drawn contour
  std::vector<bool> is_directed;              ///< has the direction of its operation

  bool are_moved() const {
    return std::find(is_moved.begin(), is_moved.end(), true) != is_moved.end();
  }
};

class Planner {
 public:
  Planner(const std::vector<Shape>& shapes, const std::vector<Operation>& operations,
          const Vec& position, const OrderOptions& order)
      : shapes_(shapes), operations_(operations), position_(position), order_(order) {}

  CutPlan plan() {
    for (std::size_t i = 0; i < operations_.size(); ++i)
      if (operations_[i].kind == OperationKind::engrave) engrave(i);
    for (const OperationKind kind : {OperationKind::score, OperationKind::cut}) follow(kind);
    return std::move(plan_);
  }

 private:
  void append(PlannedCut cut) {
    for (const Stroke& stroke : cut.strokes) {
      plan_.rapid_mm += distance(position_, stroke.front().edge.from);
      position_ = stroke.back().edge.to;
    }
    plan_.cuts.push_back(std::move(cut));
    plan_.cuts.back().number = plan_.cuts.size();
  }

  /// The areas of one operation.
  void engrave(std::size_t number) {
    const Operation& operation = operations_[number];
    PlannedCut cut{number, shapes_.size(), {}};
    std::vector<Contour> contours;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      if (shapes_[i].operation != number) continue;
      if (!shapes_[i].contour.closed)
        throw Error(Exit::bad_input, operation.name,
                    fmt::format("the open {} has no area", contour_text(shapes_[i].contour)),
                    "close it in the drawing, or score it");
      cut.shape = std::min(cut.shape, i);
      contours.push_back(shapes_[i].contour);
      numbers.push_back(i);
    }
    Engraving engraving = engrave_areas(contours, operation, position_);
    cut.strokes = std::move(engraving.strokes);
    if (contours.empty()) return;
    if (cut.strokes.empty())
      throw Error(Exit::bad_input, operation.name,
                  fmt::format("no line of a hatch of {:g} mm crosses the {}", operation.hatch_mm,
                              contour_text(contours.front())),
                  "give a smaller hatch");
    for (const std::size_t i : engraving.missed) {
      const Box box = box_of(contours[i]);
      plan_.faults.push_back(
          {FaultKind::unhatched, (box.low + box.high) * 0.5, box.high.y - box.low.y, numbers[i]});
    }
    append(std::move(cut));
  }

  /// All operations of one kind that follow contours, in one order.
  void follow(OperationKind kind) {
    Beams beams = beams_of(kind);
    if (beams.contours.empty()) return;
    const DrawnContours drawn = drawn_contours(kind);
    if (beams.are_moved()) {
      report_crossings(beams);
      report_near(beams, drawn);
    }
    const CutOrder order = cut_order(beams.contours, contour_tree(beams.contours), position_,
                                     order_, beams.is_directed);
    const CutSheet sheet(beams.contours);
    std::vector<PlannedCut> cuts(order.steps.size());
    geometry::for_each_index(cuts.size(), 0, [&](std::size_t i) {
      cuts[i] = planned_cut(beams, order.steps[i], sheet, drawn);
    });
    for (PlannedCut& cut : cuts) append(std::move(cut));
  }

  PlannedCut planned_cut(const Beams& beams, CutStep step, const CutSheet& sheet,
                         const DrawnContours& drawn_contours) const {
    const std::size_t shape = beams.shapes[step.contour];
    PlannedCut cut{*shapes_[shape].operation, shape, {}};
    if (const auto& drawn = beams.drawn[step.contour]) {
      step.edge = 0;
      step.part = 0;
      cut.controller = ControllerPath{{}, beams.waste[step.contour] == WasteSide::left};
      for (const Edge& edge : drawn->edges) cut.controller->drawn.push_back({edge});
    }
    Neighbours neighbours;
    if (beams.is_moved[step.contour]) neighbours = {&drawn_contours, shape};
    cut.strokes.push_back(path_of(beams, step, operations_[cut.operation], sheet, neighbours));
    return cut;
  }

  DrawnContours drawn_contours(OperationKind kind) const {
    DrawnContours drawn;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const auto operation = shapes_[i].operation;
      if (operation && operations_[*operation].kind == kind && shapes_[i].contour.closed)
        drawn.add(shapes_[i].contour, i);
    }
    drawn.index();
    return drawn;
  }

  /// The beams along all shapes of operations of one kind.
  Beams beams_of(OperationKind kind) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const auto operation = shapes_[i].operation;
      if (operation && operations_[*operation].kind == kind) numbers.push_back(i);
    }
    std::vector<ShapeBeam> beams(numbers.size());
    geometry::for_each_index(beams.size(), 0,
                             [&](std::size_t i) { beams[i] = compensated(shapes_[numbers[i]]); });
    Beams all;
    for (std::size_t i = 0; i < beams.size(); ++i) append_beam(beams[i], numbers[i], all);
    return all;
  }

  ShapeBeam compensated(const Shape& shape) const {
    const Operation& operation = operations_[*shape.operation];
    const Contour contour = directed(shape, operation.direction);
    const double distance_mm = distance_of(shape, contour, operation);
    ShapeBeam beam{offset({contour}, {distance_mm}),
                   waste_of(shape, contour, distance_mm),
                   {},
                   distance_mm != 0};
    const std::vector<Fault>& faults = beam.offset.faults;
    const auto vanished = std::any_of(faults.begin(), faults.end(),
                                      [](const auto& f) { return f.kind == FaultKind::vanished; });
    if (vanished || beam.offset.contours.empty())
      throw Error(Exit::bad_input, operation.name,
                  fmt::format("the {} is smaller than the beam of {:g} mm", contour_text(contour),
                              operation.kerf_mm),
                  "use a smaller kerf, or no compensation for it");
    if (operation.compensation == Compensation::controller && beam.is_moved)
      beam.drawn = begin_alike(contour, distance_mm, operation, beam.offset);
    return beam;
  }

  void append_beam(ShapeBeam& beam, std::size_t shape, Beams& beams) {
    for (Fault& fault : beam.offset.faults) {
      if (fault.kind != FaultKind::narrow) continue;  // the others are those of the drawing
      fault.contour = shape;
      plan_.faults.push_back(fault);
    }
    for (Contour& contour : beam.offset.contours) {
      beams.contours.push_back(std::move(contour));
      beams.shapes.push_back(shape);
      beams.waste.push_back(beam.waste);
      beams.drawn.push_back(beam.drawn);
      beams.is_moved.push_back(beam.is_moved);
      beams.is_directed.push_back(has_direction(operations_[*shapes_[shape].operation]));
    }
  }

  /// The drawn contour from the middle of an edge, and the beam from beside it: at a corner the
  /// controller would neither close the contour nor keep its distance.
  static Contour begin_alike(const Contour& contour, double distance_mm, const Operation& operation,
                             OffsetContours& result) {
    const bool is_narrow =
        std::any_of(result.faults.begin(), result.faults.end(),
                    [](const Fault& fault) { return fault.kind == FaultKind::narrow; });
    constexpr double near_mm = 1e-6;
    if (!is_narrow && result.contours.size() == 1) {
      Contour& beam = result.contours.front();
      for (std::size_t i = 0; i < contour.edges.size(); ++i) {
        const Edge& edge = contour.edges[i];
        const Vec at = point_at(edge, 0.5) + right_of(direction_at(edge, 0.5)) * distance_mm;
        for (std::size_t k = 0; k < beam.edges.size(); ++k) {
          if (distance_to(beam.edges[k], at) > near_mm) continue;
          beam = as_cut(beam, {0, false, k, std::clamp(part_at(beam.edges[k], at), 0.0, 1.0)});
          return as_cut(contour, {0, false, i, 0.5});
        }
      }
    }
    throw Error(Exit::bad_input, operation.name,
                fmt::format("the beam of {:g} mm does not fit everywhere beside the {}, where the "
                            "controller would stop",
                            operation.kerf_mm, contour_text(contour)),
                "use compensation auto");
  }

  /// Paths of the beam that cross although the drawing does not: parts that are too near.
  void report_crossings(const Beams& beams) {
    for (Fault& fault : contour_faults(beams.contours)) {
      if (fault.kind == FaultKind::crossing) fault.kind = FaultKind::beams;
      if (fault.contour) fault.contour = beams.shapes[*fault.contour];
      if (fault.other) fault.other = beams.shapes[*fault.other];
      plan_.faults.push_back(fault);
    }
  }

  /// Beams that cut into another contour without crossing its beam: where a gap is narrower than
  /// the beam, those of a hole and of the island in it change their places.
  void report_near(const Beams& beams, const DrawnContours& drawn) {
    std::set<std::pair<std::size_t, std::size_t>> known;
    for (const Fault& fault : plan_.faults)
      if (fault.contour && fault.other) known.insert(std::minmax(*fault.contour, *fault.other));
    std::vector<std::vector<DrawnContours::Cut>> found(beams.contours.size());
    geometry::for_each_index(found.size(), 0, [&](std::size_t i) {
      if (!beams.is_moved[i]) return;
      const std::size_t shape = beams.shapes[i];
      found[i] = drawn.cut_by(beams.contours[i], shape,
                              operations_[*shapes_[shape].operation].kerf_mm / 2);
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const DrawnContours::Cut& cut : found[i]) {
        const std::size_t shape = beams.shapes[i];
        if (!known.insert(std::minmax(shape, cut.contour)).second) continue;
        double gap_mm = std::numeric_limits<double>::infinity();
        for (const Edge& edge : shapes_[shape].contour.edges)
          gap_mm = std::min(gap_mm, distance_to(edge, cut.at));
        plan_.faults.push_back({FaultKind::near, cut.at, gap_mm, shape, cut.contour});
      }
    }
  }

  static Stroke path_of(const Beams& beams, const CutStep& step, const Operation& operation,
                        const CutSheet& sheet, const Neighbours& neighbours) {
    const Contour& contour = beams.contours[step.contour];
    CutPathOptions options;
    options.waste = beams.waste[step.contour];
    options.clearance_mm = operation.kerf_mm / 2;
    options.neighbours = neighbours;
    options.dark_begin_mm = operation.on_late_s * operation.feed_mm_min / s_per_min;
    options.dark_end_mm = operation.off_early_s * operation.feed_mm_min / s_per_min;
    if (contour.closed) {
      options.lead_in = operation.lead_in;
      options.lead_out = operation.lead_out;
      options.overcut_mm = operation.overcut_mm;
      options.tabs = operation.tabs;
      options.tabs.kerf_mm = operation.kerf_mm;
    }
    try {
      return cut_path(as_cut(contour, step), options, sheet);
    } catch (const Error&) {
      if (auto stroke = path_elsewhere(contour, step, options, sheet)) return std::move(*stroke);
      throw;
    }
  }

  /// The path from another start point, in the middle of long edges first.
  static std::optional<Stroke> path_elsewhere(const Contour& contour, CutStep step,
                                              const CutPathOptions& options,
                                              const CutSheet& sheet) {
    if (!contour.closed) return std::nullopt;
    std::vector<std::size_t> edges(contour.edges.size());
    std::iota(edges.begin(), edges.end(), std::size_t{0});
    std::stable_sort(edges.begin(), edges.end(), [&](std::size_t a, std::size_t b) {
      return length_of(contour.edges[a]) > length_of(contour.edges[b]);
    });
    edges.resize(std::min(edges.size(), max_tried_edges));
    for (const double part : {0.5, 0.25, 0.75, 0.0}) {
      for (const std::size_t edge : edges) {
        step.edge = edge;
        step.part = part;
        try {
          return cut_path(as_cut(contour, step), options, sheet);
        } catch (const Error&) {
          continue;
        }
      }
    }
    return std::nullopt;
  }

  const std::vector<Shape>& shapes_;
  const std::vector<Operation>& operations_;
  Vec position_;
  OrderOptions order_;
  CutPlan plan_;
};

}  // namespace

void place_shapes(std::vector<Shape>& shapes, const std::vector<Operation>& operations) {
  // Numbers of trees: one for each kind, and one for each engraving.
  constexpr std::size_t kinds = 4;
  const auto tree_of_shape = [&](const Shape& shape) -> std::size_t {
    if (!shape.operation) return kinds;
    const OperationKind kind = operations[*shape.operation].kind;
    return kind == OperationKind::engrave ? kinds + 1 + *shape.operation
                                          : static_cast<std::size_t>(kind);
  };
  std::vector<std::vector<std::size_t>> trees(kinds + 1 + operations.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) trees[tree_of_shape(shapes[i])].push_back(i);
  for (const std::vector<std::size_t>& numbers : trees) {
    std::vector<Contour> contours;
    contours.reserve(numbers.size());
    for (const std::size_t i : numbers) contours.push_back(shapes[i].contour);
    const std::vector<ContourPlace> places = contour_tree(contours);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      shapes[numbers[i]].place = places[i];
      if (auto& parent = shapes[numbers[i]].place.parent) parent = numbers[*parent];
    }
  }
}

Contour directed(const Shape& shape, Direction direction) {
  const Contour& contour = shape.contour;
  const bool is_ccw = is_counter_clockwise(contour);
  bool turn = direction == Direction::reversed;
  if (contour.closed) {
    if (direction == Direction::automatic) turn = is_part(shape.place) != is_ccw;
    if (direction == Direction::clockwise) turn = is_ccw;
    if (direction == Direction::counter_clockwise) turn = !is_ccw;
  }
  return turn ? reversed(contour) : contour;
}

CutPlan plan_cuts(const std::vector<Shape>& shapes, const std::vector<Operation>& operations,
                  const Vec& position, const OrderOptions& order) {
  return Planner(shapes, operations, position, order).plan();
}

}  // namespace lamplock::cutting
