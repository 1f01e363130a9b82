// Reads golden runs of programs in the format of tests/board/program_golden/README.txt.
//
// In:  the text of a file. Out: its cases, in order; an invalid line throws with its line number.
// Used by program_golden_test.cpp.
#pragma once

#include <array>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lamplock::test {

using MmPoint = std::array<double, 3>;

/// A line to send and its answer; without text, the end of a pause.
struct GoldenLine {
  std::string text, answer;
  bool resume = false;
};

/// A piece of the path.
struct GoldenWay {
  enum class Kind { line, arc, pass, end };
  Kind kind = Kind::line;
  MmPoint to{};
  std::array<std::size_t, 2> plane{0, 1};  ///< of an arc: first and second axis
  std::array<double, 2> centre{};
  int sense = 1;                  ///< 1 counterclockwise
  int turns = 1;                  ///< turns begun
  std::array<double, 2> light{};  ///< lowest and highest
};

/// A change of a wire by the board, with the position of X, or by the world, with its time.
struct GoldenEdge {
  std::string wire;
  double level = 0;
  double x_or_ms = 0;
};

struct GoldenCase {
  std::string name;
  std::vector<std::string> covers;
  std::vector<GoldenLine> lines;
  std::vector<GoldenWay> ways;
  std::vector<std::string> says;
  std::vector<MmPoint> shots;  ///< in order
  std::vector<GoldenEdge> edges, sets;
  int pin_map = 0;
  bool looks_at_light = false;
  std::optional<double> ms;
  double slack_ms = 0;
};

/// Reads one file.
class GoldenReader {
 public:
  static std::vector<GoldenCase> read(const std::string& text) {
    GoldenReader reader;
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      if (line.empty() || line.front() == '#') continue;
      if (!reader.take(line))
        throw std::runtime_error("line " + std::to_string(number) + ": " + line);
    }
    return reader.cases_;
  }

 private:
  bool take(const std::string& line) {
    std::istringstream words(line);
    std::string what, word;
    words >> what;
    const std::string rest = line.size() > what.size() ? line.substr(what.size() + 1) : "";
    if (what == "case") {
      cases_.emplace_back().name = rest;
      light_ = {};
      return !rest.empty();
    }
    if (cases_.empty()) return false;
    GoldenCase& now = cases_.back();
    if (what == "covers") {
      while (words >> word) now.covers.push_back(word);
      return !now.covers.empty();
    }
    if (what == ">" || what == ">>") return take_line(now, what == ">>", rest);
    if (what == "resume") {
      now.lines.push_back({"", "", true});
      return true;
    }
    if (what == "says") {
      now.says.push_back(rest);
      return true;
    }
    if (what == "light") {
      now.looks_at_light = true;
      return take_light(words);
    }
    if (what == "shot") {
      MmPoint& at = now.shots.emplace_back();
      return static_cast<bool>(words >> at[0] >> at[1] >> at[2]);
    }
    if (what == "time") return take_time(now, words);
    if (what == "map") return static_cast<bool>(words >> now.pin_map);
    if (what == "edge" || what == "set") {
      GoldenEdge& edge = (what == "edge" ? now.edges : now.sets).emplace_back();
      return static_cast<bool>(words >> edge.wire >> edge.level >> edge.x_or_ms);
    }
    return take_way(now, what, words);
  }

  static bool take_line(GoldenCase& now, bool lengthened, const std::string& rest) {
    GoldenLine line{rest, "ok", false};
    const std::size_t answer_at = rest.rfind(" = ");
    if (answer_at != std::string::npos) {
      line.text = rest.substr(0, answer_at);
      line.answer = rest.substr(answer_at + 3);
    }
    if (lengthened) {
      std::istringstream words(line.text);
      std::size_t more = 0;
      if (!(words >> more)) return false;
      line.text = line.text.substr(line.text.find(' ') + 1) + std::string(more, 'x');
    }
    now.lines.push_back(line);
    return true;
  }

  static bool take_time(GoldenCase& now, std::istringstream& words) {
    double ms = 0;
    if (!(words >> ms)) return false;
    now.ms = ms;
    if (!(words >> now.slack_ms)) now.slack_ms = 0.1 + ms * 0.004;
    return true;
  }

  bool take_light(std::istringstream& words) {
    if (!(words >> light_[0])) return false;
    if (!(words >> light_[1])) light_[1] = light_[0];
    return true;
  }

  bool take_way(GoldenCase& now, const std::string& what, std::istringstream& words) const {
    GoldenWay way;
    way.light = light_;
    if (what == "cw" || what == "ccw") {
      way.kind = GoldenWay::Kind::arc;
      way.sense = what == "cw" ? -1 : 1;
      std::string plane;
      if (!(words >> plane >> way.centre[0] >> way.centre[1]) || plane.size() != 2) return false;
      for (std::size_t i = 0; i < 2; ++i) way.plane[i] = static_cast<std::size_t>(plane[i] - 'X');
    } else if (what == "via") {
      way.kind = GoldenWay::Kind::pass;
    } else if (what == "end") {
      way.kind = GoldenWay::Kind::end;
    } else if (what != "to") {
      return false;
    }
    if (!(words >> way.to[0] >> way.to[1] >> way.to[2])) return false;
    words >> way.turns;
    if (words.fail()) way.turns = 1;
    now.ways.push_back(way);
    return true;
  }

  std::vector<GoldenCase> cases_;
  std::array<double, 2> light_{};
};

}  // namespace lamplock::test
