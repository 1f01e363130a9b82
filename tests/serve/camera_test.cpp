// The camera: streams of pictures, the picture of the server, its calibration.
#include "host/serve/camera.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "host/error.hpp"
#include "host/serve/jpeg_stream.hpp"
#include "tests/serve/running_server.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::serve::test::camera_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// The frame of a JPEG (ITU-T T.81, annex B: SOI, a marker, EOI) around a text.
std::string jpeg(const std::string& text) { return "\xFF\xD8\xFF\xE0" + text + "\xFF\xD9"; }

std::string part(const std::string& picture, bool has_length) {
  return "--edge\r\nContent-Type: image/jpeg\r\n" +
         (has_length ? fmt::format("Content-Length: {}\r\n", picture.size()) : std::string()) +
         "\r\n" + picture + "\r\n";
}

constexpr const char* stream_head =
    "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=edge\r\n\r\n";

/// All pictures of a response that comes in pieces of random sizes.
std::vector<std::string> pictures_of(const std::string& response, unsigned seed) {
  std::mt19937 random(seed);
  JpegStream stream;
  std::vector<std::string> all;
  for (std::size_t at = 0; at < response.size();) {
    const std::size_t size = std::uniform_int_distribution<std::size_t>(1, 40)(random);
    for (std::string& each : stream.take(std::string_view(response).substr(at, size)))
      all.push_back(std::move(each));
    at += size;
  }
  if (auto last = stream.close()) all.push_back(std::move(*last));
  return all;
}

TEST(JpegStream, HasThePicturesHoweverTheBytesCome) {
  const std::string one = jpeg("one"), two = jpeg("two\r\n\r\n--ed"), three = jpeg("");
  for (unsigned seed = 0; seed < 50; ++seed) {
    for (const bool has_length : {true, false})
      EXPECT_THAT(pictures_of(stream_head + part(one, has_length) + part(two, has_length) +
                                  part(three, has_length) + "--edge--\r\n",
                              seed),
                  ElementsAre(one, two, three));
    const std::string head = "HTTP/1.1 200 OK\r\ncontent-type: image/jpeg\r\n";
    EXPECT_THAT(pictures_of(fmt::format("{}\r\n{}", head, two), seed), ElementsAre(two))
        << "until it is closed";
    EXPECT_THAT(
        pictures_of(fmt::format("{}Content-Length: {} \r\n\r\n{}more", head, two.size(), two),
                    seed),
        ElementsAre(two));
  }
}

