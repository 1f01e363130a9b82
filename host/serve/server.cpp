#include "host/serve/server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/serve/access.hpp"
#include "host/serve/camera.hpp"
#include "host/serve/client_json.hpp"
#include "host/serve/clouds.hpp"
#include "host/serve/computations.hpp"
#include "host/serve/history.hpp"
#include "host/serve/logins.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/method.hpp"
#include "host/serve/octoprint.hpp"
#include "host/serve/page_document.hpp"
#include "host/serve/page_files.hpp"
#include "host/serve/refusal.hpp"
#include "host/serve/running_job.hpp"
#include "host/serve/url_text.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr const char* api_target = "/api";
constexpr const char* socket_target = "/ws";
constexpr const char* login_target = "/login";
constexpr const char* camera_target = "/camera";
constexpr std::string_view files_target = "/files/";
constexpr std::string_view reports_target = "/reports/";
constexpr const char* needs_token = "needs Authorization: Bearer and the token";
constexpr std::size_t max_login_bytes = 2048, max_call_bytes = 256 * 1024,
                      max_file_bytes = 32 * 1024 * 1024;
constexpr auto login_time = 5s;
/// The holder of control gets the time of the server this often: a jog needs it.
constexpr auto time_interval = 100ms;
constexpr std::size_t max_answers = 64;
constexpr std::size_t min_secret = 16, max_secret = 64;

/// Methods that act each time, whatever id their request has.
bool ends_motion(const Method& method) {
  constexpr std::array<std::string_view, 3> names{"machine.stop", "machine.hold", "jog.stop"};
  return std::find(names.begin(), names.end(), method.name) != names.end();
}

WebReply refusal(int status, const std::string& text) {
  return {status, "text/plain; charset=utf-8", text + "\n"};
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// What turns `from` into `to` (RFC 7396), for objects without null.
Json difference(const Json& from, const Json& to) {
  Json patch = Json::object();
  for (const auto& [name, value] : to.items()) {
    const auto before = from.find(name);
    if (before == from.end() || !before->is_object() || !value.is_object()) {
      if (before == from.end() || *before != value) patch[name] = value;
    } else if (Json inner = difference(*before, value); !inner.empty()) {
      patch[name] = std::move(inner);
    }
  }
  for (const auto& [name, value] : from.items())
    if (!to.contains(name)) patch[name] = nullptr;
  return patch;
}

Json board_json(const BoardView& board) {
  return {{"connected", board.is_connected},
          {"problem", board.problem},
          {"state", board.state},
          {"machine", board.machine_mm},
          {"work", board.work_mm},
          {"overrides", board.overrides},
          {"jogs", board.jogs}};
}

Json job_json(const JobView& job) {
  Json json{{"running", job.is_running}, {"name", job.name},   {"dry", job.is_dry},
            {"title", job.title},        {"done", job.done},   {"total", job.total},
            {"word", job.word},          {"speed", job.speed}, {"end", job.end},
            {"message", job.message}};
  if (job.left_s) json["left_s"] = *job.left_s;
  return json;
}

}  // namespace

Server::Server(SiteOptions options, JobFolder folder)
    : options_(std::move(options)),
      folder_(std::move(folder)),
      reports_(folder_.path() / ".reports"),
      document_(std::make_unique<PageDocument>(page_document(options_.texts))),
      logins_(std::make_unique<Logins>(options_.password_hash, options_.now, options_.note)),
      computations_(std::make_unique<Computations>()),
      clouds_(std::make_unique<Clouds>()),
      history_(
          std::make_unique<History>(options_.library, options_.board, reports_, options_.note)),
      running_job_(std::make_unique<RunningJob>(folder_.path())) {
  if (!options_.camera.empty()) camera_ = std::make_unique<Camera>(options_.camera);
  if (!options_.octoprint_key.empty())
    octoprint_ = std::make_unique<OctoPrint>(options_.octoprint_key, folder_,
                                             [this] { require_program_right(); });
}

Server::~Server() = default;

