#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::dashboard {

/// Values that change all the time: joint positions, forces, safety, cycles, grippers, parts.
///
/// Threading: one thread at a time.
class LiveValues {
public:
    /// Measured joint positions [rad] of an arm, true at `time`; the velocity follows from them.
    void setJoints(const std::string& arm, const std::vector<double>& joints, UtcTime time);
    /// Half of a wrench: force [N] or torque [N m] along or about x, y, z.
    void setForce(const std::string& arm, const std::vector<double>& force) {
        setWrench(arm, 0, force);
    }
    void setTorque(const std::string& arm, const std::vector<double>& torque) {
        setWrench(arm, 3, torque);
    }
    /// Any other value of an arm by its name in the stream: "c", "jitter", "safety", "missed".
    void setOfArm(const std::string& arm, const std::string& name, nlohmann::json value);
    void setOfGripper(const std::string& gripper, const std::string& name, nlohmann::json value);
    void setPart(const std::string& part, nlohmann::json value);
    /// Removes the parts that are not in `present`.
    void keepParts(const nlohmann::json& present);

    /// All there is.
    nlohmann::json all(UtcTime now) const;
    /// Values that have changed since the last call; null if none has.
    nlohmann::json changes(UtcTime now);

private:
    struct Joints {
        std::vector<double> position;
        UtcTime time{};
    };
    void setWrench(const std::string& arm, std::size_t begin, const std::vector<double>& values);
    void set(const char* group, const std::string& key, const std::string& name,
             nlohmann::json value);

    std::map<std::string, Joints> joints_;
    std::map<std::string, std::array<double, 6>> wrenches_;
    nlohmann::json values_ = nlohmann::json::object();  // arms, grippers, parts
    nlohmann::json changed_ = nlohmann::json::object();
};

/// A number as it is sent: rounded to a millionth, so that it is short.
double rounded(double value);
nlohmann::json rounded(const std::vector<double>& values);

/// Which of `all` is the one of that index, where `kept` of them are kept, the first and the last
/// among them.
std::size_t thinned(std::size_t index, std::size_t kept, std::size_t all);

}  // namespace metier::dashboard
