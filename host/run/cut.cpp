#include "host/run/cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "host/cutting/dark_program.hpp"
#include "host/cutting/dry_post.hpp"
#include "host/cutting/post_file.hpp"
#include "host/cutting/post_needs.hpp"
#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/number_text.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/cut_drawing.hpp"
#include "host/run/cut_files.hpp"
#include "host/run/cut_machine_checks.hpp"
#include "host/run/cut_material.hpp"
#include "host/run/cut_places.hpp"
#include "host/run/cut_program_check.hpp"
#include "host/run/frame.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/prepare.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using cutting::CutPlan;
using cutting::MachineType;
using cutting::Operation;
using cutting::OperationKind;
using cutting::Shape;

const char* kind_text(cutting::ContourKind kind) {
  switch (kind) {
    case cutting::ContourKind::open:
      return "open";
    case cutting::ContourKind::outside:
      return "outside";
    case cutting::ContourKind::hole:
      return "hole";
    case cutting::ContourKind::island:
      return "island";
  }
  return "";
}

/// Operations without their values.
std::vector<Operation> bare_operations(const CutDescription& description) {
  std::vector<Operation> operations;
  for (std::size_t i = 0; i < description.operations.size(); ++i) {
    const OperationChoice& choice = description.operations[i];
    operations.push_back(bare_operation(choice, operation_name(choice, i)));
  }
  return operations;
}

CutShape shape_row(const Shape& shape, const std::string& layer,
                   const std::vector<Operation>& operations, const CutDescription& description) {
  CutShape row;
  row.layer = layer;
  row.colour = model::colour_text(shape.contour.colour);
  row.kind = kind_text(shape.place.kind);
  row.length_mm = cutting::length_of(shape.contour);
  row.area_mm2 = std::abs(cutting::signed_area(shape.contour));
  const cutting::Box box = cutting::box_of(shape.contour);
  row.box = {{box.low.x, box.low.y, 0}, {box.high.x, box.high.y, 0}};
  cutting::Direction direction = cutting::Direction::drawn;
  if (shape.operation) {
    row.operation = operations[*shape.operation].name;
    const OperationChoice& choice = description.operations[*shape.operation];
    row.operation_kind = choice.is_off ? "off" : choice.kind;
    if (operations[*shape.operation].kind != OperationKind::ignore)
      direction = operations[*shape.operation].direction;
  }
  if (shape.contour.closed)
    row.direction =
        cutting::is_counter_clockwise(cutting::directed(shape, direction)) ? "ccw" : "cw";
  return row;
}

struct Prepared {
  CutDrawing drawing;
  CutResult result;
};

Prepared prepare_cut(const CutDescription& description, Frontend& frontend) {
  Prepared prepared{read_cut_drawing(description), {}};
  CutDrawing& drawing = prepared.drawing;
  const std::vector<Operation> bare = bare_operations(description);
  place_cut_shapes(drawing.shapes, description);
  CutResult& result = prepared.result;
  for (std::size_t i = 0; i < drawing.shapes.size(); ++i)
    result.shapes.push_back(shape_row(drawing.shapes[i], drawing.layers[i], bare, description));
  result.warnings = drawing.warnings;
  const auto without = std::count_if(drawing.shapes.begin(), drawing.shapes.end(),
                                     [](const Shape& shape) { return !shape.operation; });
  std::string text =
      fmt::format("{}: {}", description.drawing.file, count_text(drawing.shapes.size(), "contour"));
  if (drawing.texts > 0)
    text += fmt::format(", {} in {}", count_text(drawing.texts, "text"),
                        std::filesystem::path(drawing.font).filename().string());
  if (without > 0) text += fmt::format(", {} without an operation", without);
  frontend.phase("drawing", text);
  for (const std::string& warning : result.warnings) frontend.say("warning  {}", warning);
  return prepared;
}

std::vector<Operation> operations_of(const CutDescription& description, MachineType machine,
                                     const settings::Values& values) {
  std::vector<Operation> operations;
  for (std::size_t i = 0; i < description.operations.size(); ++i) {
    const OperationChoice& choice = description.operations[i];
    operations.push_back(operation_of(choice, operation_name(choice, i),
                                      description.machine.surface_mm, machine, values));
  }
  // After passes with depths the others return to the surface.
  const bool has_heights = std::any_of(operations.begin(), operations.end(),
                                       [](const Operation& one) { return !one.z_mm.empty(); });
  const bool is_laser = machine == MachineType::laser;
  if (is_laser && !has_heights && description.machine.surface_mm != 0)
    throw Error(Exit::bad_input, "surface", "has no effect without passes with depths",
                "give infeed and final depth, or leave it out");
  for (Operation& one : operations)
    if (has_heights && one.z_mm.empty())
      one.z_mm.assign(static_cast<std::size_t>(one.passes), description.machine.surface_mm);
  return operations;
}

