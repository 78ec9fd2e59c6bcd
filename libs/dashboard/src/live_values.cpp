#include "live_values.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "board.hpp"

namespace metier::dashboard {

using nlohmann::json;

double rounded(double value) {
    constexpr double kMillion = 1e6;
    return std::round(value * kMillion) / kMillion;
}

json rounded(const std::vector<double>& values) {
    auto list = json::array();
    for (const auto value : values) {
        list.push_back(rounded(value));
    }
    return list;
}

void LiveValues::set(const char* group, const std::string& key, const std::string& name,
                     json value) {
    auto& stored = values_[group][key][name];
    if (stored != value) {
        changed_[group][key][name] = value;
        stored = std::move(value);
    }
}

void LiveValues::setJoints(const std::string& arm, const std::vector<double>& joints,
                           UtcTime time) {
    auto& before = joints_[arm];
    const double elapsed = std::chrono::duration<double>(time - before.time).count();
    // Samples that are far apart belong to different motions, and give no velocity.
    constexpr double kLongest = 1.0;
    std::vector<double> velocity(joints.size(), 0.0);
    if (before.position.size() == joints.size() && elapsed > 0.0 && elapsed < kLongest) {
        for (std::size_t axis = 0; axis < joints.size(); ++axis) {
            velocity[axis] = (joints[axis] - before.position[axis]) / elapsed;
        }
    }
    before = {joints, time};
    set("arms", arm, "q", rounded(joints));
    set("arms", arm, "v", rounded(velocity));
}

void LiveValues::setWrench(const std::string& arm, std::size_t begin,
                           const std::vector<double>& values) {
    auto& wrench = wrenches_[arm];
    if (values.size() != wrench.size() / 2) {
        return;  // no wrench
    }
    std::copy(values.begin(), values.end(), wrench.begin() + static_cast<std::ptrdiff_t>(begin));
    set("arms", arm, "f", rounded({wrench.begin(), wrench.end()}));
}

void LiveValues::setOfArm(const std::string& arm, const std::string& name, json value) {
    set("arms", arm, name, std::move(value));
}

void LiveValues::setOfGripper(const std::string& gripper, const std::string& name, json value) {
    set("grippers", gripper, name, std::move(value));
}

void LiveValues::setPart(const std::string& part, json value) {
    auto& stored = values_["parts"][part];
    if (stored != value) {
        changed_["parts"][part] = value;
        stored = std::move(value);
    }
}

void LiveValues::keepParts(const json& present) {
    auto& parts = values_["parts"];
    for (auto part = parts.begin(); part != parts.end();) {
        if (present.contains(part.key())) {
            ++part;
        } else {
            changed_["parts"][part.key()] = nullptr;
            part = parts.erase(part);
        }
    }
}

json LiveValues::all(UtcTime now) const {
    auto values = values_;
    values["t"] = secondsOf(now);
    return values;
}

json LiveValues::changes(UtcTime now) {
    if (changed_.empty()) {
        return nullptr;
    }
    auto changed = std::exchange(changed_, json::object());
    changed["t"] = secondsOf(now);
    return changed;
}

std::size_t thinned(std::size_t index, std::size_t kept, std::size_t all) {
    return kept < 2 ? 0 : index * (all - 1) / (kept - 1);
}

}  // namespace metier::dashboard
