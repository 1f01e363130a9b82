// The site of the web server: clients, control, methods, notifications.
//
// In:  requests and messages of clients, the machine. Out: replies; status as differences (JSON
//      merge patch, RFC 7396); lines of the console.
// Who: serve(). All functions run in the thread of the web server.
//
// A client that has not taken the last notification gets the next one later, with all that differs
// then: notifications do not queue up. Answers do, and a full queue drops the client.
#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "host/run/machine_options.hpp"
#include "host/serve/access.hpp"
#include "host/serve/clock.hpp"
#include "host/serve/job_folder.hpp"
#include "host/serve/note.hpp"
#include "host/serve/page_texts.hpp"
#include "host/serve/reports.hpp"
#include "host/serve/web_server.hpp"

namespace lamplock::serve {

class Camera;
class Clouds;
class Computations;
class History;
class Logins;
class Machine;
class OctoPrint;
struct Method;
struct PageDocument;
class RunningJob;

struct SiteOptions {
  std::string board;
  bool is_simulated = true;
  std::string token;
  std::string code;           ///< for pairing; empty: no client can be paired
  std::string password_hash;  ///< empty: the token alone
  std::optional<PublicOrigin> proxy{};
  std::string octoprint_key{};  ///< empty: no REST of OctoPrint
  std::string camera{};         ///< source of its pictures (camera.hpp); empty: none
  std::string library{};        ///< file with materials and history; empty: the user's own
  run::MachineOptions machine;
  PageTexts texts = english_texts();
  Now now = Clock::now;
  Note note = [](const std::string&) {};  ///< for the log
};

class Server final : public WebSite {
 public:
  Server(SiteOptions options, JobFolder folder);
  ~Server() override;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// To be called once, before the web server runs. The machine must end before the web server.
  void use(WebServer& web, Machine& machine);
  /// To be called after the web server has run and the machine has ended: drops calls that are not
  /// answered.
  void end();
  /// To be called regularly: sends what differs.
  void tick();

  Admission admit(const WebRequest& head) override;
  void reply(WebRequest request, Answer answer) override;
  void opened(ClientNumber client) override;
  void received(ClientNumber client, const std::string& text) override;
  void closed(ClientNumber client) override;

 private:
  using Json = nlohmann::json;
  using Respond = std::function<void(const std::string&)>;

  /// A request that a client may send again.
  struct Answered {
    std::size_t request = 0;  ///< hash of its text
    std::string answer;       ///< empty while the server works on it
  };
  /// A user of one or several connections, known by the secret of the client.
  struct Person {
    std::string name;
    bool is_paired = false;
    std::map<std::string, Answered> answers;  ///< by id
    std::deque<std::string> ids;              ///< oldest first
  };
  struct Client {
    Clock::time_point opened_at{};
    std::string secret;  ///< empty before the login
    bool is_subscribed = false;
    std::shared_ptr<const Json> sent{};  ///< status that it knows
    std::uint64_t line = 0;              ///< of the console, that it knows
    Clock::time_point told_at{};
  };
  struct Call {
    ClientNumber client = 0;  ///< 0: HTTP
    std::string secret;
    std::string id;                       ///< as JSON
    std::size_t request = 0;              ///< hash of its text
    std::shared_ptr<const Json> given{};  ///< parameters
    const Json& parameters() const { return *given; }
    Respond respond;
  };
  using Handler = void (Server::*)(const Call&);

  static const std::map<std::string_view, Handler>& handlers();
  void take_request(const std::string& text, Call call);
  void call_method(const Method& method, const Call& call);
  void require_program_right() const;
  void check_right(const Method& method, const Call& call) const;
  bool keeps_dark(const Method& method, const Call& call) const;
  void succeed(const Call& call, const Json& result);
  void fail(const Call& call, int code, const std::string& message);
  void fail(const Call& call, const std::exception& error);
  void fail(const Call& call, const Json& error);
  void finish(const Call& call, const Json& response);
  bool was_called(const Call& call);
  Person& person(const std::string& secret);
  bool has_client(const std::string& secret) const;
  bool is_token(std::string_view token);
  bool is_permitted(const WebRequest& head);
  std::optional<WebReply> refusal_of_names(const WebRequest& head) const;
  WebReply take_file(const WebRequest& request);
  Json status() const;
  std::int64_t time_ms() const;
  void notify(ClientNumber number, Client& client, const Json& now);
  /// Calls a method outside of this thread; `result` makes its result, in this thread.
  void compute(const Call& call, std::function<void()> work, std::function<Json()> result);
  void finish_work(const Call& call, const Json& result, const std::exception_ptr& error);

  void login(const Call& call);
  void pair(const Call& call);
  void send_status(const Call& call);
  void subscribe(const Call& call);
  void take_control(const Call& call);
  void release_control(const Call& call);
  void stop(const Call& call);
  void hold(const Call& call);
  void resume(const Call& call);
  void change_feed(const Call& call);
  void home(const Call& call);
  void unlock(const Call& call);
  void zero(const Call& call);
  void send_area(const Call& call);
  void list_jobs(const Call& call);
  void check_job(const Call& call);
  void start_job(const Call& call);
  void delete_job(const Call& call);
  void send_line(const Call& call);
  void send_lines(const Call& call);
  void list_macros(const Call& call);
  void set_macro(const Call& call);
  void remove_macro(const Call& call);
  void run_macro(const Call& call);
  void list_history(const Call& call);
  WebReply report_of(const std::string& name) const;
  void list_materials(const Call& call);
  void get_camera(const Call& call);
  void calibrate_camera(const Call& call);
  WebReply camera_picture() const;
  void run_jog(const Call& call);
  void step_jog(const Call& call);
  void go_jog(const Call& call);
  void renew_jog(const Call& call);
  std::chrono::milliseconds lease_of(const Call& call) const;
  void stop_jog(const Call& call);
  geometry::Bounds area() const;
  void open_path(const Call& call);
  void open_cloud(const Call& call);
  void send_cloud_points(const Call& call);
  void find_near_points(const Call& call);
  void open_scene(const Call& call);
  void write_scene(const Call& call);
  void make_job(const Call& call);
  void get_settings(const Call& call);
  void set_settings(const Call& call);

  SiteOptions options_;
  JobFolder folder_;
  Reports reports_;
  std::unique_ptr<PageDocument> document_;
  std::unique_ptr<Logins> logins_;
  std::unique_ptr<Computations> computations_;
  std::unique_ptr<Clouds> clouds_;
  std::unique_ptr<History> history_;
  std::unique_ptr<RunningJob> running_job_;
  std::unique_ptr<Camera> camera_;        ///< null: none
  std::unique_ptr<OctoPrint> octoprint_;  ///< null: not served
  Machine* machine_ = nullptr;
  WebServer* web_ = nullptr;
  std::map<ClientNumber, Client> clients_;
  std::map<std::string, Person> persons_;
  std::string holder_;  ///< secret of the client that holds control; empty: none
  int wrong_codes_ = 0;
  Clock::time_point begun_at_ = options_.now();
};

}  // namespace lamplock::serve
