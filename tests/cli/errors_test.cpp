// Broken input: one line, status 2, nothing written.
#include <gmock/gmock.h>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

/// A run that must fail on its input and leave the folder as it was.
void expect_refused(const Folder& folder, const std::vector<std::string>& arguments,
                    const std::string& names) {
  const auto before = folder.files();
  const Finished refused = run(arguments);
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_THAT(refused.err,
              testing::MatchesRegex("(warning  [^\n]+\n)?error: [^\n]+: [^\n]+; [^\n]+\n"));
  EXPECT_THAT(refused.err, testing::HasSubstr(names));
  EXPECT_EQ(folder.files(), before);
}

/// The same for every command that reads an input.
void expect_input_refused(const Folder& folder, const std::string& input,
                          const std::string& names) {
  expect_refused(folder, {"engrave", input, "--report", folder / "report"}, names);
  expect_refused(folder, {"points", input, "-o", folder / "out.xyz"}, names);
  expect_refused(folder, {"job", input, "-o", folder / "out.llj"}, names);
  expect_refused(folder, {"frame", input}, names);
}

TEST(Errors, missing_and_unknown_files) {
  const Folder folder;
  expect_input_refused(folder, folder / "none.stl", "none.stl");
  expect_input_refused(folder, folder.write("a.doc", "text"), "a.doc");
}

TEST(Errors, folders_and_devices_are_no_inputs) {
  const Folder folder;
  for (const std::string& input : {folder.path().string(), std::string("/dev/null")}) {
    const std::string names = input + ": not a file; give a file, not a folder or device";
    expect_input_refused(folder, input, names);
    expect_refused(folder, {"estimate", input}, names);
    expect_refused(folder, {"order", input, "-o", folder / "out.xyz"}, names);
    expect_refused(folder, {"raster", input, "--feed", "600", "--gcode", folder / "out.ngc"},
                   names);
    expect_refused(folder, {"cut", input, "--list"}, names);
    expect_refused(folder, {"check", input}, names);
    expect_refused(folder, {"diagnose", input}, names);
    expect_refused(folder, {"jerk", input}, names);
    expect_refused(folder, {"send", input}, names);
  }
}

TEST(Errors, input_without_points) {
  const Folder folder;
  std::string white = disc_bmp(8);
  for (std::size_t i = 54; i < white.size(); ++i) white[i] = '\xff';
  expect_input_refused(folder, folder.write("white.bmp", white), "gives no points");
}

TEST(Errors, truncated_mesh) {
  const Folder folder;
  const std::string stl = octahedron_stl();
  expect_input_refused(folder, folder.write("cut.stl", stl.substr(0, stl.size() / 2)), "cut.stl");
}

TEST(Errors, mesh_with_nan) {
  const Folder folder;
  std::string stl = octahedron_stl();
  stl.replace(stl.find("vertex 1 0 0"), 12, "vertex nan 0 0");
  expect_input_refused(folder, folder.write("nan.stl", stl), "nan.stl");
}

TEST(Errors, empty_mesh) {
  const Folder folder;
  expect_input_refused(folder, folder.write("empty.stl", "solid nothing\nendsolid nothing\n"),
                       "empty.stl");
  expect_input_refused(folder, folder.write("zero.stl", ""), "zero.stl");
}

TEST(Errors, broken_bitmap) {
  const Folder folder;
  expect_input_refused(folder, folder.write("cut.bmp", disc_bmp(20).substr(0, 200)), "cut.bmp");
}

TEST(Errors, points_outside_the_work_space) {
  const Folder folder;
  expect_input_refused(folder, folder.write("far.xyz", "0 0 0\n0 0 51\n"), "far.xyz");
}

TEST(Errors, points_that_are_not_numbers) {
  const Folder folder;
  expect_input_refused(folder, folder.write("bad.xyz", "0 0 0\n0 nan 1\n"), "bad.xyz");
  expect_input_refused(folder, folder.write("word.xyz", "0 0 zero\n"), "word.xyz");
}

TEST(Errors, an_object_that_is_too_large_gets_the_size_that_fits) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  expect_refused(folder, {"engrave", mesh, "--size", "120"}, "--size 100");
}