void Server::use(WebServer& web, Machine& machine) {
  web_ = &web;
  machine_ = &machine;
  std::optional<EndedJob> left = running_job_->take_left();
  if (!left) return;
  machine_->show_last(left->view);
  options_.note(fmt::format("{}: {}", left->view.name, left->view.message));
  history_->add({std::move(*left)});
}

void Server::end() {
  computations_->end();
  history_->add(machine_->take_ended());
  history_->end();
  running_job_->end();
  logins_->end();
}

// HTTP.

bool Server::is_token(std::string_view token) {
  return is_same_secret(token, options_.token) || logins_->is_session(token);
}

bool Server::is_permitted(const WebRequest& head) {
  constexpr std::string_view scheme = "Bearer ";
  return head.authorization.starts_with(scheme) &&
         is_token(std::string_view(head.authorization).substr(scheme.size()));
}

std::optional<WebReply> Server::refusal_of_names(const WebRequest& head) const {
  const ServerNames names{web_->port(), options_.proxy};
  if (!names.is_host(head.host, head.local)) return refusal(403, "Host is not this server");
  if (head.origin && !names.is_origin(*head.origin, head.local))
    return refusal(403, "Origin is not this server");
  return std::nullopt;
}

Admission Server::admit(const WebRequest& head) {
  if (auto refused = refusal_of_names(head)) return {std::move(refused)};
  if (head.target == socket_target)
    return head.is_upgrade ? Admission{} : Admission{refusal(426, "needs a WebSocket")};
  if (head.is_upgrade) return {refusal(404, "no WebSocket here")};
  if (octoprint_ && OctoPrint::has(head.target)) return octoprint_->admit(head, max_file_bytes);
  if (find_page_file(head.target) != nullptr || head.target.starts_with(reports_target))
    return head.method == "GET" ? Admission{} : Admission{refusal(405, "only GET")};
  if (head.target == camera_target && camera_) {
    if (head.method != "GET") return {refusal(405, "only GET")};
    return is_permitted(head) ? Admission{} : Admission{refusal(401, needs_token)};
  }
  const bool is_login = head.target == login_target && logins_->has_password();
  const bool is_call = head.target == api_target;
  if (!is_login && !is_call && !head.target.starts_with(files_target))
    return {refusal(404, "not found")};
  if (head.method != "POST") return {refusal(405, "only POST")};
  if (!is_login && !is_permitted(head)) return {refusal(401, needs_token)};
  // Types that a form can send are refused: a browser asks before it sends others.
  const std::string type = is_call || is_login ? "application/json" : "application/octet-stream";
  if (head.content_type != type) return {refusal(415, "needs Content-Type: " + type)};
  return {std::nullopt, is_login ? max_login_bytes : is_call ? max_call_bytes : max_file_bytes};
}

void Server::reply(WebRequest request, Answer answer) {
  if (octoprint_ && OctoPrint::has(request.target))
    return answer(octoprint_->reply(request, *machine_));
  if (request.target == page_target)
    return answer({200, "text/html; charset=utf-8", document_->html, document_->policy});
  if (request.target.starts_with(reports_target))
    return answer(report_of(request.target.substr(reports_target.size())));
  if (const PageFile* page = find_page_file(request.target))
    return answer({200, page->type, std::string(page->text())});
  if (request.target == camera_target) return answer(camera_picture());
  if (request.target == login_target)
    return logins_->request(request.body, request.remote, std::move(answer));
  if (request.target != api_target) return answer(take_file(request));
  Call call;
  call.respond = [answer = std::move(answer)](const std::string& text) {
    answer({200, "application/json", text});
  };
  take_request(request.body, std::move(call));
}

WebReply Server::take_file(const WebRequest& request) {
  const std::string name = decoded(std::string_view(request.target).substr(files_target.size()));
  try {
    const JobView job = machine_->view().job;
    if (job.is_running && job.name == name)
      throw Refusal(Exit::job_failed, "job-runs", {{"job", name}});
    folder_.write(name, request.body);
    return {201, "text/plain; charset=utf-8", name + "\n"};
  } catch (const Error& error) {
    return {422, "application/json", text_of(error_json(error))};
  } catch (const std::exception& error) {
    return refusal(500, error.what());
  }
}

