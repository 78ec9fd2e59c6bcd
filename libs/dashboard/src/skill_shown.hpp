#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "metier/client/async_skill.hpp"
#include "metier/skill/field.hpp"

namespace metier::dashboard {

/// The arm that a skill moves.
struct MovedArm {
    std::string key{};  ///< empty: it moves none
    std::size_t axes = 0;
    std::vector<std::string> tools{};  ///< names of its tool frames
};

/// Description of a skill, from which the page makes a form.
nlohmann::json skillJson(const std::string& key, const std::string& server,
                         const client::AsyncSkill& skill, const MovedArm& arm);

nlohmann::json fieldJson(const skill::Field& field, const MovedArm& arm);

/// A value with frames, vectors and ranges as lists of numbers, however deep they are.
nlohmann::json inLists(const nlohmann::json& value);

/// Largest width of a gripper with these skills [m], from the range of their parameters; 0:
/// unknown.
double strokeIn(const nlohmann::json& skills);

}  // namespace metier::dashboard
