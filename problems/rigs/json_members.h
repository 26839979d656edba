// Members of JSON objects, for readers that throw std::exception with what was expected.
#ifndef RIGEL_PROBLEMS_RIGS_JSON_MEMBERS_H_
#define RIGEL_PROBLEMS_RIGS_JSON_MEMBERS_H_

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace rigel {

// The array that is the whole text.
nlohmann::ordered_json ParseJsonArray(const std::string& text);

bool HasMember(const nlohmann::ordered_json& object, const std::string& key);
std::string MemberText(const nlohmann::ordered_json& object, const std::string& key);
std::vector<double> MemberNumbers(const nlohmann::ordered_json& object, const std::string& key,
                                  size_t count);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_JSON_MEMBERS_H_
