#include "rigel/core/match_columns.h"

#include <algorithm>
#include <cmath>

namespace rigel {
namespace {

bool IsPositive(double value) { return value > 0 && std::isfinite(value); }
bool IsDepth(double value) { return value >= 0 && std::isfinite(value); }
bool IsFlag(char value) { return value == 0 || value == 1; }
bool IsAny(int64_t /*value*/) { return true; }

bool AllFinite(const std::array<double, 4>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

bool IsAffineFrame(const std::array<double, 4>& a) {
  if (!AllFinite(a)) return false;
  const bool unknown = std::all_of(a.begin(), a.end(), [](double x) { return x == 0; });
  return unknown || a[0] * a[3] - a[1] * a[2] > 0;
}

template <typename Value, typename Check>
bool CheckColumn(const char* name, const std::vector<Value>& values, size_t num_matches,
                 Check is_valid, const char* expected, std::string* error) {
  if (values.empty()) return true;
  if (values.size() != num_matches) {
    *error = "column " + std::string(name) + " has " + std::to_string(values.size()) +
             " entries for " + std::to_string(num_matches) + " matches";
    return false;
  }
  const auto bad =
      std::find_if(values.begin(), values.end(), [&](const Value& v) { return !is_valid(v); });
  if (bad == values.end()) return true;
  *error = "match " + std::to_string(bad - values.begin()) + ": " + name + " must be " + expected;
  return false;
}

template <typename Value>
std::vector<Value> Rows(const std::vector<Value>& values, const std::vector<size_t>& rows) {
  std::vector<Value> subset;
  if (values.empty()) return subset;
  subset.reserve(rows.size());
  for (const size_t row : rows) subset.push_back(values[row]);
  return subset;
}

}  // namespace

bool MatchColumns::IsValid(size_t num_matches, std::string* error) const {
  const auto check = [&](const char* name, const auto& values, auto is_valid,
                         const char* expected) {
    return CheckColumn(name, values, num_matches, is_valid, expected, error);
  };
  constexpr char kPositive[] = "positive and finite";
  return check("landmark", landmark, IsAny, "") && check("sigma1", sigma1, IsPositive, kPositive) &&
         check("sigma2", sigma2, IsPositive, kPositive) &&
         check("depth1", depth1, IsDepth, "finite and not negative") &&
         check("depth_sigma", depth_sigma, IsPositive, kPositive) &&
         check("a11 a12 a21 a22", affine, IsAffineFrame,
               "finite with a positive determinant, or all zero") &&
         check("affine_sigma", affine_sigma, IsPositive, kPositive) &&
         check("inlier", inlier, IsFlag, "1 or 0") &&
         check("u0 v0 u20 v20", exact, AllFinite, "finite");
}

MatchColumns MatchColumns::Subset(const std::vector<size_t>& rows) const {
  MatchColumns subset;
  subset.landmark = Rows(landmark, rows);
  subset.sigma1 = Rows(sigma1, rows);
  subset.sigma2 = Rows(sigma2, rows);
  subset.depth1 = Rows(depth1, rows);
  subset.depth_sigma = Rows(depth_sigma, rows);
  subset.affine = Rows(affine, rows);
  subset.affine_sigma = Rows(affine_sigma, rows);
  subset.inlier = Rows(inlier, rows);
  subset.exact = Rows(exact, rows);
  return subset;
}

}  // namespace rigel
