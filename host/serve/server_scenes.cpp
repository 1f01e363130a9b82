// The methods scene.* and job.make of the server: objects that a page places in a block.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/error.hpp"
#include "host/geometry/bounds.hpp"
#include "host/job/progress_journal.hpp"
#include "host/run/prepare_job.hpp"
#include "host/serve/clouds.hpp"
#include "host/serve/json_places.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/quiet_frontend.hpp"
#include "host/serve/scene.hpp"
#include "host/serve/server.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

Json scene_json(const Scene& scene, const std::string& name, Clouds& clouds) {
  Json objects = Json::array();
  for (const SceneObject& object : scene.objects) {
    const auto& [mirror, scale, turn, move] = object.words.placement;
    const OpenCloud& open = clouds.add("", object.cloud);
    objects.push_back({{"file", object.file},
                       {"size", object.size_mm ? Json(*object.size_mm) : Json()},
                       {"kept", object.words.kept},
                       {"mirror", mirror},
                       {"scale", scale},
                       {"turn", turn},
                       {"move", move},
                       {"cloud", open.number},
                       {"shown", object.cloud->shown()},
                       {"bounds", box_json(object.cloud->bounds())}});
  }
  return {{"name", name},
          {"objects", std::move(objects)},
          {"block", scene.block ? box_json(*scene.block) : Json()},
          {"area", box_json(scene.area)},
          {"middle", place_json(scene.middle)}};
}

/// Throws if the last run of a job has no known end: another job in its place has no record of
/// the points that are fired.
void refuse_open_run(const JobFolder& folder, const std::string& name) {
  const auto run = job::ProgressJournal(folder.path() / (name + ".progress")).read().run;
  if (run && run->last.progress != job::Progress::ended)
    throw Error(Exit::job_failed, name, "its last run has no known end",
                "continue it, or delete the file, before you make the job again");
}

}  // namespace

void Server::open_scene(const Call& call) {
  const std::string name = call.parameters()["name"];
  folder_.path_of(name);
  const auto scene = std::make_shared<Scene>();
  compute(
      call,
      [scene, name, folder = folder_, profile = options_.machine.machine] {
        *scene = serve::open_scene(own_description(folder, name, profile));
      },
      [this, scene, name] { return scene_json(*scene, name, *clouds_); });
}

void Server::write_scene(const Call& call) {
  const Json& given = call.parameters();
  compute(
      call,
      [given, folder = folder_, profile = options_.machine.machine] {
        const std::string name = given["name"], from = given.value("from", name);
        glass::Description description = own_description(folder, from, profile);
        place_objects(folder, description, given["objects"], given.value("block", Json()));
        serve::write_scene(folder, name, description);
      },
      [] { return Json(); });
}

void Server::make_job(const Call& call) {
  const std::string name = call.parameters()["name"];
  const std::string made = std::filesystem::path(name).replace_extension(".llj").string();
  folder_.check_name(made);
  const JobView running = machine_->view().job;
  if (running.is_running && running.name == made)
    throw Error(Exit::job_failed, made, "the job runs", "wait for its end");
  const auto result = std::make_shared<Json>();
  compute(
      call,
      [result, name, made, folder = folder_, profile = options_.machine.machine] {
        refuse_open_run(folder, made);
        QuietFrontend frontend;
        const run::JobRequest request{folder.path_of(name).string(),
                                      own_description(folder, name, profile)};
        const job::Job job =
            run::make_job_file(request, false, (folder.path() / made).string(), frontend);
        *result = {{"name", made}, {"points", job.size()}, {"notices", frontend.notices()}};
      },
      [result] { return *result; });
}

}  // namespace lamplock::serve
