#include "host/cutting/cut_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <numeric>
#include <utility>

#include "host/cutting/beams.hpp"
#include "host/cutting/cut_order.hpp"
#include "host/cutting/drawn_contours.hpp"
#include "host/cutting/engraving.hpp"
#include "host/error.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

// Longest edges on which another start point is tried if a lead or a tab does not fit.
constexpr std::size_t max_tried_edges = 24;

constexpr double s_per_min = 60;

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
    std::vector<Contour> contours, covers;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      if (shapes_[i].operation != number) {
        if (shapes_[i].contour.covers && shapes_[i].contour.closed)
          covers.push_back(shapes_[i].contour);
        continue;
      }
      if (!shapes_[i].contour.closed)
        throw Error(Exit::bad_input, operation.name,
                    fmt::format("the open {} has no area", contour_text(shapes_[i].contour)),
                    "close it in the drawing, or score it");
      cut.shape = std::min(cut.shape, i);
      contours.push_back(shapes_[i].contour);
      numbers.push_back(i);
    }
    Engraving engraving = engrave_areas(contours, covers, operation, position_);
    cut.strokes = std::move(engraving.strokes);
    if (contours.empty()) return;
    if (cut.strokes.empty())
      throw Error(Exit::bad_input, operation.name,
                  fmt::format("no line of a hatch of {:g} mm crosses the {}", operation.hatch_mm,
                              contour_text(contours.front())),
                  "give a smaller hatch");
    const auto report = [&](FaultKind kind, std::size_t i) {
      const Box box = box_of(contours[i]);
      plan_.faults.push_back(
          {kind, (box.low + box.high) * 0.5, box.high.y - box.low.y, numbers[i]});
    };
    for (const std::size_t i : engraving.missed) report(FaultKind::unhatched, i);
    for (const std::size_t i : engraving.unfilled) report(FaultKind::unfilled, i);
    append(std::move(cut));
  }

  /// All operations of one kind that follow contours, in one order.
  void follow(OperationKind kind) {
    const Beams beams = beams_along(shapes_, operations_, kind, plan_.faults);
    if (beams.contours.empty()) return;
    const DrawnContours drawn = drawn_contours(kind);
    // Beside the search for an order, which needs about the same time and runs on one core.
    std::future<std::vector<Fault>> faults;
    if (beams.are_moved())
      faults = std::async(std::launch::async,
                          [&] { return beam_faults(beams, drawn, shapes_, operations_); });
    const CutOrder order =
        cut_order(beams.contours, places_of(beams, shapes_), position_, order_, beams.is_directed);
    const CutSheet sheet(beams.contours);
    std::vector<PlannedCut> cuts(order.steps.size());
    geometry::for_each_index(cuts.size(), 0, [&](std::size_t i) {
      cuts[i] = planned_cut(beams, order.steps[i], sheet, drawn);
    });
    for (PlannedCut& cut : cuts) append(std::move(cut));
    if (!faults.valid()) return;
    const std::vector<Fault> found = faults.get();
    plan_.faults.insert(plan_.faults.end(), found.begin(), found.end());
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
    } catch (const Error& error) {
      std::optional<LeadError> other;
      if (auto stroke = path_elsewhere(contour, step, options, sheet, other))
        return std::move(*stroke);
      // No lead fits here, but a smaller one at another point.
      const auto* const of_lead = dynamic_cast<const LeadError*>(&error);
      if (of_lead != nullptr && of_lead->fitting_mm() == 0 && other) throw LeadError(*other);
      throw;
    }
  }

  /// The path from another start point, in the middle of long edges first. `fitting` becomes the
  /// error of the first point where a lead of another size fits.
  static std::optional<Stroke> path_elsewhere(const Contour& contour, CutStep step,
                                              const CutPathOptions& options, const CutSheet& sheet,
                                              std::optional<LeadError>& fitting) {
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
        } catch (const LeadError& error) {
          if (!fitting && error.fitting_mm() > 0) fitting = error;
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
