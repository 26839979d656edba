// The rows of a match file: which columns they have, for its reader and its writer.
#ifndef RIGEL_PROBLEMS_IO_MATCH_ROWS_H_
#define RIGEL_PROBLEMS_IO_MATCH_ROWS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/match_lines.h"
#include "rigel/problems/io/match_text.h"

namespace rigel {

// The columns of the rows of one file. At first these are the seven that all files have, in their
// default order.
class MatchRows {
 public:
  MatchRows();

  // The columns of what is to be written: the default ones, then those that the pair has. One
  // that does not have an entry for each match is left out.
  explicit MatchRows(const FramePair& pair);

  bool IsDefault() const { return is_default_; }

  // The names, as messages and the `columns` line have them.
  const std::string& usage() const { return usage_; }

  // Reads the `columns` line that was split last. False with a message if a name is unknown or
  // there twice, or if one is missing.
  bool ReadNames(MatchLines* lines);

  // Appends the row that was split last to the matches and columns of the pair, whose rig is
  // complete. False with a message if it is no such row.
  bool ReadRow(MatchLines* lines, FramePair* pair) const;

  // Appends row number `row` of the pair, without a line end.
  void WriteRow(const FramePair& pair, size_t row, MatchText* text) const;

 private:
  void SetIds(const std::vector<match_file::ColumnId>& ids);

  std::vector<match_file::ColumnId> ids_;  // in the order of the file
  std::string usage_;
  bool is_default_ = true;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_ROWS_H_
