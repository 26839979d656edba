// Text of match files, for their writer.
#ifndef RIGEL_PROBLEMS_IO_MATCH_TEXT_H_
#define RIGEL_PROBLEMS_IO_MATCH_TEXT_H_

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <Eigen/Core>

#include "rigel/core/pose.h"

namespace rigel {

// Appends words and numbers, line by line.
class MatchText {
 public:
  explicit MatchText(size_t num_bytes) { text_.reserve(num_bytes); }

  MatchText& Word(std::string_view word) {
    if (!text_.empty() && text_.back() != '\n') text_ += ' ';
    text_ += word;
    return *this;
  }

  template <typename Value>
  MatchText& Number(Value value) {
    std::array<char, 32> buffer;  // the shortest form of a double has at most 24 characters
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return Word({buffer.data(), size_t(result.ptr - buffer.data())});
  }

  template <typename Derived>
  MatchText& Vector(const Eigen::MatrixBase<Derived>& v) {
    for (Eigen::Index k = 0; k < v.size(); ++k) Number(v[k]);
    return *this;
  }

  MatchText& Quaternion(const Eigen::Matrix3d& R) {
    Pose pose;
    pose.R = R;
    const Eigen::Quaterniond q = pose.Quaternion();
    return Number(q.w()).Number(q.x()).Number(q.y()).Number(q.z());
  }

  // An angle in radians, as degrees that read back as the same radians where there are such.
  MatchText& SigmaDeg(double radians);

  void EndLine() { text_ += '\n'; }

  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_TEXT_H_
