#include "rigel/problems/rigs/yaml_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/rigs/calibration_text.h"

namespace rigel {
namespace {

bool IsKeyCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-';
}

// A line of OpenCV's YAML with a blank after the colon of its key.
std::string MendedLine(std::string line) {
  size_t begin = 0;
  while (begin < line.size() && line[begin] == ' ') ++begin;
  size_t end = begin;
  while (end < line.size() && IsKeyCharacter(line[end])) ++end;
  const bool lacks_blank = end > begin && end + 1 < line.size() && line[end] == ':' &&
                           line[end + 1] != ' ' && line[end + 1] != '\r';
  if (lacks_blank) line.insert(end + 1, " ");
  return line;
}

std::string Mended(const std::string& text) {
  constexpr std::string_view kDirective = "%YAML";
  if (text.compare(0, kDirective.size(), kDirective) != 0) return text;
  std::string mended;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    if (begin > 0) mended += MendedLine(text.substr(begin, end - begin));
    mended += '\n';
    begin = end + 1;
  }
  return mended;
}

void AddNumbers(const YAML::Node& node, const std::string& what, std::vector<double>* numbers) {
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) AddNumbers(item, what, numbers);
    return;
  }
  double number;
  if (!node.IsScalar() || !ParseFinite(node.Scalar(), &number)) {
    const std::string found = node.IsScalar() ? Quoted(node.Scalar()) : "no number";
    throw LineError(YamlLine(node), what + " has " + found + ", expected finite numbers");
  }
  numbers->push_back(number);
}

}  // namespace

YAML::Node ParseYaml(const std::string& text) {
  try {
    YAML::Node root = YAML::Load(Mended(text));
    if (!root.IsMap()) throw LineError(0, "not a list of keys and values, expected YAML with keys");
    return root;
  } catch (const YAML::Exception& exception) {
    throw LineError(exception.mark.is_null() ? 0 : exception.mark.line + 1,
                    exception.msg + ", expected YAML");
  }
}

int YamlLine(const YAML::Node& node) {
  return node.IsDefined() && !node.Mark().is_null() ? node.Mark().line + 1 : 0;
}

bool HasKey(const YAML::Node& map, const std::string& key) {
  return map.IsMap() && map[key].IsDefined();
}

YAML::Node YamlMember(const YAML::Node& map, const std::string& key) {
  if (!map.IsMap()) throw LineError(YamlLine(map), "expected keys and values, among them " + key);
  const YAML::Node& constant = map;  // the other operator adds the key
  const YAML::Node node = constant[key];
  if (!node.IsDefined()) throw LineError(YamlLine(map), "the key " + key + " is missing");
  return node;
}

std::string YamlWord(const YAML::Node& map, const std::string& key) {
  const YAML::Node node = YamlMember(map, key);
  if (!node.IsScalar()) throw LineError(YamlLine(node), key + ": expected a word");
  return node.Scalar();
}

double YamlNumber(const YAML::Node& map, const std::string& key) {
  return NumberOf(YamlWord(map, key), key, YamlLine(YamlMember(map, key)));
}

std::vector<double> YamlNumbers(const YAML::Node& map, const std::string& key) {
  const YAML::Node node = YamlMember(map, key);
  std::vector<double> numbers;
  AddNumbers(node.IsMap() ? YamlMember(node, "data") : node, key, &numbers);
  return numbers;
}

std::vector<double> YamlNumbers(const YAML::Node& map, const std::string& key, size_t count) {
  std::vector<double> numbers = YamlNumbers(map, key);
  if (numbers.size() != count) {
    throw LineError(YamlLine(YamlMember(map, key)), key + " has " + std::to_string(numbers.size()) +
                                                        " numbers, expected " +
                                                        std::to_string(count));
  }
  return numbers;
}

}  // namespace rigel
