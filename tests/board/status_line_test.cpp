// The status line of a working machine in grbl's format: state, position, speed, switches.

#include "tests/board/board_cable.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

class StatusLine : public testing::Test {
 protected:
  std::string ask() { return user_.status(); }
  static double number_behind(const std::string& line, const std::string& field) {
    const std::size_t at = line.find(field);
    return at == std::string::npos ? -1 : std::stod(line.substr(at + field.size()));
  }
  /// Runs a job and asks one question at each given time.
  void run_job(const std::map<double, std::function<void()>>& questions) {
    job_ = job::make_job(histogram_walk(150, 5), profile_, {});
    BoardCable cable(rig_);
    for (const auto& [second, question] : questions)
      cable.at(static_cast<Picoseconds>(second * static_cast<double>(ps_per_s)), question);
    link::JobSender sender(cable, job_, session(1));
    sender_ = &sender;
    EXPECT_EQ(sender.run().end, JobEnd::done);
  }

  job::Profile profile_ = lamp_profile();
  Rig rig_{profile_};
  ProgramHost user_{rig_};
  job::Job job_;
  link::JobSender* sender_ = nullptr;
};

TEST_F(StatusLine, AtRest) {
  EXPECT_THAT(ask(), AllOf(StartsWith("<Idle|MPos:0.000,0.000,0.000|Bf:"),
                           HasSubstr(",1024|FS:0,0|WCO:0.000,0.000,0.000|Lamp:")));
  EXPECT_THAT(ask(), AllOf(HasSubstr("|FS:0,0|Ov:100,100,100|Lamp:"), Not(HasSubstr("WCO"))));
  EXPECT_THAT(user_.ask("$10=0\n$13=1\n"), ElementsAre("ok", "ok"));
  EXPECT_THAT(ask(), AllOf(StartsWith("<Idle|WPos:0.0000,0.0000,0.0000|FS:0.0,0|Lamp:")));
}

TEST_F(StatusLine, InAJob) {
  double fastest = 0;
  std::map<double, std::function<void()>> questions;
  for (int i = 0; i < 40; ++i)
    questions[0.5 + 0.0123 * i] = [this, &fastest] {
      const std::string line = ask();
      EXPECT_THAT(line, StartsWith("<Run|"));
      const double feed = number_behind(line, "|FS:");
      EXPECT_GE(feed, 0);
      fastest = std::max(fastest, feed);
    };
  run_job(questions);
  // The walk's steps of 0.1 to 0.6 mm at a beat of 10 ms each are 600 to 3600 mm/min.
  EXPECT_GT(fastest, 600);
  EXPECT_LT(fastest, 12'000);
}

TEST_F(StatusLine, InAHoldAndAtAnOpenDoor) {
  std::vector<std::string> states;
  std::string line;
  const auto note = [this, &states, &line] {
    line = ask();
    const std::string state = line.substr(0, line.find('|'));
    if (states.empty() || states.back() != state) states.push_back(state);
  };
  std::map<double, std::function<void()>> questions;
  const auto note_from = [&questions, note](double begin) {
    for (int i = 1; i <= 60; ++i) questions[begin + 0.0013 * i] = note;
  };
  questions[0.7] = [this] { sender_->pause(); };
  note_from(0.7);
  questions[0.9] = [this, &line] {
    EXPECT_THAT(line, HasSubstr("|FS:0,0"));
    sender_->resume();
  };
  questions[1.15] = note;
  questions[1.2] = [this] { rig_.set(sim::Pin::door, true); };
  note_from(1.2);
  questions[1.5] = [this, &line] {
    EXPECT_THAT(line, HasSubstr("|FS:0,0|Pn:D|"));
    rig_.set(sim::Pin::door, false);
  };
  note_from(1.5);
  questions[1.8] = [this, &line] {
    EXPECT_THAT(line, Not(HasSubstr("Pn:")));
    sender_->resume();
  };
  run_job(questions);
  EXPECT_THAT(states,
              ElementsAre("<Run", "<Hold:1", "<Hold:0", "<Run", "<Door:2", "<Door:1", "<Hold:0"));
}

TEST_F(StatusLine, ReportsThePosition) {
  run_job({});
  const std::string line = ask();
  const wire::Target& last = job_.targets.back();
  std::size_t at = line.find("MPos:") + 5;
  for (int a = 0; a < 3; ++a) {
    std::size_t used = 0;
    EXPECT_NEAR(std::stod(line.substr(at), &used), last.steps[index(a)] / 200.0, 0.0005) << line;
    at += used + 1;
  }
}

}  // namespace
}  // namespace lamplock::test
