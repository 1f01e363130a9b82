// The methods macro.*, camera.*, history.list and material.list of the server.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/serve/camera.hpp"
#include "host/serve/camera_points.hpp"
#include "host/serve/content_policy.hpp"
#include "host/serve/history.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/macros.hpp"
#include "host/serve/refusal.hpp"
#include "host/serve/server.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

/// Hidden: no client can send a file of this name.
Macros macros_in(const JobFolder& folder) { return Macros(folder.path() / ".macros.json"); }

std::filesystem::path camera_file(const JobFolder& folder) {
  return folder.path() / ".camera.json";
}

}  // namespace

void Server::list_macros(const Call& call) { succeed(call, macros_in(folder_).all()); }

void Server::set_macro(const Call& call) {
  macros_in(folder_).set(call.parameters()["name"], call.parameters()["lines"]);
  succeed(call, nullptr);
}

void Server::remove_macro(const Call& call) {
  macros_in(folder_).remove(call.parameters()["name"]);
  succeed(call, nullptr);
}

void Server::run_macro(const Call& call) {
  machine_->send_lines(macros_in(folder_).lines_of(call.parameters()["name"]));
  succeed(call, nullptr);
}

void Server::list_history(const Call& call) {
  const auto jobs = std::make_shared<Json>();
  compute(
      call,
      [jobs, library = options_.library, reports = reports_] {
        *jobs = history_json(library, reports);
      },
      [jobs] { return *jobs; });
}

WebReply Server::report_of(const std::string& name) const {
  const std::optional<std::string> html = reports_.read(name);
  if (!html) return {404, "text/plain; charset=utf-8", "no such report\n"};
  return {200, "text/html; charset=utf-8", *html, alone_policy(*html)};
}

void Server::get_camera(const Call& call) {
  succeed(call,
          {{"camera", camera_ != nullptr}, {"points", read_camera_points(camera_file(folder_))}});
}

void Server::calibrate_camera(const Call& call) {
  if (!camera_) throw Refusal(Exit::bad_input, "no-camera");
  write_camera_points(camera_file(folder_), call.parameters()["points"]);
  succeed(call, nullptr);
}

WebReply Server::camera_picture() const {
  if (const auto picture = camera_->picture()) return {200, "image/jpeg", *picture};
  return {503, "text/plain; charset=utf-8", camera_->problem() + "\n"};
}

void Server::list_materials(const Call& call) {
  const auto rows = std::make_shared<Json>();
  compute(
      call, [rows, library = options_.library] { *rows = materials_json(library); },
      [rows] { return *rows; });
}

}  // namespace lamplock::serve