// WebSockets.

void Server::opened(ClientNumber client) { clients_[client].opened_at = options_.now(); }

void Server::received(ClientNumber client, const std::string& text) {
  Call call;
  call.client = client;
  call.secret = clients_[client].secret;
  call.respond = [this, client](const std::string& answer) { web_->send(client, answer); };
  take_request(text, std::move(call));
}

void Server::closed(ClientNumber client) {
  const std::string secret = clients_[client].secret;
  clients_.erase(client);
  if (secret.empty() || secret != holder_ || has_client(secret)) return;
  holder_.clear();
  machine_->stop_jog();
}

bool Server::has_client(const std::string& secret) const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [&](const auto& each) { return each.second.secret == secret; });
}

// Requests.

void Server::take_request(const std::string& text, Call call) {
  const Json request = client_json(text);
  call.id = "null";
  call.request = std::hash<std::string>()(text);
  if (request.is_discarded()) return fail(call, code::parse, "is not valid JSON");
  if (!request.is_object()) return fail(call, code::request, "must be one request");
  const Json id = request.value("id", Json());
  const bool is_id = id.is_number_integer() ||
                     (id.is_string() && id.get_ref<const std::string&>().size() <= max_secret);
  if (request.value("jsonrpc", Json()) != "2.0" || !is_id)
    return fail(call, code::request, "needs jsonrpc 2.0 and an id, a text or a whole number");
  call.id = id.dump();
  const Json name = request.value("method", Json());
  const Method* method =
      name.is_string() ? find_method(name.get_ref<const std::string&>()) : nullptr;
  if (method == nullptr) return fail(call, code::method, "there is no such method");
  call.given = std::make_shared<const Json>(request.value("params", Json::object()));
  const std::string wrong = refusal_of(*method, call.parameters());
  if (!wrong.empty()) return fail(call, code::parameters, wrong);
  if (call.client == 0) {
    const Json secret = request.value("client", Json());
    if (secret.is_string() && secret.get_ref<const std::string&>().size() >= min_secret &&
        secret.get_ref<const std::string&>().size() <= max_secret)
      call.secret = secret;
  } else if (call.secret.empty() && std::string_view(method->name) != "login") {
    fail(call, code::refused, "login must be the first message");
    return web_->drop(call.client);
  }
  if (ends_motion(*method) || !was_called(call)) call_method(*method, call);
}

/// A request that was sent a second time, over a new connection perhaps, gets the same answer.
bool Server::was_called(const Call& call) {
  if (call.secret.empty()) return false;
  Person& caller = person(call.secret);
  const auto [known, is_new] = caller.answers.try_emplace(call.id, Answered{call.request, {}});
  if (!is_new) {
    if (known->second.request != call.request)
      fail(call, code::request, "has the id of another request; give each request its own");
    else if (!known->second.answer.empty())
      call.respond(known->second.answer);
    return true;
  }
  caller.ids.push_back(call.id);
  if (caller.ids.size() > max_answers) {
    caller.answers.erase(caller.ids.front());
    caller.ids.pop_front();
  }
  return false;
}

void Server::call_method(const Method& method, const Call& call) {
  try {
    check_right(method, call);
    (this->*handlers().at(method.name))(call);
  } catch (const std::exception& error) {
    fail(call, error);
  }
}

void Server::check_right(const Method& method, const Call& call) const {
  if (method.right == Right::all) return;
  if (holder_.empty() || holder_ != call.secret)
    throw Refusal(Exit::job_failed, "no-control", {{"method", method.name}});
  if (method.right != Right::firing || options_.is_simulated || keeps_dark(method, call)) return;
  const auto caller = persons_.find(call.secret);
  if (caller == persons_.end() || !caller->second.is_paired)
    throw Refusal(Exit::job_failed, "not-paired", {{"method", method.name}});
}

