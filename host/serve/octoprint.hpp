// A subset of the REST of OctoPrint, so that slicers can send programs to a machine ("REST API" in
// the documentation of OctoPrint): version, login, files/local, job, printer, printer/command.
//
// In:  requests with the key in X-Api-Key. Out: replies; files in the folder; requests to the
//      machine. Who: the server, if it was started with a key.
//
// A form of a foreign page can send multipart/form-data, but not the header with the key.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/serve/job_folder.hpp"
#include "host/serve/web_server.hpp"

namespace lamplock::serve {

class Machine;
struct MachineView;

class OctoPrint {
 public:
  /// `require_right` throws Error if such a program may not run the machine now.
  OctoPrint(std::string key, JobFolder folder, std::function<void()> require_right);

  /// It answers this target.
  static bool has(const std::string& target);
  /// Before the body is read; Host and Origin have been checked.
  Admission admit(const WebRequest& head, std::size_t max_file_bytes) const;
  WebReply reply(const WebRequest& request, Machine& machine);

 private:
  WebReply get(const std::string& path, const MachineView& view) const;
  WebReply post(const std::string& path, const WebRequest& request, Machine& machine);
  WebReply take_file(const WebRequest& request, Machine& machine);
  WebReply take_file_command(const std::string& name, const nlohmann::json& command,
                             Machine& machine);
  void take_job_command(const nlohmann::json& command, Machine& machine);
  void select(const std::string& name, bool starts, Machine& machine);
  void start(Machine& machine) const;

  std::string key_;
  JobFolder folder_;
  std::function<void()> require_right_;
  std::string selected_;  ///< file that a start runs
};

}  // namespace lamplock::serve
