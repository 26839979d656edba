#include "rigel/problems/io/match_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

using namespace match_file;  // NOLINT(google-build-using-namespace): the words of the format

constexpr char kDefaultUsage[] = "I U V J U2 V2 SCORE";

// Four columns that make sense together only.
struct ColumnGroup {
  ColumnId first, last;
};
constexpr ColumnGroup kGroups[] = {{kA11, kA22}, {kExactU1, kExactV2}};

std::string Names(ColumnId first, ColumnId last) {
  std::string names;
  for (int id = first; id <= last; ++id) {
    names += (names.empty() ? "" : " ") + std::string(kColumnNames[id]);
  }
  return names;
}

// One row of a file, as far as it has the columns.
struct RowValues {
  std::array<double, kNumColumns> number{};
  int camera1 = 0, camera2 = 0;
  int64_t landmark = 0;

  std::array<double, 4> Four(ColumnId first) const {
    return {number[first], number[first + 1], number[first + 2], number[first + 3]};
  }
};

bool IsAffineFrame(const std::array<double, 4>& a) {
  MatchColumns one;
  one.affine = {a};
  std::string ignored;
  return one.IsValid(1, &ignored);
}

bool ReadCamera(size_t column, int num_cameras, MatchLines* lines, int* camera) {
  if (!lines->Integer(column, 0, camera)) return false;
  if (*camera < num_cameras) return true;
  return lines->FailColumn(column,
                           "a declared camera (0 to " + std::to_string(num_cameras - 1) + ")");
}

bool ReadValue(ColumnId id, size_t column, int num_cameras, MatchLines* lines, RowValues* row) {
  double* const number = &row->number[id];
  switch (id) {
    case kCamera1:
      return ReadCamera(column, num_cameras, lines, &row->camera1);
    case kCamera2:
      return ReadCamera(column, num_cameras, lines, &row->camera2);
    case kLandmark:
      return ParseInteger(lines->Column(column), INT64_MIN, &row->landmark) ||
             lines->FailColumn(column, "an integer of 64 bits");
    case kSigma1:
    case kSigma2:
    case kDepthSigma:
    case kAffineSigma:
      return lines->PositiveNumber(column, number);
    case kDepth1:
      return lines->Number(column, number) &&
             (*number >= 0 || lines->FailColumn(column, "a number >= 0, 0 if it is unknown"));
    case kInlier:
      if (lines->Column(column) != "0" && lines->Column(column) != "1") {
        return lines->FailColumn(column, "1 or 0");
      }
      return lines->Number(column, number);
    default:
      return lines->Number(column, number);
  }
}

// The vector of the columns that a column of one number belongs to.
template <typename Columns>
auto* NumberColumn(ColumnId id, Columns* columns) {
  switch (id) {
    case kSigma1:
      return &columns->sigma1;
    case kSigma2:
      return &columns->sigma2;
    case kDepth1:
      return &columns->depth1;
    case kDepthSigma:
      return &columns->depth_sigma;
    case kAffineSigma:
      return &columns->affine_sigma;
    default:
      return static_cast<decltype(&columns->sigma1)>(nullptr);
  }
}

// The column `id` of the row; of four that belong together at the first one.
void AppendValue(ColumnId id, const RowValues& row, MatchColumns* columns) {
  if (auto* const numbers = NumberColumn(id, columns)) {
    numbers->push_back(row.number[id]);
  } else if (id == kLandmark) {
    columns->landmark.push_back(row.landmark);
  } else if (id == kInlier) {
    columns->inlier.push_back(row.number[id] == 1 ? 1 : 0);
  } else if (id == kA11) {
    columns->affine.push_back(row.Four(kA11));
  } else if (id == kExactU1) {
    columns->exact.push_back(row.Four(kExactU1));
  }
}

// How many entries the column `id` of the pair has.
size_t NumEntries(ColumnId id, const MatchColumns& columns) {
  if (const auto* const numbers = NumberColumn(id, &columns)) return numbers->size();
  if (id == kLandmark) return columns.landmark.size();
  if (id == kInlier) return columns.inlier.size();
  return id < kExactU1 ? columns.affine.size() : columns.exact.size();
}

}  // namespace

MatchRows::MatchRows() : usage_(kDefaultUsage) {
  for (size_t id = 0; id < kNumDefaultColumns; ++id) ids_.push_back(static_cast<ColumnId>(id));
}

