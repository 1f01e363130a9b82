// The methods cloud.*, path.open and machine.area of the server.
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/error.hpp"
#include "host/job/profile.hpp"
#include "host/run/prepare.hpp"
#include "host/run/read_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/clouds.hpp"
#include "host/serve/json_places.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/material_choice.hpp"
#include "host/serve/read_path.hpp"
#include "host/serve/server.hpp"
#include "host/serve/shown_path.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

geometry::Point point_of(const Json& place) { return {place[0], place[1], place[2]}; }

void put_number(std::string& bytes, std::uint64_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift & 0xff);
}

std::shared_ptr<const Cloud> read_cloud(const std::string& path, const std::string& name) {
  if (run::kind_of_sent_file(path) != run::SentKind::job)
    throw Error(Exit::bad_input, name, "is a G-code program, which has no points",
                "use job.check, which returns its picture");
  return std::make_shared<const Cloud>(run::read_prepared_job(path).points);
}

Json cloud_json(const OpenCloud& open, const geometry::Bounds& area) {
  const Cloud& cloud = *open.cloud;
  return {{"cloud", open.number},
          {"points", cloud.size()},
          {"shown", cloud.shown()},
          {"bounds", box_json(cloud.bounds())},
          {"area", box_json(area)}};
}

}  // namespace

/// Of the machine of the server while the board does not say.
geometry::Bounds Server::area() const {
  return machine_->area().value_or(run::work_space_mm(options_.machine.profile().settings));
}

void Server::send_area(const Call& call) { succeed(call, box_json(area())); }

/// The message begins with two zeros in place of the number of a cloud.
void Server::open_path(const Call& call) {
  if (call.client == 0) throw Error(Exit::bad_input, "path.open", "is for WebSockets", "open one");
  const std::string path = folder_.path_of(call.parameters()["name"]).string();
  const auto made = std::make_shared<std::unique_ptr<const ShownPath>>();
  compute(
      call,
      [made, path, machine = options_.machine,
       material = material_choice(call.parameters(), options_.library)] {
        *made = std::make_unique<const ShownPath>(read_path(path, machine, material));
      },
      [this, made, client = call.client] {
        const ShownPath& shown = **made;
        std::string bytes(2 * sizeof(std::uint32_t), 0);
        if (shown.size() > 0) web_->send_bytes(client, bytes + shown.bytes());
        return Json{{"places", shown.size()},
                    {"bounds", box_json(shown.bounds())},
                    {"area", box_json(area())}};
      });
}

void Server::open_cloud(const Call& call) {
  const std::string name = call.parameters()["name"];
  const std::string path = folder_.path_of(name).string();
  const std::string file = state_of(path);
  if (const OpenCloud* open = clouds_->find_file(file))
    return succeed(call, cloud_json(*open, area()));
  const auto made = std::make_shared<std::shared_ptr<const Cloud>>();
  compute(
      call, [made, path, name] { *made = read_cloud(path, name); },
      [this, made, file] { return cloud_json(clouds_->add(file, *made), area()); });
}

/// The message begins with the number of the cloud and of the first point, 32 bits each.
void Server::send_cloud_points(const Call& call) {
  if (call.client == 0)
    throw Error(Exit::bad_input, "cloud.points", "is for WebSockets", "open one");
  const std::uint64_t number = call.parameters()["cloud"];
  const std::size_t from = call.parameters()["from"];
  const std::string points = clouds_->find(number).cloud->part(from);
  std::string bytes;
  put_number(bytes, number);
  put_number(bytes, from);
  web_->send_bytes(call.client, bytes + points);
  succeed(call, {{"count", points.size() / Cloud::bytes_per_point}});
}

void Server::find_near_points(const Call& call) {
  const Json& given = call.parameters();
  const Sight sight{point_of(given["at"]), point_of(given["along"])};
  if (sight.along == geometry::Point{})
    throw Error(Exit::bad_input, "along", "has no direction", "give a vector other than 0, 0, 0");
  const auto found = std::make_shared<std::vector<NearPoint>>();
  compute(
      call,
      [found, sight, mm = given["mm"].get<double>(), cloud = clouds_->find(given["cloud"]).cloud] {
        *found = cloud->near(sight, mm);
      },
      [found] {
        Json points = Json::array();
        for (const NearPoint& each : *found)
          points.push_back({{"number", each.number}, {"place", place_json(each.place)}});
        return points;
      });
}

}  // namespace lamplock::serve
