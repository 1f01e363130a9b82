#include "host/serve/octoprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/link/program_lines.hpp"
#include "host/run/job_control.hpp"
#include "host/run/program_control.hpp"
#include "host/serve/access.hpp"
#include "host/serve/client_json.hpp"
#include "host/serve/error_message.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/multipart.hpp"
#include "host/serve/url_text.hpp"
#include "host/version.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

constexpr std::string_view prefix = "/api/", files = "files/local";
constexpr std::size_t max_command_bytes = 64 * 1024, max_form_bytes = 16 * 1024;
constexpr std::size_t max_lines = 50;
constexpr double percent = 100;

/// Without the query: OctoPrint's leave parts of an answer out.
std::string path_of(const std::string& target) {
  const std::string path = target.substr(0, target.find('?'));
  return path.substr(std::min(prefix.size(), path.size()));
}

bool is_read(const std::string& path) {
  constexpr std::array reads{"version", "job", "printer"};
  return std::find(reads.begin(), reads.end(), path) != reads.end();
}

bool is_write(const std::string& path) {
  constexpr std::array writes{"login", "job", "printer/command"};
  return std::find(writes.begin(), writes.end(), path) != writes.end() || path.starts_with(files);
}

WebReply json_reply(int status, const Json& json) {
  return {status, "application/json",
          json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

WebReply rest_refusal(int status, const std::string& text) {
  return json_reply(status, {{"error", text}});
}

WebReply no_content() { return {204, "application/json", ""}; }

/// Whether a running job waits for a resume. While it waits for a lamp or a connection, a pause has
/// to hold it.
bool is_held(const JobView& job) {
  return job.is_running && (job.word == run::held_word || job.word == run::pause_word ||
                            job.word == run::tool_change_word);
}

/// The state in OctoPrint's words.
Json rest_state(const MachineView& view) {
  const bool is_alarm = view.board.state.starts_with("Alarm");
  const bool is_open = view.board.is_connected;
  const bool is_paused = is_held(view.job);
  const bool is_printing = view.job.is_running && !is_paused;
  const char* text = !is_open      ? "Offline"
                     : is_alarm    ? "Error"
                     : is_paused   ? "Paused"
                     : is_printing ? "Printing"
                                   : "Operational";
  return {{"text", text},
          {"flags",
           {{"operational", is_open && !is_alarm},
            {"printing", is_printing},
            {"paused", is_paused},
            {"pausing", false},
            {"cancelling", false},
            {"sdReady", false},
            {"error", is_alarm},
            {"ready", is_open && !is_alarm && !view.job.is_running},
            {"closedOrError", !is_open || is_alarm}}}};
}

Json rest_job(const MachineView& view, const std::string& selected) {
  const JobView& job = view.job;
  const std::string& name = job.is_running ? job.name : selected;
  const Json done =
      job.is_running && job.total > 0
          ? Json(percent * static_cast<double>(job.done) / static_cast<double>(job.total))
          : Json();
  return {{"job", {{"file", {{"name", name.empty() ? Json() : Json(name)}, {"origin", "local"}}}}},
          {"progress",
           {{"completion", done}, {"printTimeLeft", job.left_s ? Json(*job.left_s) : Json()}}},
          {"state", rest_state(view)["text"]}};
}

std::vector<std::string> lines_of(const Json& body) {
  Json list = body.value("commands", Json::array());
  if (body.contains("command")) list.push_back(body["command"]);
  if (!list.is_array() || list.empty() || list.size() > max_lines)
    throw Error(Exit::bad_input, "command", "is missing", "give command or commands, 50 at most");
  std::vector<std::string> lines;
  for (const Json& each : list) {
    if (!each.is_string()) throw Error(Exit::bad_input, "command", "is not a text", "give G-code");
    const std::string line = link::line_to_send(each.get<std::string>(), "command", "remove it");
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

}  // namespace

OctoPrint::OctoPrint(std::string key, JobFolder folder, std::function<void()> require_right)
    : key_(std::move(key)), folder_(std::move(folder)), require_right_(std::move(require_right)) {}

bool OctoPrint::has(const std::string& target) { return target.starts_with(prefix); }

Admission OctoPrint::admit(const WebRequest& head, std::size_t max_file_bytes) const {
  if (!is_same_secret(head.api_key, key_))
    return {rest_refusal(403, "needs X-Api-Key with the key")};
  const std::string path = path_of(head.target);
  if (!is_read(path) && !is_write(path)) return {rest_refusal(404, "is not supported")};
  if (head.method == "GET" && is_read(path)) return {};
  if (head.method != "POST" || !is_write(path)) return {rest_refusal(405, "wrong method")};
  const bool is_upload = path == files;
  const char* const type = is_upload ? "multipart/form-data" : "application/json";
  if (head.content_type.substr(0, head.content_type.find(';')) != type)
    return {rest_refusal(415, fmt::format("needs Content-Type: {}", type))};
  return {std::nullopt, is_upload ? max_file_bytes + max_form_bytes : max_command_bytes};
}

WebReply OctoPrint::reply(const WebRequest& request, Machine& machine) {
  const std::string path = path_of(request.target);
  try {
    return request.method == "GET" ? get(path, machine.view()) : post(path, request, machine);
  } catch (const Error& error) {
    return rest_refusal(error.exit() == Exit::bad_input ? 400 : 409, message_of(error));
  } catch (const Json::exception&) {
    return rest_refusal(400, "a member of the body has the wrong type");
  } catch (const std::exception& error) {
    return rest_refusal(500, error.what());
  }
}

WebReply OctoPrint::get(const std::string& path, const MachineView& view) const {
  if (path == "version")  // slicers look for the first word
    return json_reply(200, {{"api", "0.1"},
                            {"server", version()},
                            {"text", fmt::format("OctoPrint (lamplock {})", version())}});
  if (path == "job") return json_reply(200, rest_job(view, selected_));
  if (!view.board.is_connected) return rest_refusal(409, "the board is not connected");
  return json_reply(200, {{"state", rest_state(view)}, {"temperature", Json::object()}});
}

WebReply OctoPrint::post(const std::string& path, const WebRequest& request, Machine& machine) {
  if (path == files) return take_file(request, machine);
  const Json body = client_json(request.body);
  if (!body.is_object()) return rest_refusal(400, "the body is not a JSON object");
  if (path == "login")
    return json_reply(200, {{"name", "lamplock"}, {"active", true}, {"user", true}});
  if (path == "job") {
    take_job_command(body, machine);
    return no_content();
  }
  if (path == "printer/command") {
    require_right_();
    for (const std::string& line : lines_of(body)) machine.send_line(line);
    return no_content();
  }
  if (!path.starts_with(std::string(files) + "/")) return rest_refusal(404, "is not supported");
  return take_file_command(decoded(std::string_view(path).substr(files.size() + 1)), body, machine);
}

WebReply OctoPrint::take_file(const WebRequest& request, Machine& machine) {
  const std::vector<FormPart> form = parse_form(request.content_type, request.body);
  const auto is_set = [&](const char* name) {
    return std::any_of(form.begin(), form.end(), [&](const FormPart& part) {
      return part.name == name && part.content == "true";
    });
  };
  const auto file = std::find_if(form.begin(), form.end(),
                                 [](const FormPart& part) { return !part.file_name.empty(); });
  if (file == form.end())
    throw Error(Exit::bad_input, "form", "has no file", "send it as the field 'file'");
  // Some programs send the path of their computer.
  const std::string name = file->file_name.substr(file->file_name.find_last_of("/\\") + 1);
  const JobView job = machine.view().job;
  if (job.is_running && job.name == name)
    throw Error(Exit::job_failed, name, "the job runs", "use another name");
  const bool starts = is_set("print"), selects = starts || is_set("select");
  if (starts) require_right_();
  folder_.write(name, file->content);
  if (selects) select(name, starts, machine);
  return json_reply(
      201, {{"done", true},
            {"effectivePrint", starts},
            {"effectiveSelect", selects},
            {"files", {{"local", {{"name", name}, {"path", name}, {"origin", "local"}}}}}});
}

WebReply OctoPrint::take_file_command(const std::string& name, const Json& command,
                                      Machine& machine) {
  if (command.value("command", Json()) != "select")
    return rest_refusal(400, "only the command select is supported");
  const Json starts = command.value("print", Json(false));
  select(name, starts.is_boolean() && starts.get<bool>(), machine);
  return no_content();
}

void OctoPrint::select(const std::string& name, bool starts, Machine& machine) {
  folder_.path_of(name);
  selected_ = name;
  if (starts) start(machine);
}

void OctoPrint::start(Machine& machine) const {
  require_right_();
  if (selected_.empty())
    throw Error(Exit::job_failed, "job", "no file is selected", "select one first");
  machine.start({selected_, folder_.path_of(selected_).string()});
}

void OctoPrint::take_job_command(const Json& body, Machine& machine) {
  const std::string command = body.value("command", std::string());
  const JobView job = machine.view().job;
  if (command == "start") return start(machine);
  if (command != "cancel" && command != "pause")
    throw Error(Exit::bad_input, "command", "is not supported", "use start, pause or cancel");
  if (command == "cancel") return machine.stop();
  if (!job.is_running) throw Error(Exit::job_failed, "job", "no job runs", "start one");
  const std::string action = body.value("action", std::string("toggle"));
  if (action == "resume" || (action == "toggle" && is_held(job))) {
    require_right_();
    return machine.resume();
  }
  machine.hold();
}

}  // namespace lamplock::serve