MatchRows::MatchRows(const FramePair& pair) : MatchRows() {
  std::vector<ColumnId> ids = ids_;
  for (int id = kNumDefaultColumns; id < kNumColumns && !pair.matches.empty(); ++id) {
    const ColumnId column = static_cast<ColumnId>(id);
    if (NumEntries(column, pair.columns) == pair.matches.size()) ids.push_back(column);
  }
  if (ids.size() > kNumDefaultColumns) SetIds(ids);
}

void MatchRows::SetIds(const std::vector<ColumnId>& ids) {
  ids_ = ids;
  usage_.clear();
  is_default_ = ids.size() == kNumDefaultColumns;
  for (size_t k = 0; k < ids.size(); ++k) {
    usage_ += (k > 0 ? " " : "") + std::string(kColumnNames[ids[k]]);
    is_default_ = is_default_ && ids[k] == static_cast<ColumnId>(k);
  }
}

bool MatchRows::ReadNames(MatchLines* lines) {
  std::vector<ColumnId> ids;
  std::array<bool, kNumColumns> seen{};
  // A line of more words than are kept has a name twice among those that are.
  static_assert(kMaxColumns >= kNumColumns + 2);
  for (size_t k = 1; k < std::min(lines->num_columns(), kMaxColumns); ++k) {
    const std::string_view name = lines->Column(k);
    const auto known = std::find(kColumnNames.begin(), kColumnNames.end(), name);
    if (known == kColumnNames.end()) {
      return lines->Fail("unknown column " + Quoted(name) + ", expected names of " +
                         Names(kCamera1, kExactV2));
    }
    const size_t id = known - kColumnNames.begin();
    if (seen[id]) {
      return lines->Fail("column '" + std::string(name) +
                         "' for the second time, expected each name once");
    }
    seen[id] = true;
    ids.push_back(static_cast<ColumnId>(id));
  }
  for (size_t id = 0; id < kNumDefaultColumns; ++id) {
    if (seen[id]) continue;
    return lines->Fail("no column '" + std::string(kColumnNames[id]) + "', expected all of " +
                       Names(kCamera1, kScore));
  }
  for (const ColumnGroup& group : kGroups) {
    const auto first = seen.begin() + group.first;
    const auto count = std::count(first, first + 4, true);
    if (count > 0 && count < 4) {
      return lines->Fail(std::to_string(count) + " of the columns " +
                         Names(group.first, group.last) + ", expected all four or none");
    }
  }
  SetIds(ids);
  return true;
}

bool MatchRows::ReadRow(MatchLines* lines, FramePair* pair) const {
  if (!lines->CheckColumns(ids_.size())) return false;
  RowValues row;
  for (size_t k = 0; k < ids_.size(); ++k) {
    if (!ReadValue(ids_[k], k, pair->rig.size(), lines, &row)) return false;
  }
  Match m;
  m.camera1 = row.camera1;
  m.pixel1 = {row.number[kU1], row.number[kV1]};
  m.camera2 = row.camera2;
  m.pixel2 = {row.number[kU2], row.number[kV2]};
  m.score = row.number[kScore];
  pair->matches.push_back(m);
  for (const ColumnId id : ids_) {
    if (id == kA11 && !IsAffineFrame(row.Four(kA11))) {
      return lines->Fail(Names(kA11, kA22) +
                         " have a determinant that is not positive, expected a positive one or "
                         "four zeros");
    }
    AppendValue(id, row, &pair->columns);
  }
  return true;
}

void MatchRows::WriteRow(const FramePair& pair, size_t row, MatchText* text) const {
  const Match& m = pair.matches[row];
  text->Number(m.camera1).Vector(m.pixel1).Number(m.camera2).Vector(m.pixel2).Number(m.score);
  const MatchColumns& columns = pair.columns;
  for (size_t k = kNumDefaultColumns; k < ids_.size(); ++k) {
    const ColumnId id = ids_[k];
    if (const auto* const numbers = NumberColumn(id, &columns)) {
      text->Number((*numbers)[row]);
    } else if (id == kLandmark) {
      text->Number(columns.landmark[row]);
    } else if (id == kInlier) {
      text->Number(static_cast<int>(columns.inlier[row]));
    } else if (id < kExactU1) {
      text->Number(columns.affine[row][id - kA11]);
    } else {
      text->Number(columns.exact[row][id - kExactU1]);
    }
  }
}

}  // namespace rigel