TEST(Errors, options_out_of_range) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  expect_refused(folder, {"engrave", mesh, "--spacing", "0"}, "spacing");
  expect_refused(folder, {"engrave", mesh, "--spacing", "nan"}, "spacing");
  expect_refused(folder, {"engrave", mesh, "--size", "-3"}, "size");
  expect_refused(folder, {"engrave", mesh, "--lamp", "0"}, "--lamp");
  expect_refused(folder, {"engrave", mesh, "--accel", "inf"}, "--accel");
  expect_refused(folder, {"engrave", mesh, "--dropouts", "250"}, "--dropouts");
  expect_refused(folder, {"engrave", mesh, "--from", "1000000"}, "--from 1000000");
  expect_refused(folder, {"engrave", mesh, "--flashes", "0"}, "--flashes");
  expect_refused(folder, {"engrave", mesh, "--flashes", "256"}, "--flashes");
  expect_refused(folder, {"engrave", mesh, "--job-speed", "0"}, "--job-speed");
  expect_refused(folder, {"engrave", mesh, "--job-speed", "141"}, "--job-speed");
  expect_refused(folder, {"engrave", mesh, "--flashes", "3", "--from", "0", "--fired", "3"},
                 "--fired 3");
}

TEST(Errors, results_that_cannot_be_written_are_reported_first) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  expect_refused(folder, {"points", mesh, "-o", folder / "none/out.xyz"}, "none/out.xyz");
  expect_refused(folder, {"points", mesh, "-o", folder / "out.jpg"}, "out.jpg");
  expect_refused(folder, {"engrave", mesh, "--vcd", folder / "none/a.vcd"}, "none/a.vcd");
  expect_refused(folder, {"engrave", mesh, "--report", mesh}, "m.stl");
}

TEST(Errors, broken_profile) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const auto refused = [&](const std::string& text, const std::string& names) {
    const std::string profile = folder.write("machine.toml", text);
    expect_refused(folder, {"engrave", mesh, "--machine", profile}, names);
  };
  refused("name = \"m\"\nacelleration = [1, 2, 3]\n", "machine.toml:2");
  refused("axes = 9\n", "axes");
  refused("axes = \n", "machine.toml:1");
  expect_refused(folder, {"engrave", mesh, "--machine", folder / "none.toml"}, "none.toml");
}

TEST(Errors, broken_job_files) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(50, 1)));
  const std::string job = folder / "good.llj";
  ASSERT_EQ(run({"job", list, "-o", job}).status, 0);
  const std::string bytes = read(job);
  std::string flipped = bytes;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 4);
  for (const std::string& broken :
       {bytes.substr(0, bytes.size() - 3), bytes.substr(0, 5), flipped, std::string("text")}) {
    const std::string file = folder.write("broken.llj", broken);
    expect_refused(folder, {"send", file}, "broken.llj");
    expect_refused(folder, {"job", "--show", file}, "broken.llj");
  }
}

TEST(Errors, invalid_reports) {
  const Folder folder;
  expect_refused(folder, {"compare", folder.path().string(), folder.path().string()},
                 "has no report of lamplock (report.json); give a folder written with --report");
  folder.write("report.json", "{\"version\": 3}");
  const std::string here = folder.path().string();
  expect_refused(folder, {"compare", here, here}, "report.json");
  folder.write("report.json", "{");
  expect_refused(folder, {"compare", here, here}, "report.json");
  expect_refused(folder, {"compare", folder / "none", here}, "none");
}

TEST(Errors, only_the_virtual_board_has_faults_and_traces) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(5, 1)));
  const std::string port = folder / "port";
  expect_refused(folder, {"engrave", list, "--board", port, "--yes", "--jitter", "5"}, "--jitter");
  expect_refused(folder, {"engrave", list, "--board", port, "--yes", "--vcd", folder / "a.vcd"},
                 "--vcd");
  const std::string job = folder / "p.llj";
  ASSERT_EQ(run({"job", list, "-o", job}).status, 0);
  expect_refused(folder, {"send", job, "--board", port, "--yes", "--shots", folder / "a.csv"},
                 "--shots");
  expect_refused(folder, {"engrave", list, "--usb", "stream"}, "--usb stream");
}

}  // namespace
}  // namespace lamplock::cli::test
