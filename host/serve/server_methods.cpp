// The methods of the server (method.hpp), one function each. Parameters have been checked.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/program_lines.hpp"
#include "host/serve/access.hpp"
#include "host/serve/check_file.hpp"
#include "host/serve/computations.hpp"
#include "host/serve/logins.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/material_choice.hpp"
#include "host/serve/method.hpp"
#include "host/serve/refusal.hpp"
#include "host/serve/server.hpp"
#include "host/units.hpp"
#include "host/version.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::serve {
namespace {

/// Wrong codes until none is right.
constexpr int max_wrong_codes = 5;
/// Persons beyond these are forgotten, unless they are paired or connected.
constexpr std::size_t max_persons = 600;
/// A jog ends this long after the notification that its last request has seen, however late the
/// request comes: a page that has died, or its network, cannot extend it.
constexpr std::chrono::milliseconds max_age{240};

std::string word_of(const std::string& change) {
  return change == "more" ? "+" : change == "less" ? "-" : "=";
}

double number_of(std::int32_t milli) { return milli / milli_per_unit; }

nlohmann::json settings_json(const link::BoardSettings& board) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<settings::Id>(i);
    const settings::Row& row = settings::row(id);
    if (!board.has(id)) continue;
    rows.push_back({{"number", row.number},
                    {"name", row.name},
                    {"unit", row.unit},
                    {"min", number_of(row.min_milli)},
                    {"max", number_of(row.max_milli)},
                    {"whole", row.whole},
                    {"default", number_of(row.default_milli)},
                    {"value", number_of(board.values.milli(id))},
                    {"about", row.description}});
  }
  return rows;
}

std::vector<link::Change> changes_of(const nlohmann::json& wanted) {
  std::vector<link::Change> changes;
  for (const auto& [name, value] : wanted.items()) {
    if (!value.is_number() && !value.is_string())
      throw Error(Exit::bad_input, name, "is neither a number nor a text", "give a number");
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    changes.push_back(link::parse_change(fmt::format("{}={}", name, text), name));
  }
  return changes;
}

}  // namespace

const std::map<std::string_view, Server::Handler>& Server::handlers() {
  static const std::map<std::string_view, Handler> all{
      {"login", &Server::login},
      {"pair", &Server::pair},
      {"status", &Server::send_status},
      {"subscribe", &Server::subscribe},
      {"control.take", &Server::take_control},
      {"control.release", &Server::release_control},
      {"machine.stop", &Server::stop},
      {"machine.hold", &Server::hold},
      {"machine.resume", &Server::resume},
      {"machine.feed", &Server::change_feed},
      {"machine.home", &Server::home},
      {"machine.unlock", &Server::unlock},
      {"machine.zero", &Server::zero},
      {"machine.area", &Server::send_area},
      {"job.list", &Server::list_jobs},
      {"job.check", &Server::check_job},
      {"job.start", &Server::start_job},
      {"job.make", &Server::make_job},
      {"job.delete", &Server::delete_job},
      {"path.open", &Server::open_path},
      {"cloud.open", &Server::open_cloud},
      {"cloud.points", &Server::send_cloud_points},
      {"cloud.near", &Server::find_near_points},
      {"scene.open", &Server::open_scene},
      {"scene.write", &Server::write_scene},
      {"console.send", &Server::send_line},
      {"console.lines", &Server::send_lines},
      {"macro.list", &Server::list_macros},
      {"macro.set", &Server::set_macro},
      {"macro.remove", &Server::remove_macro},
      {"macro.run", &Server::run_macro},
      {"history.list", &Server::list_history},
      {"material.list", &Server::list_materials},
      {"camera.get", &Server::get_camera},
      {"camera.calibrate", &Server::calibrate_camera},
      {"jog.run", &Server::run_jog},
      {"jog.step", &Server::step_jog},
      {"jog.go", &Server::go_jog},
      {"jog.renew", &Server::renew_jog},
      {"jog.stop", &Server::stop_jog},
      {"settings.get", &Server::get_settings},
      {"settings.set", &Server::set_settings}};
  return all;
}

Server::Person& Server::person(const std::string& secret) {
  if (persons_.size() >= max_persons && !persons_.contains(secret))
    std::erase_if(persons_, [this](const auto& each) {
      return !each.second.is_paired && !has_client(each.first);
    });
  return persons_[secret];
}