/// A program with the key of OctoPrint was not paired at the machine, and takes control from none.
void Server::require_program_right() const {
  if (!holder_.empty())
    throw Error(Exit::job_failed, "control", "a page holds control", "release it there");
  if (!options_.is_simulated)
    throw Error(Exit::job_failed, "octoprint", "a program may not fire on a real board",
                "send the file, and start it in a page that is paired");
}

/// A dry run, or the resume of one that has begun: before that, a program of an earlier server may
/// be held on the board.
bool Server::keeps_dark(const Method& method, const Call& call) const {
  if (std::string_view(method.name) == "job.start") return call.parameters().value("dry", false);
  return std::string_view(method.name) == "machine.resume" && machine_->runs_dry_job();
}

void Server::succeed(const Call& call, const Json& result) {
  finish(call, {{"jsonrpc", "2.0"}, {"id", Json::parse(call.id)}, {"result", result}});
}

void Server::fail(const Call& call, int code, const std::string& message) {
  fail(call, Json{{"code", code}, {"message", message}});
}

void Server::fail(const Call& call, const std::exception& error) { fail(call, error_json(error)); }

void Server::fail(const Call& call, const Json& error) {
  finish(call, {{"jsonrpc", "2.0"}, {"id", Json::parse(call.id)}, {"error", error}});
}

void Server::finish(const Call& call, const Json& response) {
  const std::string text = text_of(response);
  if (const auto caller = persons_.find(call.secret); caller != persons_.end())
    if (const auto open = caller->second.answers.find(call.id);
        open != caller->second.answers.end() && open->second.request == call.request)
      open->second.answer = text;
  call.respond(text);
}

// Notifications.

std::int64_t Server::time_ms() const {
  return std::chrono::duration_cast<std::chrono::milliseconds>(options_.now() - begun_at_).count();
}

Json Server::status() const {
  const MachineView view = machine_->view();
  const auto holder = persons_.find(holder_);
  const std::string name = holder == persons_.end() ? "" : holder->second.name;
  return {
      {"board", board_json(view.board)},
      {"job", job_json(view.job)},
      {"control", {{"held", !holder_.empty()}, {"holder", name}, {"clients", clients_.size()}}}};
}

void Server::tick() {
  computations_->poll();
  logins_->poll();
  history_->add(machine_->take_ended());
  history_->poll();
  running_job_->note(machine_->view().job, options_.now());
  std::vector<ClientNumber> late;
  for (const auto& [number, client] : clients_)
    if (client.secret.empty() && options_.now() - client.opened_at > login_time)
      late.push_back(number);
  for (const ClientNumber number : late) web_->drop(number);
  const Json now = status();
  std::vector<ClientNumber> watching;  // sending may drop one of them
  for (const auto& [number, client] : clients_)
    if (client.is_subscribed && !web_->is_behind(number)) watching.push_back(number);
  for (const ClientNumber number : watching)
    if (const auto found = clients_.find(number); found != clients_.end())
      notify(number, found->second, now);
}

void Server::notify(ClientNumber number, Client& client, const Json& now) {
  Json own = now;
  own["control"]["own"] = !holder_.empty() && client.secret == holder_;
  own["control"]["paired"] = options_.is_simulated || person(client.secret).is_paired;
  const Json patch = difference(*client.sent, own);
  const bool needs_time =
      client.secret == holder_ && options_.now() - client.told_at >= time_interval;
  if (!patch.empty() || needs_time) {
    client.told_at = options_.now();
    client.sent = std::make_shared<const Json>(std::move(own));
    web_->send(number, text_of({{"jsonrpc", "2.0"},
                                {"method", "status"},
                                {"params", {{"time", time_ms()}, {"patch", patch}}}}));
  }
  const auto lines = machine_->lines_after(client.line);
  if (lines.empty() || !clients_.contains(number)) return;
  client.line = lines.back().number;
  Json shown = Json::array();
  for (const ConsoleLine& line : lines)
    shown.push_back({{"number", line.number}, {"text", line.text}});
  web_->send(number, text_of({{"jsonrpc", "2.0"},
                              {"method", "console"},
                              {"params", {{"lines", std::move(shown)}}}}));
}

}  // namespace lamplock::serve
