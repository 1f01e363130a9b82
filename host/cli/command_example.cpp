// `lamplock example`: the model to begin with.
#include <memory>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/model/example.hpp"

namespace lamplock::cli {

void add_example(Command& program) {
  struct ExampleOptions {
    std::string output;
  };
  Command& app = program.add_command("example", "Write the example model: a nautilus, 60 mm");
  app.footer("Example:\n  lamplock example model.stl");
  const auto options = std::make_shared<ExampleOptions>();
  app.add_option("OUTPUT", &options->output, "STL file to write")
      .required()
      .value_name("FILE")
      .file(FileUse::write);
  app.action([options] {
    require_extension(options->output, ".stl", "the example model is written as STL");
    check_target(options->output);
    const model::Mesh mesh = model::example_model();
    write_whole(options->output, [&mesh](const auto& path) { model::write_stl(path, mesh); });
    Console(false).say("{}: {} triangles, 60 mm", options->output, mesh.triangles.size());
    return Exit::done;
  });
}

}  // namespace lamplock::cli
