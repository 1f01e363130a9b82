// LinuxCNC's interpreter rs274 as a second opinion on programs.
//
// In:  programs, each a list of lines; they run in one process, each from the same modal state.
// Out: for each line the moves of its canonical commands, in machine coordinates, or its refusal.
// The program and its libraries are unpacked by toolchain/setup, not installed; without them
// available() is false and the tests are skipped.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::program::test {

/// A canonical command that moves or waits.
struct CanonicalMove {
  enum class Kind { rapid, feed, arc, curve, dwell };
  Kind kind = Kind::rapid;
  std::array<double, 4> to_mm{};      ///< machine coordinates
  std::array<double, 2> centre_mm{};  ///< of an arc, in its plane, machine coordinates
  int turns = 0;                      ///< of an arc; negative: clockwise
  int plane = 0;                      ///< of an arc: 0 XY, 1 XZ, 2 YZ
  double seconds = 0;                 ///< of a dwell
};

struct CanonicalLine {
  std::vector<CanonicalMove> moves{};
  std::string refusal{};  ///< empty if the line ran
};

class Rs274 {
 public:
  using Program = std::vector<std::string>;

  /// `tools`: numbers of the tools in its table, without lengths and diameters.
  explicit Rs274(std::vector<int> tools = {}) : tool_numbers_(std::move(tools)) {}

  static bool available() { return std::filesystem::exists(binary()); }

  /// Runs one program with O-words, which have no line numbers; all its moves, and the last error.
  CanonicalLine run_whole(const Program& program) {
    write_tools();
    std::ofstream file(folder_.file("program"));
    for (const std::string& line : program) file << line << "\n";
    file << "M2\n";
    file.close();
    lines_.clear();
    read();
    CanonicalLine all;
    for (auto& [number, line] : lines_) {
      all.moves.insert(all.moves.end(), line.moves.begin(), line.moves.end());
      if (!line.refusal.empty()) all.refusal = line.refusal;
    }
    return all;
  }

  /// Runs the programs; the result has a list of lines for each.
  std::vector<std::vector<CanonicalLine>> run(const std::vector<Program>& programs,
                                              std::string_view reset) {
    write(programs, reset);
    lines_.clear();
    read();
    std::vector<std::vector<CanonicalLine>> results;
    int number = 0;
    for (const Program& program : programs) {
      ++number;  // of the line that resets
      auto& result = results.emplace_back();
      for (std::size_t i = 0; i < program.size(); ++i) result.push_back(lines_[++number]);
    }
    return results;
  }

 private:
  static std::filesystem::path root() { return lamplock::test::in_repository("build/rs274"); }
  static std::filesystem::path binary() { return root() / "usr/bin/rs274"; }

  void write_tools() const {
    std::ofstream tools(folder_.file("tools"));
    for (const int number : tool_numbers_) tools << fmt::format("T{0} P{0} Z0 D0\n", number);
  }

  void write(const std::vector<Program>& programs, std::string_view reset) const {
    write_tools();
    std::ofstream file(folder_.file("program"));
    int number = 0;
    for (const Program& program : programs) {
      file << fmt::format("N{} {}\n", ++number, reset);
      for (const std::string& line : program) file << fmt::format("N{} {}\n", ++number, line);
    }
    file << "M2\n";
  }

  void read() {
    const std::string library = (root() / "usr/lib").string();
    // Mode 0 continues after a line with an error. rs274 maps $HOME/.tool.mmap into its memory and
    // truncates that file when it begins: two that share a home end each other with SIGBUS.
    const std::string command = fmt::format(
        "HOME={4} LD_LIBRARY_PATH={0}:{0}/x86_64-linux-gnu timeout 60 {1} -t {2} -n 0 -g {3} 2>&1",
        library, binary().string(), folder_.file("tools").string(),
        folder_.file("program").string(), folder_.file("").string());
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    std::array<char, 1024> text{};
    std::string message;
    while (std::fgets(text.data(), static_cast<int>(text.size()), pipe) != nullptr) {
      std::string line(text.data());
      while (!line.empty() && line.back() == '\n') line.pop_back();
      int number = 0;
      // "   12 N7     STRAIGHT_FEED(...)"; an error is its text, then the line of the program.
      if (std::sscanf(line.c_str(), "%*d N%d", &number) == 1 ||
          line.find(" N..... ") != std::string::npos) {
        add(number, line.substr(std::min<std::size_t>(line.find('N') + 7, line.size())));
      } else if (std::sscanf(line.c_str(), "N%d", &number) == 1) {
        lines_[number].refusal = message;
      } else {
        message = line;
      }
    }
    if (const int status = ::pclose(pipe); status != 0)
      throw std::runtime_error(fmt::format("rs274 ended with wait status {}", status));
  }

