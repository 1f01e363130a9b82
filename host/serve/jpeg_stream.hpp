// Pictures in the answer of a camera of the network: one JPEG, or a stream of them.
//
// In:  bytes of an HTTP response: image/jpeg, or multipart/x-mixed-replace (the "MJPEG" of network
//      cameras). Out: whole pictures. Who: the camera of the server.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::serve {

/// A larger picture is refused.
inline constexpr std::size_t max_picture_bytes = 4 * 1024 * 1024;

/// Begins and ends as a JPEG does.
bool is_jpeg(std::string_view bytes);

/// Divides the bytes of one response into pictures.
class JpegStream {
 public:
  /// Pictures that these bytes complete. Throws Error(bad_input): the response has another status
  /// or type, a picture is too large or is not a JPEG.
  std::vector<std::string> take(std::string_view bytes);
  /// The connection is closed: the picture that ended with it, if any. Throws as take().
  std::optional<std::string> close();
  /// The response has one picture, and it is complete.
  bool is_over() const { return state_ == State::over; }

 private:
  bool take_head();
  bool take_part_head();
  bool take_picture(std::vector<std::string>& pictures);

  enum class State { head, part_head, picture, over } state_ = State::head;
  std::string rest_;
  std::size_t searched_ = 0;  ///< bytes of it without the end of the picture
  std::string boundary_;      ///< "--" and its name; empty: one picture
  std::optional<std::size_t> length_{};
};

}  // namespace lamplock::serve
