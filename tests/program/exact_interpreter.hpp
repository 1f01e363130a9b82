// An independent interpreter in exact rational numbers: the position of a program of valid lines
// after each line.
//
// Written from the documents cited by the firmware's interpreter, not from its code: other parsing,
// another order of execution (everything is a map of words), no rounding. It has no errors and no
// actions, only positions.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cctype>
#include <map>
#include <set>
#include <string>

namespace lamplock::program::test {

class ExactInterpreter {
 public:
  using Rational = boost::multiprecision::cpp_rational;
  using Point = std::array<Rational, 4>;

  /// Millimetres, machine coordinates.
  const Point& position() const { return position_; }

  void run(const std::string& line) {
    read(line);
    const Point before = position_;
    modes();
    if (has("G43.1")) tool_length_ = word('Z');
    if (has("G49")) tool_length_ = 0;
    if (has("G10")) return set_system();
    if (has("G92")) return shift();
    if (has("G92.1")) shift_ = stored_shift_ = {};
    if (has("G92.2")) shift_ = {};
    if (has("G92.3")) shift_ = stored_shift_;
    if (has("G28.1")) home_[0] = position_;
    if (has("G30.1")) home_[1] = position_;
    if (has("G28")) return go_home(home_[0]);
    if (has("G30")) return go_home(home_[1]);
    if (has("G43.1")) return;
    if (motion_ == "G81" || motion_ == "G82" || motion_ == "G83" || motion_ == "G73")
      drill();
    else
      position_ = target();
    const bool drills = motion_ > "G7" && motion_ != "G80" && axis_words();
    if (drills)
      series_ = true;
    else if (before != position_ || axis_words())
      series_ = false;
  }

 private:
  static constexpr const char* letters = "XYZA";

  void read(const std::string& line) {
    words_.clear();
    codes_.clear();
    std::size_t i = 0;
    while (i < line.size()) {
      if (line[i] == ' ') {
        ++i;
        continue;
      }
      const char letter = line[i++];
      std::string text;
      while (i < line.size() && (std::isdigit(static_cast<unsigned char>(line[i])) != 0 ||
                                 line[i] == '.' || line[i] == '-'))
        text += line[i++];
      if (letter == 'G' || letter == 'M')
        codes_.insert(letter + text);
      else
        words_[letter] = number(text);
    }
  }

  static Rational number(std::string text) {
    const bool negative = text[0] == '-';
    if (negative) text.erase(0, 1);
    const std::size_t point = text.find('.');
    boost::multiprecision::cpp_int unit = 1;
    if (point != std::string::npos) {
      for (std::size_t k = point + 1; k < text.size(); ++k) unit *= 10;
      text.erase(point, 1);
    }
    // A leading zero would make the number octal.
    text.erase(0, std::min(text.find_first_not_of('0'), text.size() - 1));
    Rational value{boost::multiprecision::cpp_int(text)};
    value /= Rational{unit};
    if (negative) value = -value;
    return value;
  }

  bool has(const char* code) const { return codes_.count(code) != 0; }
  bool has(char letter) const { return words_.count(letter) != 0; }
  bool axis_words() const { return has('X') || has('Y') || has('Z') || has('A'); }
  Rational word(char letter) const { return words_.at(letter) * unit_; }

  void modes() {
    if (has("G20")) unit_ = Rational{127} / 5;
    if (has("G21")) unit_ = 1;
    if (has("G90")) relative_ = false;
    if (has("G91")) relative_ = true;
    if (has("G17")) normal_ = 2;
    if (has("G18")) normal_ = 1;
    if (has("G19")) normal_ = 0;
    if (has("G98")) to_initial_ = true;
    if (has("G99")) to_initial_ = false;
    const char* systems[] = {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"};
    for (std::size_t i = 0; i < 9; ++i)
      if (has(systems[i])) system_ = i;
    for (const char* code : {"G0", "G1", "G2", "G3", "G73", "G80", "G81", "G82", "G83"})
      if (has(code)) motion_ = code;
  }

  Rational offset(std::size_t axis) const {
    return systems_[system_][axis] + shift_[axis] + (axis == 2 ? tool_length_ : Rational(0));
  }

  Point target() const {
    Point to = position_;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      if (!has(letters[axis])) continue;
      const Rational value = word(letters[axis]);
      if (has("G53"))
        to[axis] = value;
      else
        to[axis] = relative_ ? position_[axis] + value : offset(axis) + value;
    }
    return to;
  }

  void set_system() {
    const auto p = static_cast<std::size_t>(words_['P'].convert_to<int>());
    const std::size_t row = p == 0 ? system_ : p - 1;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      if (!has(letters[axis])) continue;
      const Rational value = word(letters[axis]);
      systems_[row][axis] = words_['L'] == 2 ? value
                                             : position_[axis] - shift_[axis] -
                                                   (axis == 2 ? tool_length_ : Rational(0)) - value;
    }
  }

  /// Shifts coordinates so that the present position has the given ones.
  void shift() {
    for (std::size_t axis = 0; axis < 4; ++axis)
      if (has(letters[axis])) shift_[axis] += position_[axis] - offset(axis) - word(letters[axis]);
    stored_shift_ = shift_;
  }

  void go_home(const Point& home) {
    const bool all = !axis_words();
    position_ = target();
    for (std::size_t axis = 0; axis < 4; ++axis)
      if (all || has(letters[axis])) position_[axis] = home[axis];
    series_ = false;
  }

  void drill() {
    if (!axis_words()) return;
    if (has('R')) retract_ = word('R');
    const Rational level = position_[normal_];
    if (!series_) initial_ = level;
    const Rational r = relative_ ? initial_ + retract_ : offset(normal_) + retract_;
    const int holes = has('L') ? words_['L'].convert_to<int>() : 1;
    for (int i = 0; i < holes; ++i) {
      Point over = target();
      over[normal_] = position_[normal_];
      position_ = over;
    }
    position_[normal_] = to_initial_ && initial_ > r ? initial_ : r;
  }

  std::map<char, Rational> words_;
  std::set<std::string> codes_;
  Point position_{};
  std::array<Point, 9> systems_{};
  Point shift_{}, stored_shift_{};
  std::array<Point, 2> home_{};
  Rational tool_length_ = 0, unit_ = 1, retract_ = 0, initial_ = 0;
  std::size_t system_ = 0, normal_ = 2;
  std::string motion_ = "G0";
  bool relative_ = false, to_initial_ = true, series_ = false;
};

}  // namespace lamplock::program::test
