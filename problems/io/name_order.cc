#include "rigel/problems/io/name_order.h"

#include <algorithm>
#include <cstddef>

namespace rigel {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool HasDigit(const std::string& name) { return std::any_of(name.begin(), name.end(), IsDigit); }

// The digits of `text` from `begin` on.
std::string_view Digits(std::string_view text, size_t begin) {
  size_t end = begin;
  while (end < text.size() && IsDigit(text[end])) ++end;
  return text.substr(begin, end - begin);
}

// Whether the digits at `begin` are those behind a decimal point.
bool AreDecimals(std::string_view text, size_t begin) {
  return begin >= 2 && text[begin - 1] == '.' && IsDigit(text[begin - 2]);
}

std::string_view WithoutZeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

// Negative, zero or positive, of numbers of any size.
int CompareNumbers(std::string_view a, std::string_view b) {
  a = WithoutZeros(a);
  b = WithoutZeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

}  // namespace

bool ComesBeforeByNumbers(std::string_view a, std::string_view b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string_view digits1 = Digits(a, i), digits2 = Digits(b, j);
      const int order = AreDecimals(a, i) && AreDecimals(b, j) ? digits1.compare(digits2)
                                                               : CompareNumbers(digits1, digits2);
      if (order != 0) return order < 0;
      i += digits1.size();
      j += digits2.size();
      continue;
    }
    if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    }
    ++i;
    ++j;
  }
  const bool ended = i < a.size() || j < b.size();
  return ended ? i == a.size() : a < b;
}

bool SortByNumbers(std::vector<std::string>* names) {
  std::sort(names->begin(), names->end());
  if (!std::all_of(names->begin(), names->end(), HasDigit)) return false;
  if (std::is_sorted(names->begin(), names->end(), ComesBeforeByNumbers)) return false;
  std::sort(names->begin(), names->end(), ComesBeforeByNumbers);
  return true;
}

}  // namespace rigel