/// Leaves out what was cut before.
void begin_at(std::size_t first, CutPlan& plan) {
  if (first > plan.cuts.size())
    throw Error(Exit::bad_input, fmt::format("cut {}", first),
                fmt::format("the plan has {}", count_text(plan.cuts.size(), "cut")),
                "give the number of one of them, as in the picture");
  if (first == 1) return;
  plan.cuts.erase(plan.cuts.begin(), plan.cuts.begin() + static_cast<std::ptrdiff_t>(first - 1));
  plan.rapid_mm = 0;
  cutting::Vec at;
  for (const cutting::PlannedCut& cut : plan.cuts) {
    for (const cutting::Stroke& stroke : cut.strokes) {
      plan.rapid_mm += distance(at, stroke.front().edge.from);
      at = stroke.back().edge.to;
    }
  }
}

/// Light and air are off; tools stay above the sheet, or away from the contours of a lathe.
void make_dry(std::vector<Operation>& operations, MachineType machine, cutting::Tooling& tooling) {
  for (Operation& operation : operations) {
    operation.power = operation.pierce_s = 0;
    operation.has_air = false;
    if (machine == MachineType::mill || machine == MachineType::knife)
      operation.z_mm = {tooling.surface_mm + tooling.clearance_mm};
    if (machine == MachineType::lathe) operation.z_mm.clear();
  }
  if (machine == MachineType::lathe) tooling.away_mm = tooling.clearance_mm;
}

/// Replaces the cuts by a run around them, without light and slow enough to watch.
void run_around(CutPlan& plan, std::vector<Operation>& operations, const settings::Values& values) {
  constexpr double frame_mm_min = default_frame_speed_m_s * 1000 * 60;
  cutting::Box box;
  for (const cutting::PlannedCut& cut : plan.cuts)
    for (const cutting::Stroke& stroke : cut.strokes)
      for (const cutting::CutMove& move : stroke) box.add(cutting::box_of(move.edge));
  const cutting::Vec low = box.low, high = box.high;
  const std::array<cutting::Vec, 5> corners{low, {high.x, low.y}, high, {low.x, high.y}, low};
  cutting::PlannedCut around{plan.cuts.front().operation, plan.cuts.front().shape, {{}}};
  for (std::size_t i = 1; i < corners.size(); ++i)
    around.strokes.front().push_back(
        {{corners[i - 1], corners[i], {}, 0}, cutting::CutKind::cut, 1});
  around.number = plan.cuts.front().number;
  Operation& operation = operations[around.operation];
  operation.feed_mm_min = std::min({frame_mm_min, in_units(values, settings::Id::max_rate_x, 0),
                                    in_units(values, settings::Id::max_rate_x, 1)});
  operation.passes = 1;
  if (!operation.z_mm.empty()) operation.z_mm.resize(1);
  plan.rapid_mm = distance(cutting::Vec{}, low);
  plan.cuts = {std::move(around)};
}

/// The type of the machine and its tool.
struct ToolSetup {
  MachineType machine = MachineType::laser;
  cutting::Tooling tooling{};
};

/// Adds lengths and the box of the plan.
void measure_plan(const CutPlan& plan, const std::vector<Operation>& operations,
                  const ToolSetup& setup, CutResult& result) {
  cutting::Box box;
  for (const cutting::PlannedCut& cut : plan.cuts) {
    for (const cutting::Stroke& stroke : cut.strokes) {
      for (const cutting::CutMove& move : stroke) {
        box.add(cutting::box_of(move.edge));
        if (move.power > 0) result.cut_mm += cutting::length_of(move.edge);
      }
    }
  }
  double low_z = 0, high_z = 0;
  for (const Operation& operation : operations) {
    for (const double z : operation.z_mm) {
      low_z = std::min(low_z, z);
      high_z = std::max(high_z, z);
    }
  }
  result.cuts = plan.cuts.size();
  result.rapid_mm = plan.rapid_mm;
  if (setup.machine == MachineType::mill || setup.machine == MachineType::knife)
    high_z = std::max(high_z, setup.tooling.surface_mm + setup.tooling.clearance_mm);
  // The axis of a knife is beside its blade.
  box = box.grown(setup.tooling.knife_offset_mm);
  result.box = {{box.low.x, box.low.y, low_z}, {box.high.x, box.high.y, high_z}};
  // The passes of a lathe begin farther outside by its depth.
  const double outer = high_z - low_z + setup.tooling.away_mm + setup.tooling.clearance_mm;
  if (setup.machine == MachineType::lathe)
    result.box = {{box.low.y, 0, box.low.x}, {box.high.y + outer, 0, box.high.x}};
}

cutting::OrderOptions order_of(const CutMachineChoice& machine) {
  const auto& names = cutting::order_search_names;
  const auto found = std::find(names.begin(), names.end(), machine.order);
  return {static_cast<cutting::OrderSearch>(found - names.begin()),
          static_cast<std::size_t>(machine.population)};
}

void warn(const std::vector<std::string>& texts, Frontend& frontend, CutResult& result) {
  for (const std::string& text : texts) {
    frontend.say("warning  {}", text);
    result.warnings.push_back(text);
  }
}

/// Moves without light and air.
bool is_dark(const CutRequest& request) { return request.is_dry || request.is_frame; }

