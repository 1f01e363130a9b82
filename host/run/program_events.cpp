#include "host/run/program_events.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace lamplock::run {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(program::Spindle spindle) {
  if (spindle == program::Spindle::off) return "off";
  return spindle == program::Spindle::constant ? "M3" : "M4";
}

Json outputs_json(const program_run::BlockOutputs& outputs) {
  return {{"spindle", name_of(outputs.spindle())},
          {"s", outputs.speed_s()},
          {"mist", outputs.mist()},
          {"flood", outputs.flood()},
          {"aux", outputs.aux()}};
}

/// What the board has reported last, and when.
void add_state(Json& json, const link::LineSender& sender) {
  const link::BoardStatus& status = sender.status();
  json["state"] = status.state;
  json["position"] = status.position;
  json["of_work"] = status.of_work;
  json["time_s"] = std::chrono::duration<double>(sender.elapsed()).count();
}

/// A file need not be valid UTF-8.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

ProgramEvents::ProgramEvents(EventStream& stream, std::string path,
                             const std::vector<link::ProgramLine>& lines,
                             const settings::Values& values, const program_run::BoardState* state)
    : path_(std::move(path)), lines_(lines), stream_(stream), outputs_(values, state) {}

void ProgramEvents::poll(const link::LineSender& sender, Progress& progress) {
  while (written_ < sender.done() && !is_lost()) add_block(sender, written_++);
  stream_.poll();
  show_loss(progress);
}

void ProgramEvents::end(const link::LineSender& sender, const std::string& name,
                        Progress& progress) {
  poll(sender, progress);
  Json json{{"event", "end"}, {"end", name}};
  add_state(json, sender);
  stream_.add(text_of(json));
  stream_.finish();
  show_loss(progress);
}

void write_refusal(EventStream& stream, std::string_view message) {
  stream.add(text_of({{"event", "end"}, {"end", "refused"}, {"message", message}}));
  stream.finish();
}

void replace_events(const std::string& path, const Error& error) {
  if (path.empty()) return;
  EventStream::check(path);
  EventStream stream(path);
  write_refusal(stream, error.message());
}

void ProgramEvents::add_block(const link::LineSender& sender, std::size_t index) {
  const link::ProgramLine& line = lines_[index];
  const bool is_refused =
      errors_ < sender.errors().size() && sender.errors()[errors_].index == index;
  if (!is_refused) outputs_.run(line.text);
  Json json{{"event", "block"}, {"line", line.number}, {"text", line.text}};
  if (is_refused) json["error"] = sender.errors()[errors_++].error;
  add_state(json, sender);
  json["outputs"] = outputs_json(outputs_);
  stream_.add(text_of(json));
}

void ProgramEvents::show_loss(Progress& progress) {
  if (!is_lost() || is_shown_) return;
  is_shown_ = true;
  progress.note(
      fmt::format("warning: --events {}: cannot be written ({}); the program continues "
                  "without it",
                  path_, stream_.loss()));
}

}  // namespace lamplock::run
