#include "rigel/problems/rigs/json_members.h"

#include <cmath>
#include <stdexcept>

#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/json_text.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

const Json& Member(const Json& object, const std::string& key) {
  if (!object.is_object()) throw std::runtime_error(QuoteJson(object) + ", expected an object");
  const auto found = object.find(key);
  if (found == object.end()) throw std::runtime_error("the key '" + key + "' is missing");
  return *found;
}

}  // namespace

Json ParseJsonArray(const std::string& text) {
  Json json;
  try {
    json = ParseJson(text);
  } catch (const std::exception& exception) {
    throw std::runtime_error(JsonMessage(exception));
  }
  if (!json.is_array() || json.empty()) {
    throw std::runtime_error(QuoteJson(json) + ", expected an array of at least one object");
  }
  return json;
}

bool HasMember(const Json& object, const std::string& key) {
  return object.is_object() && object.contains(key);
}

std::string MemberText(const Json& object, const std::string& key) {
  const Json& member = Member(object, key);
  if (!member.is_string()) {
    throw std::runtime_error(key + " is " + QuoteJson(member) + ", expected a text");
  }
  return member.get<std::string>();
}

std::vector<double> MemberNumbers(const Json& object, const std::string& key, size_t count) {
  const Json& member = Member(object, key);
  std::vector<double> numbers;
  if (member.is_array()) {
    for (const Json& item : member) {
      if (item.is_number() && std::isfinite(item.get<double>())) {
        numbers.push_back(item.get<double>());
      }
    }
  }
  if (numbers.size() != count || member.size() != count) {
    throw std::runtime_error(key + " is " + QuoteJson(member) + ", expected " +
                             std::to_string(count) + " finite numbers");
  }
  return numbers;
}

}  // namespace rigel