/// The post-processor that the request needs. Throws Error(bad_input) if it cannot serve it.
cutting::Post post_for(const CutRequest& request) {
  const std::string& name = request.description.machine.post;
  cutting::Post post = cutting::post_of(name);
  if (request.is_frame && post.machine == MachineType::lathe)
    throw Error(Exit::bad_input, name, "a lathe cannot run around its workpiece", "make a dry run");
  if (request.is_for_board && (!post.is_checked || post.machine == MachineType::lathe))
    throw Error(Exit::bad_input, name,
                "programs of this post-processor are not for a lamplock board",
                "write the program with -o, or give another post-processor");
  return is_dark(request) ? cutting::without_air(std::move(post)) : post;
}

std::string row_name(const CutShape& row) {
  std::string name = fmt::format("{} {}", row.operation_kind, row.kind);
  return row.layer.empty() ? name : name + fmt::format(", layer {}", row.layer);
}

cutting::ProgramFrame frame_of(const CutRequest& request, const CutPlan& plan,
                               const CutResult& result, const cutting::Tooling& tooling,
                               const settings::Values& values) {
  const std::filesystem::path file(request.description.drawing.file);
  cutting::ProgramFrame frame;
  frame.title = fmt::format("{}, by lamplock cut", file.filename().string());
  for (const CutShape& row : result.shapes) frame.names.push_back(row_name(row));
  if (request.is_frame) frame.names[plan.cuts.front().shape] = "frame around the cuts";
  frame.max_s = in_units(values, settings::Id::max_spindle_speed);
  frame.tooling = tooling;
  return frame;
}

/// The operations with the values of their materials, dark if the request is.
std::vector<Operation> operations_for(const CutRequest& request, const cutting::Post& post,
                                      const settings::Values& values, cutting::Tooling& tooling,
                                      Frontend& frontend) {
  std::vector<Operation> operations = operations_of(
      with_materials(request.description, request.library, frontend), post.machine, values);
  if (is_dark(request))
    make_dry(operations, post.machine, tooling);
  else if (post.machine != MachineType::knife)
    require_power(operations, post.machine, values);
  return operations;
}

}  // namespace

CutResult list_shapes(const CutDescription& description, Frontend& frontend) {
  return prepare_cut(description, frontend).result;
}

CutResult make_cut(const CutRequest& request, Frontend& frontend) {
  const CutDescription& description = request.description;
  check_cut_outputs(request);
  const cutting::Post post = post_for(request);
  const job::Profile profile = MachineOptions{description.machine.profile}.profile();
  auto [drawing, result] = prepare_cut(description, frontend);
  ToolSetup setup{post.machine, tooling_of(description.machine, post.machine)};
  std::vector<Operation> operations =
      operations_for(request, post, profile.settings, setup.tooling, frontend);
  warn(operation_warnings(operations, post, profile.settings), frontend, result);
  warn(place_warnings(drawing.shapes, operations, description), frontend, result);
  CutPlan plan =
      cutting::plan_cuts(drawing.shapes, operations, {0, 0}, order_of(description.machine));
  warn(fault_texts(plan.faults, description.drawing.tolerance_mm), frontend, result);
  begin_at(request.first, plan);
  if (request.is_frame) run_around(plan, operations, profile.settings);
  warn(cutting::require_lines(post, description.machine.post, plan, operations), frontend, result);
  measure_plan(plan, operations, setup, result);
  require_inside(description.drawing.file, result.box, profile.settings);
  frontend.phase("plan", fmt::format("{}, {} mm to cut, {} mm of rapids, {}",
                                     count_text(result.cuts, "cut"), number_text(result.cut_mm),
                                     number_text(result.rapid_mm), bounds_text(result.box)));
  cutting::ProgramFrame frame = frame_of(request, plan, result, setup.tooling, profile.settings);
  CutProgram program;
  program.is_lathe = post.machine == MachineType::lathe;
  cutting::ProgramLines lines;
  result.program = cutting::cut_program(plan, operations, post, frame, &lines);
  for (const cutting::PlannedCut& cut : plan.cuts) result.cut_numbers.push_back(cut.number);
  result.first_lines = program.first_lines = lines.first;
  if (post.is_checked) {
    frame.has_radii = program.is_lathe;
    const std::string text = frame.has_radii
                                 ? cutting::cut_program(plan, operations, post, frame, &lines)
                                 : result.program;
    program.run =
        checked_run({text, lines, plan, operations, post, frame, result.box, is_dark(request)},
                    profile.settings, description.machine.post);
    result.seconds = program.run->seconds();
  } else if (is_dark(request) && post.machine == MachineType::laser) {
    cutting::require_dark_words(result.program, description.machine.post);
  }
  const CutMade made{plan, drawing.shapes, operations, frame.title, frame.names, program, result};
  write_cut_files(request, made, frontend);
  if (request.has_report) result.report = report_of(made);
  if (result.seconds) frontend.say("time     {}", duration_text(*result.seconds));
  return result;
}

}  // namespace lamplock::run