TEST(JpegStream, RefusesWhatIsNoPicture) {
  const auto refusal = [](const std::string& response) {
    try {
      pictures_of(response, 1);
      return std::string("taken");
    } catch (const Error& error) {
      return std::string(error.message());
    }
  };
  const std::string head = "HTTP/1.0 200 OK\r\n";
  EXPECT_THAT(refusal("HTTP/1.0 404 Not Found\r\n\r\n"), HasSubstr("404 Not Found"));
  EXPECT_THAT(refusal("220 mail\r\n\r\n"), HasSubstr("does not answer in HTTP"));
  EXPECT_THAT(refusal(head + "Content-Type: text/html\r\n\r\n<html>"), HasSubstr("neither"));
  EXPECT_THAT(refusal(head + "Content-Type: multipart/x-mixed-replace\r\n\r\n"),
              HasSubstr("without a boundary"));
  EXPECT_THAT(refusal(head + "Transfer-Encoding: chunked\r\n\r\n"), HasSubstr("in chunks"));
  EXPECT_THAT(refusal(stream_head + part("<svg>", true)), HasSubstr("not a JPEG"));
  EXPECT_THAT(refusal(stream_head + std::string("--edge\r\nContent-Length: 4194305\r\n\r\n")),
              HasSubstr("too large"));
  EXPECT_THAT(refusal(stream_head + std::string("--edge\r\nContent-Length: -1\r\n\r\n")),
              HasSubstr("not a number"));
  EXPECT_THAT(refusal(stream_head + std::string("--edge\r\nContent-Length: 1e2\r\n\r\n")),
              HasSubstr("not a number"));
  EXPECT_THAT(refusal(stream_head + std::string("--edge\r\nContent-Length: 99999999999999999999"
                                                "\r\n\r\n")),
              HasSubstr("too large"));
  EXPECT_THAT(refusal(stream_head + std::string("--edge\r\n\r\n") + std::string(5'000'000, 'x')),
              HasSubstr("too large"));
  EXPECT_THAT(refusal(std::string(10'000, 'x')), HasSubstr("does not answer in HTTP"));
  EXPECT_THAT(refusal(stream_head + std::string(10'000, 'x')), HasSubstr("broken"));
}

TEST(Camera, RefusesAddressesThatItCannotRead) {
  for (const char* source :
       {"https://a/b", "http://", "http:///path", "rtsp://a/b", "http://a/b c",
        "http://name:word@a/b", "http://a/b\r\nX: y", "http://:80/a", "http://a:/", "http://a:b/",
        "http://a:0/", "http://a:65536/", "http://[::1/", "http://[]/", "http://[::1]a/"})
    EXPECT_THROW(Camera{source}, Error) << source;
}

/// A camera of the network, which sends an answer to each client.
class FakeCamera {
 public:
  /// `keeps_open`: until the client closes the connection.
  explicit FakeCamera(std::string answer = stream_head + part(jpeg("first"), true) +
                                           part(jpeg("second"), true),
                      bool keeps_open = false)
      : answer_(std::move(answer)), keeps_open_(keeps_open), thread_([this] { serve(); }) {}
  ~FakeCamera() {
    is_ending_ = true;
    boost::system::error_code ignored;
    tcp::socket(io_).connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
  }
  FakeCamera(const FakeCamera&) = delete;
  FakeCamera& operator=(const FakeCamera&) = delete;
  std::string address() const {
    return fmt::format("http://127.0.0.1:{}/stream?a=b", acceptor_.local_endpoint().port());
  }
  int clients() const { return clients_; }

 private:
  using tcp = boost::asio::ip::tcp;

  void serve() {
    while (true) {
      tcp::socket socket = acceptor_.accept();
      if (is_ending_) return;
      ++clients_;
      boost::system::error_code ignored;
      std::string request;
      boost::asio::read_until(socket, boost::asio::dynamic_buffer(request), "\r\n\r\n", ignored);
      EXPECT_TRUE(request.starts_with("GET /stream?a=b HTTP/1.0\r\n")) << request;
      boost::asio::write(socket, boost::asio::buffer(answer_), ignored);
      char byte = 0;
      if (keeps_open_) boost::asio::read(socket, boost::asio::buffer(&byte, 1), ignored);
    }
  }

  boost::asio::io_context io_;
  tcp::acceptor acceptor_{io_, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
  std::atomic<bool> is_ending_{false};
  std::atomic<int> clients_{0};
  const std::string answer_;
  const bool keeps_open_;
  std::thread thread_;
};

Reply ask_for_picture(const RunningServer& server) {
  return request(server.port(), fmt::format("GET /camera HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n"
                                            "Authorization: Bearer {}\r\n\r\n",
                                            server.port(), token));
}

/// The answer with this text, or the last one.
Reply wait_for(const RunningServer& server, const std::string& text) {
  Reply reply;
  comes_true([&] {
    reply = ask_for_picture(server);
    return reply.text.find(text) != std::string::npos;
  });
  return reply;
}

TEST(Camera, OfTheNetworkIsReadWhilePagesAskForIt) {
  FakeCamera camera;
  RunningServer server({.camera = camera.address()});
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(camera.clients(), 0) << "no page has asked";
  const Reply reply = wait_for(server, "200 OK");
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.text, HasSubstr("Content-Type: image/jpeg"));
  EXPECT_THAT(reply.text, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_TRUE(reply.text.ends_with(jpeg("first")) || reply.text.ends_with(jpeg("second")));
  EXPECT_GE(camera.clients(), 1);
  EXPECT_EQ(server.client("client").call("camera.get")["result"]["camera"], true);
}

/// Asks for pictures until this is true.
bool ask_until(Camera& camera, const std::function<bool()>& is_true) {
  return comes_true([&] {
    static_cast<void>(camera.picture());
    return is_true();
  });
}

TEST(Camera, IsNotReadAnyMoreWhenNoPageAsks) {
  FakeCamera source;
  Camera camera(source.address(), 300ms);
  EXPECT_TRUE(ask_until(camera, [&] { return source.clients() > 2; })) << "again and again";
  std::this_thread::sleep_for(800ms);
  const int clients = source.clients();
  std::this_thread::sleep_for(800ms);
  EXPECT_EQ(source.clients(), clients);
}

TEST(Camera, TakesOnePictureFromEachConnectionThatStaysOpen) {
  const std::string picture = jpeg("one");
  FakeCamera source(fmt::format("HTTP/1.1 200 OK\r\nContent-Type: image/jpeg\r\n"
                                "Content-Length: {}\r\n\r\n{}",
                                picture.size(), picture),
                    true);
  Camera camera(source.address());
  EXPECT_TRUE(ask_until(camera, [&] { return source.clients() > 4; })) << "without a time limit";
  EXPECT_EQ(camera.problem(), "");
}

TEST(Camera, SaysWhyItHasNoPicture) {
  for (const char* answer : {"", "HTTP/1.0 200 OK\r\n",
                             "HTTP/1.0 200 OK\r\nContent-Type: image/jpeg"
                             "\r\nContent-Length: 9\r\n\r\nhalf"}) {
    FakeCamera source(answer);
    Camera camera(source.address());
    EXPECT_TRUE(ask_until(camera, [&] { return !camera.problem().empty(); })) << answer;
    EXPECT_THAT(camera.problem(), HasSubstr("before a picture is complete"));
  }
  FakeCamera silent("", true);
  Camera camera(silent.address(), 100ms);
  EXPECT_TRUE(ask_until(camera, [&] { return silent.clients() == 1; }));
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(camera.problem(), "") << "no page has waited for the answer";
  EXPECT_TRUE(ask_until(camera, [&] { return !camera.problem().empty(); }));
  EXPECT_THAT(camera.problem(), HasSubstr("does not answer"));
}

TEST(Camera, DoesNotWaitForAPipe) {
  const lamplock::test::TemporaryFolder folder;
  const std::filesystem::path pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& source : {pipe.string(), std::string("/dev/zero")}) {
    Camera camera(source);
    EXPECT_TRUE(ask_until(camera, [&] { return !camera.problem().empty(); }));
    EXPECT_THAT(camera.problem(), HasSubstr("not a regular file"));
  }
}

TEST(Camera, OfAFileHasItsNewestPicture) {
  const lamplock::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.file("camera.jpg");
  RunningServer server({.camera = file.string()});
  const auto write = [&](const std::string& bytes) {
    std::ofstream(file.string() + ".new", std::ios::binary) << bytes;
    std::filesystem::rename(file.string() + ".new", file);
  };
  write(std::string(max_picture_bytes + 1, 'x'));
  EXPECT_EQ(request(server.port(), fmt::format("GET /camera HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n",
                                               server.port()))
                .status,
            401)
      << "without the token";
  const Reply large = wait_for(server, "larger than 4 MiB");
  EXPECT_EQ(large.status, 503);
  EXPECT_THAT(large.text, HasSubstr("larger than 4 MiB"));
  for (const char* text : {"one", "two"}) {
    write(jpeg(text));
    EXPECT_TRUE(wait_for(server, jpeg(text)).text.ends_with(jpeg(text)));
  }
}

TEST(Camera, IsOffByDefault) {
  RunningServer server;
  EXPECT_EQ(ask_for_picture(server).status, 404);
  RawClient client = server.client("client");
  EXPECT_EQ(client.call("camera.get")["result"]["camera"], false);
}

TEST(Camera, KeepsItsCalibration) {
  RunningServer server({.camera = "/nowhere/camera.jpg"});
  RawClient client = server.client("client");
  const auto point = [](double u, double v, double x, double y) {
    return Json{{"u", u}, {"v", v}, {"x", x}, {"y", y}};
  };
  const Json good{point(0.1, 0.9, -40, -40), point(0.9, 0.9, 40, -40), point(0.8, 0.1, 40, 40),
                  point(0.2, 0.1, -40, 40)};
  const auto refusal = [&](const Json& points) {
    return error_of(client.call("camera.calibrate", {{"points", points}}));
  };
  EXPECT_THAT(refusal(good), HasSubstr("take control first"));
  client.call("control.take");
  EXPECT_EQ(refusal(good), "");
  EXPECT_EQ(client.call("camera.get")["result"]["points"], good);
  Json bad = good;
  bad[0]["u"] = 1.1;
  EXPECT_THAT(refusal(bad), HasSubstr("u of a point"));
  bad = good;
  bad[1].erase("x");
  EXPECT_THAT(refusal(bad), HasSubstr("x of a point"));
  bad = good;
  bad[1] = point(0.15, 0.5, 40, -40);
  EXPECT_THAT(refusal(bad), HasSubstr("on one line"));
  bad = good;
  std::swap(bad[0]["x"], bad[1]["x"]);
  EXPECT_THAT(refusal(bad), HasSubstr("another order"));
  bad = good;
  for (Json& each : bad) each["x"] = -each["x"].get<double>();
  EXPECT_EQ(refusal(bad), "") << "a mirrored picture";
  EXPECT_EQ(refusal(good), "");
  bad = good;
  for (Json& each : bad) each["x"] = 0;
  EXPECT_THAT(refusal(bad), HasSubstr("on one line"));
  bad.erase(0);
  EXPECT_THAT(refusal(bad), HasSubstr("four points"));
  EXPECT_EQ(client.call("camera.get")["result"]["points"], good) << "nothing was written";
}

}  // namespace
}  // namespace lamplock::serve::test::camera_test
