// YAML of calibrations, also as OpenCV writes it.
//
// OpenCV's files begin with a line "%YAML:1.0", which is no YAML, and may leave out the blank after
// the colon of a key ("data:[1, 2]"). Both are mended; lines keep their numbers.
//
// Functions throw LineError with what was expected.
#ifndef RIGEL_PROBLEMS_RIGS_YAML_TEXT_H_
#define RIGEL_PROBLEMS_RIGS_YAML_TEXT_H_

#include <cstddef>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace rigel {

// The map at the root of the text.
YAML::Node ParseYaml(const std::string& text);

// The line of a node, from 1; 0 if it has none.
int YamlLine(const YAML::Node& node);

// Whether the map has the key.
bool HasKey(const YAML::Node& map, const std::string& key);

// The node of a key that must be there.
YAML::Node YamlMember(const YAML::Node& map, const std::string& key);

double YamlNumber(const YAML::Node& map, const std::string& key);
std::string YamlWord(const YAML::Node& map, const std::string& key);

// The finite numbers of a key. A matrix may be rows of numbers or OpenCV's map with `data`.
std::vector<double> YamlNumbers(const YAML::Node& map, const std::string& key);
std::vector<double> YamlNumbers(const YAML::Node& map, const std::string& key, size_t count);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_YAML_TEXT_H_