  void add(int number, const std::string& command) {
    std::array<double, 9> v{};
    const std::size_t open = command.find('(');
    const std::string name = command.substr(0, open);
    if (name == "USE_LENGTH_UNITS") {
      unit_mm_ = command.find("INCH") != std::string::npos ? 25.4 : 1;
      return;
    }
    if (name == "SELECT_PLANE") {
      plane_ = command.find("XY") != std::string::npos   ? 0
               : command.find("XZ") != std::string::npos ? 1
                                                         : 2;
      return;
    }
    numbers(command.substr(open), v);
    if (name == "SET_G5X_OFFSET") keep(system_, &v[1]);
    if (name == "SET_XY_ROTATION") rotation_ = v[0] / 180 * std::numbers::pi;
    if (name == "SET_G92_OFFSET") keep(shift_, &v[0]);
    if (name == "USE_TOOL_LENGTH_OFFSET") keep(tool_, &v[0]);
    std::vector<CanonicalMove>& moves = lines_[number].moves;
    if (name == "STRAIGHT_TRAVERSE") moves.push_back(straight(CanonicalMove::Kind::rapid, v));
    if (name == "STRAIGHT_FEED") moves.push_back(straight(CanonicalMove::Kind::feed, v));
    if (name == "ARC_FEED") moves.push_back(arc(v));
    if (name == "NURBS_FEED") moves.push_back({.kind = CanonicalMove::Kind::curve});
    if (name == "DWELL") moves.push_back({.kind = CanonicalMove::Kind::dwell, .seconds = v[0]});
  }

  static void numbers(const std::string& text, std::array<double, 9>& values) {
    const char* at = text.c_str();
    for (double& value : values) {
      while (*at != '\0' && std::string_view("(, ").find(*at) != std::string_view::npos) ++at;
      char* end = nullptr;
      value = std::strtod(at, &end);
      at = end;
    }
  }

  void keep(std::array<double, 3>& offset, const double* values) const {
    for (std::size_t i = 0; i < 3; ++i) offset[i] = values[i] * unit_mm_;
  }
  double offset(std::size_t axis) const { return system_[axis] + shift_[axis] + tool_[axis]; }
  /// X and Y, round the origin of the coordinate system.
  template <class Pair>
  void turn(Pair& place) const {
    const double x = place[0] - system_[0], y = place[1] - system_[1];
    place[0] = system_[0] + x * std::cos(rotation_) - y * std::sin(rotation_);
    place[1] = system_[1] + x * std::sin(rotation_) + y * std::cos(rotation_);
  }

  CanonicalMove straight(CanonicalMove::Kind kind, const std::array<double, 9>& v) const {
    CanonicalMove move{.kind = kind};
    for (std::size_t i = 0; i < 3; ++i) move.to_mm[i] = v[i] * unit_mm_ + offset(i);
    turn(move.to_mm);
    return move;
  }
  /// ARC_FEED(first end, second end, first centre, second centre, turns, normal end, ...).
  CanonicalMove arc(const std::array<double, 9>& v) const {
    static constexpr std::size_t axes[3][3] = {{0, 1, 2}, {2, 0, 1}, {1, 2, 0}};
    const auto& [first, second, normal] = axes[plane_];
    CanonicalMove move{.kind = CanonicalMove::Kind::arc};
    move.to_mm[first] = v[0] * unit_mm_ + offset(first);
    move.to_mm[second] = v[1] * unit_mm_ + offset(second);
    move.to_mm[normal] = v[5] * unit_mm_ + offset(normal);
    move.centre_mm = {v[2] * unit_mm_ + offset(first), v[3] * unit_mm_ + offset(second)};
    move.turns = static_cast<int>(v[4]);
    move.plane = plane_;
    turn(move.to_mm);
    if (plane_ == 0) turn(move.centre_mm);
    return move;
  }

  const std::vector<int> tool_numbers_;
  lamplock::test::TemporaryFolder folder_;
  std::map<int, CanonicalLine> lines_;
  std::array<double, 3> system_{}, shift_{}, tool_{};
  double rotation_ = 0;  ///< of the coordinate system, radians
  double unit_mm_ = 1;
  int plane_ = 0;
};

}  // namespace lamplock::program::test
