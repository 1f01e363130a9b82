// Objects in a block, as a page places them: a description of a job (host/glass/description.hpp).
//
// In:  descriptions and models of the folder of the server. Out: what a page draws of each object;
//      descriptions with other places; jobs.
// Who: the methods scene.* and job.make, outside of the thread of the server.
//
// A description may name files of the same folder only: a client must not read others.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/glass/description.hpp"
#include "host/serve/cloud.hpp"
#include "host/serve/job_folder.hpp"
#include "host/serve/placement.hpp"

namespace lamplock::serve {

/// An object before its placement: about the middle of the block.
struct SceneObject {
  std::string file;  ///< name in the folder
  std::optional<double> size_mm{};
  PlacedWords words{};
  std::shared_ptr<const Cloud> cloud{};  ///< not its final points: a few, to draw it
};

struct Scene {
  std::vector<SceneObject> objects{};
  std::optional<geometry::Bounds> block{};
  geometry::Bounds area{};   ///< travel of the focus
  geometry::Point middle{};  ///< objects are turned, scaled and mirrored about it
};

/// The description of a file: a model has one object. `profile`: machine of descriptions that name
/// none. Throws Error(bad_input), also for files outside of the folder.
glass::Description own_description(const JobFolder& folder, const std::string& name,
                                   const std::string& profile);

/// What a page draws. Throws Error(bad_input).
Scene open_scene(const glass::Description& description);

/// Replaces objects and block by those of a page (docs/api.md). Throws Error(bad_input).
void place_objects(const JobFolder& folder, glass::Description& description,
                   const nlohmann::json& objects, const nlohmann::json& block);

/// Writes a description into the folder, whole or not at all, after it was read back.
/// Throws Error(bad_input).
void write_scene(const JobFolder& folder, const std::string& name,
                 const glass::Description& description);

}  // namespace lamplock::serve
