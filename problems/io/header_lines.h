// The header of match files and track files: lines that begin with a keyword, then the rows.
#ifndef RIGEL_PROBLEMS_IO_HEADER_LINES_H_
#define RIGEL_PROBLEMS_IO_HEADER_LINES_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "rigel/core/pose.h"
#include "rigel/core/rig.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/match_lines.h"
#include "rigel/problems/io/match_text.h"

namespace rigel {

// What the lines of a file declare about its cameras.
class CameraLines {
 public:
  // Each reads the line that was split last. False with a message if it is not valid.
  bool ReadCamera(MatchLines* lines);  // the number, the model with its parameters, ...
  bool ReadSigma(MatchLines* lines);
  bool ReadTime(MatchLines* lines);

  // After all lines: the rig. `rows` is the keyword before which the lines have to be.
  bool Finish(std::string_view rows, MatchLines* lines, Rig* rig) const;

  static void Write(const Rig& rig, MatchText* f);

 private:
  // What lines say of cameras, by their numbers. All but the line is of one kind of line.
  struct Declared {
    RigCamera camera;
    int64_t line;
  };
  using DeclaredCameras = std::map<int, Declared>;

  static bool Declare(int index, const Declared& declared, const char* what, MatchLines* lines,
                      DeclaredCameras* cameras);

  DeclaredCameras cameras_, sigmas_, times_;
  std::string usage_;  // of the last camera's model
};

// The lines of a file with a header. The first keyword is that of the format, the last one
// announces the rows.
class HeaderLines : protected MatchLines {
 protected:
  // `what` the file is, as "a match file". All must outlive this object.
  HeaderLines(const match_file::Keyword* keywords, int num_keywords, const char* what,
              std::string_view text, const std::string& name, std::string* error)
      : MatchLines(text, name, error),
        keywords_(keywords),
        num_keywords_(num_keywords),
        what_(what) {}
  ~HeaderLines() = default;

  // Begins the text and reads its header, calling HeaderLine() for each line but the first, up to
  // and with that of the last keyword.
  bool ReadHeader();

  // Reads a line whose number of columns is right.
  virtual bool HeaderLine(int id) = 0;

  // False with a message if the line that was split last is no row `row` of `num_rows`.
  bool CheckRow(size_t row, size_t num_rows);
  // False with a message if the file ended after fewer.
  bool CheckNumRows(size_t rows, size_t num_rows);

  // Values of a line from its first column on, or from another one.
  bool Direction(std::optional<Eigen::Vector3d>* value, size_t column = 1);
  bool Positive(std::optional<double>* value);
  bool SigmaDeg(size_t column, double* radians) { return MatchLines::SigmaDeg(column, radians); }
  bool SigmaDeg(std::optional<double>* radians);
  bool Sequence(std::string* name);
  bool Distance(size_t column, double* distance, double* sigma);

 private:
  int FindKeyword(std::string_view word) const;
  bool UnknownKeyword(bool has_format);
  bool Format();

  const match_file::Keyword* const keywords_;
  const int num_keywords_;
  const char* const what_;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_HEADER_LINES_H_
