#include "semantics.hpp"

#include <algorithm>

namespace metier::robot_files {

namespace {

std::pair<std::string, std::string> ordered(const std::string& first, const std::string& second) {
    return std::minmax(first, second);
}

}  // namespace

Semantics Semantics::read(XmlFile& file) {
    Semantics semantics;
    const auto robot = file.root();
    if (std::string_view(robot.name()) != "robot") {
        file.note(robot, "no SRDF file: its outermost element is not <robot>");
        return semantics;
    }
    for (const auto element : robot.children("group")) {
        semantics.readGroup(element);
    }
    for (const auto element : robot.children("group_state")) {
        semantics.readState(element);
    }
    for (const auto element : robot.children("disable_collisions")) {
        semantics.disabled_.insert(readPair(file, element));
    }
    for (const auto element : robot.children("enable_collisions")) {
        semantics.enabled_.insert(readPair(file, element));
    }
    for (const auto element : robot.children("disable_default_collisions")) {
        semantics.disabled_by_default_.insert(file.text(element, "link"));
    }
    return semantics;
}

void Semantics::readGroup(pugi::xml_node element) {
    if (const auto chain = element.child("chain")) {
        groups_.push_back({element.attribute("name").value(), chain.attribute("base_link").value(),
                           chain.attribute("tip_link").value()});
    }
}

void Semantics::readState(pugi::xml_node element) {
    std::map<std::string, double> joints;
    for (const auto joint : element.children("joint")) {
        // A joint of several axes has several values: none of ours.
        const auto value = numbersIn(joint.attribute("value").value());
        if (value && value->size() == 1) {
            joints.emplace(joint.attribute("name").value(), value->front());
        }
    }
    states_.emplace(element.attribute("name").value(), std::move(joints));
}

Semantics::Pair Semantics::readPair(XmlFile& file, pugi::xml_node element) {
    auto first = file.text(element, "link1");
    return ordered(std::move(first), file.text(element, "link2"));
}

const std::map<std::string, double>& Semantics::state(const std::string& name) const {
    static const std::map<std::string, double> none;
    const auto found = states_.find(name);
    return found == states_.end() ? none : found->second;
}

bool Semantics::isDisabled(const std::string& first, const std::string& second) const {
    const auto pair = ordered(first, second);
    if (disabled_.contains(pair)) {
        return true;
    }
    const bool by_default =
        disabled_by_default_.contains(first) || disabled_by_default_.contains(second);
    return by_default && !enabled_.contains(pair);
}

}  // namespace metier::robot_files