void Server::login(const Call& call) {
  const auto client = clients_.find(call.client);
  if (client == clients_.end())
    throw Error(Exit::bad_input, "login", "is for WebSockets", "send the token in a header");
  if (!is_token(call.parameters()["token"].get<std::string>())) {
    if (logins_->has_password())
      fail(call, code::needs_password, "log in with the password");
    else
      fail(call, Refusal(Exit::bad_input, "wrong-token"));
    return web_->drop(call.client);
  }
  client->second.secret = call.parameters()["client"];
  Person& caller = person(client->second.secret);
  caller.name = call.parameters().value("name", std::string("a client"));
  succeed(call, {{"version", version()},
                 {"board", options_.board},
                 {"simulated", options_.is_simulated},
                 {"paired", options_.is_simulated || caller.is_paired}});
}

void Server::pair(const Call& call) {
  if (options_.code.empty() || wrong_codes_ >= max_wrong_codes)
    throw Refusal(Exit::job_failed, "no-pairing");
  if (call.secret.empty())
    throw Error(Exit::bad_input, "pair", "the request has no client", "send one (docs/api.md)");
  if (!is_same_secret(call.parameters()["code"].get<std::string>(), options_.code)) {
    ++wrong_codes_;
    throw Refusal(Exit::job_failed, "wrong-code",
                  {{"tries", fmt::format("{}", max_wrong_codes - wrong_codes_)}});
  }
  person(call.secret).is_paired = true;
  succeed(call, nullptr);
}

void Server::send_status(const Call& call) { succeed(call, status()); }

void Server::subscribe(const Call& call) {
  const auto client = clients_.find(call.client);
  if (client == clients_.end())
    throw Error(Exit::bad_input, "subscribe", "is for WebSockets", "ask for the status instead");
  client->second.is_subscribed = true;
  client->second.sent = std::make_shared<const Json>(status());
  succeed(call, *client->second.sent);
}

void Server::take_control(const Call& call) {
  if (call.secret.empty())
    throw Error(Exit::bad_input, "control", "the request has no client", "send one (docs/api.md)");
  if (holder_ != call.secret) machine_->stop_jog();
  holder_ = call.secret;
  succeed(call, nullptr);
}

void Server::release_control(const Call& call) {
  machine_->stop_jog();
  holder_.clear();
  succeed(call, nullptr);
}

void Server::stop(const Call& call) {
  machine_->stop();
  succeed(call, nullptr);
}

void Server::hold(const Call& call) {
  machine_->hold();
  succeed(call, nullptr);
}

void Server::resume(const Call& call) {
  machine_->resume();
  succeed(call, nullptr);
}

void Server::change_feed(const Call& call) {
  machine_->change_feed(word_of(call.parameters()["change"]));
  succeed(call, nullptr);
}

void Server::home(const Call& call) {
  machine_->send_line("$H");
  succeed(call, nullptr);
}

void Server::unlock(const Call& call) {
  machine_->send_line("$X");
  succeed(call, nullptr);
}

void Server::zero(const Call& call) {
  std::string line = "G10L20P0";
  for (const char axis : call.parameters()["axes"].get<std::string>())
    line += fmt::format("{}0", axis);
  machine_->send_line(line);
  succeed(call, nullptr);
}

void Server::list_jobs(const Call& call) {
  Json files = Json::array();
  for (const JobFile& file : folder_.list())
    files.push_back({{"name", file.name}, {"bytes", file.bytes}, {"kind", file.kind}});
  succeed(call, files);
}

void Server::compute(const Call& call, std::function<void()> work, std::function<Json()> result) {
  computations_->add(std::move(work),
                     [this, call, result = std::move(result)](const std::exception_ptr& error) {
                       try {
                         if (error) std::rethrow_exception(error);
                         succeed(call, result());
                       } catch (const std::exception& failure) {
                         fail(call, failure);
                       }
                     });
}

void Server::check_job(const Call& call) {
  const std::string name = call.parameters()["name"];
  const auto result = std::make_shared<Json>();
  compute(
      call,
      [result, path = folder_.path_of(name).string(), revision = folder_.revision_of(name), name,
       machine = options_.machine,
       material = material_choice(call.parameters(), options_.library)] {
        *result = check_file(path, name, machine, material);
        (*result)["revision"] = revision;
      },
      [result] { return *result; });
}

