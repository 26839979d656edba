// Lines and columns of match files and track files, for their readers.
#ifndef RIGEL_PROBLEMS_IO_MATCH_LINES_H_
#define RIGEL_PROBLEMS_IO_MATCH_LINES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "rigel/core/match.h"
#include "rigel/core/pose.h"
#include "rigel/problems/io/match_file_words.h"

namespace rigel {

// The lines of the text of a match file or a track file, split into columns that are converted with
// messages.
//
// Goes once over the text and keeps no copy of it: columns are views. Messages name the file, the
// line, the column by its word in the usage, and what was expected. Each function that returns bool
// returns false with a message in *error.
class MatchLines {
 public:
  // `name` stands for the path in messages. All three must outlive this object.
  MatchLines(std::string_view text, const std::string& name, std::string* error)
      : text_(text), name_(name), error_(error) {}

  // To be called first. False if it is not UTF-8 text. `what` is the expected kind of file.
  bool Begin(const char* what);

  // Splits the next line that has content. False, without a message, at the end of the text; line()
  // is then the last line.
  bool NextLine();

  // Takes the next line if it is a plain row of a match between declared cameras, as nearly all
  // lines of files without further columns are, without splitting it first: that is a third faster.
  // False, without a message, for all other lines, valid or not: NextLine() then reads the line.
  bool TakePlainRow(int num_cameras, Match* match);

  int64_t line() const { return line_; }  // from 1
  size_t BytesLeft() const { return static_cast<size_t>(end_ - pos_); }
  size_t num_columns() const { return num_columns_; }
  std::string_view Column(size_t column) const { return columns_[column]; }

  // The words of the line's columns for messages: the usage of its keyword.
  void SetUsage(std::string_view usage) { usage_ = usage; }

  // Always false.
  bool Fail(const std::string& message) { return FailAt(line_, message); }
  bool FailAt(int64_t line, const std::string& message);
  bool FailColumn(size_t column, const std::string& expected);

  bool CheckColumns(size_t expected);
  bool Number(size_t column, double* value);
  bool PositiveNumber(size_t column, double* value);
  bool Integer(size_t column, int min, int* value);
  bool SigmaDeg(size_t column, double* radians);  // of positive degrees

  // A quaternion w x y z and a vector, from `column` on.
  bool RotationAndVector(size_t column, Pose* pose);

  // The columns column, column + 1, ... as a vector.
  template <int kSize, int kOptions>
  bool Vector(size_t column, Eigen::Matrix<double, kSize, 1, kOptions>* value) {
    for (int k = 0; k < kSize; ++k) {
      if (!Number(column + k, &(*value)[k])) return false;
    }
    return true;
  }

  // The same of unit length within 1e-3, normalized. `what` names it in messages.
  template <int kSize>
  bool UnitVector(size_t column, const char* what, Eigen::Matrix<double, kSize, 1>* value) {
    if (!Vector(column, value)) return false;
    const double norm = value->norm();
    if (!CheckUnit(what, norm)) return false;
    if (!IsRounding(norm)) *value /= norm;
    return true;
  }

 private:
  bool CheckUnit(const char* what, double norm);
  static bool IsRounding(double norm);
  std::string ColumnName(size_t column) const;
  std::string_view NextWord(const char** p) const;
  void SplitLine();

  std::string_view text_;
  const char* pos_ = nullptr;
  const char* end_ = nullptr;
  const std::string& name_;
  std::string* const error_;

  int64_t line_ = 0;
  std::string_view usage_;
  std::array<std::string_view, match_file::kMaxColumns> columns_;
  size_t num_columns_ = 0;  // may exceed kMaxColumns; the surplus is not kept
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_LINES_H_