void Server::start_job(const Call& call) {
  JobStart job;
  job.name = call.parameters()["name"];
  job.path = folder_.path_of(job.name).string();
  job.is_dry = call.parameters().value("dry", false);
  job.resumes = call.parameters().value("resume", false);
  if (job.is_dry && job.resumes)
    throw Error(Exit::bad_input, "resume", "a dry run has no progress to continue",
                "leave out resume or dry");
  job.from = call.parameters().value("from", std::size_t{0});
  job.material = material_choice(call.parameters(), options_.library);
  if (const auto revision = call.parameters().find("revision");
      revision != call.parameters().end() && *revision != folder_.revision_of(job.name))
    throw Refusal(Exit::job_failed, "file-changed", {{"job", job.name}});
  machine_->start(job);
  succeed(call, nullptr);
}

void Server::delete_job(const Call& call) {
  const std::string name = call.parameters()["name"];
  const JobView job = machine_->view().job;
  if (job.is_running && job.name == name)
    throw Refusal(Exit::job_failed, "job-runs", {{"job", name}});
  folder_.remove(name);
  succeed(call, nullptr);
}

void Server::send_line(const Call& call) {
  const std::string line =
      link::line_to_send(call.parameters()["line"].get<std::string>(), "console", "remove it");
  if (line.empty()) throw Refusal(Exit::bad_input, "empty-line");
  machine_->send_line(line);
  succeed(call, nullptr);
}

void Server::send_lines(const Call& call) {
  Json lines = Json::array();
  for (const ConsoleLine& line :
       machine_->lines_after(call.parameters().value("after", std::uint64_t{0})))
    lines.push_back({{"number", line.number}, {"text", line.text}});
  succeed(call, lines);
}

std::chrono::milliseconds Server::lease_of(const Call& call) const {
  const std::int64_t age_ms = time_ms() - call.parameters()["seen"].get<std::int64_t>();
  const auto lease = max_age - std::chrono::milliseconds(std::max<std::int64_t>(age_ms, 0));
  if (lease.count() <= 0) throw Refusal(Exit::job_failed, "late-jog");
  return lease;
}

void Server::run_jog(const Call& call) {
  const auto lease = lease_of(call);
  pendant::Direction direction{};
  std::size_t axis = 0;
  for (const Json& sign : call.parameters()["direction"]) direction[axis++] = sign;
  machine_->run_jog(direction, call.parameters()["feed"], lease);
  succeed(call, nullptr);
}

void Server::go_jog(const Call& call) {
  constexpr std::array names{"x", "y", "z"};
  Place place{};
  for (std::size_t axis = 0; axis < names.size(); ++axis)
    if (const auto given = call.parameters().find(names[axis]); given != call.parameters().end())
      place[axis] = given->get<double>();
  machine_->go_to(place, call.parameters()["feed"], lease_of(call));
  succeed(call, nullptr);
}

void Server::renew_jog(const Call& call) {
  machine_->renew_jog(lease_of(call));
  succeed(call, nullptr);
}

void Server::step_jog(const Call& call) {
  machine_->step_jog(call.parameters()["axis"], call.parameters()["mm"], call.parameters()["feed"]);
  succeed(call, nullptr);
}

void Server::stop_jog(const Call& call) {
  machine_->stop_jog();
  if (call.secret == holder_)
    machine_->release_jog();
  else
    machine_->bar_jog();
  succeed(call, nullptr);
}

void Server::get_settings(const Call& call) {
  const auto rows = std::make_shared<Json>();
  machine_->post([rows](link::LinePort& port) { *rows = settings_json(link::read_settings(port)); },
                 [this, call, rows](const std::exception_ptr& error) {
                   web_->post([this, call, rows, error] { finish_work(call, *rows, error); });
                 });
}

void Server::set_settings(const Call& call) {
  const auto made = std::make_shared<Json>(Json::object());
  machine_->post(
      [made, wanted = changes_of(call.parameters()["changes"])](link::LinePort& port) {
        const link::BoardSettings before = link::read_settings(port);
        const auto changes = link::differing(before, wanted);
        const link::BoardSettings after = link::change_settings(port, before, changes);
        for (const link::Change& change : changes)
          (*made)[link::setting_name(change.number)] = after.texts.at(change.number);
      },
      [this, call, made](const std::exception_ptr& error) {
        web_->post([this, call, made, error] { finish_work(call, *made, error); });
      });
}

void Server::finish_work(const Call& call, const Json& result, const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
    succeed(call, result);
  } catch (const std::exception& failure) {
    fail(call, failure);
  }
}

}  // namespace lamplock::serve
