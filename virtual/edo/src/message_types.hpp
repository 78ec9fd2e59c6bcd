#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "software.hpp"

namespace metier::virtual_edo {

using Json = nlohmann::ordered_json;

/// One field of a message: `type` is a primitive of ROS ("uint8", "float32", "string", "bool"),
/// another message, or an array of either ("float32[]", "float32[7]",
/// "edo_core_msgs/JointState[]").
struct Field {
    std::string name;
    std::string type;
};

using Definitions = std::map<std::string, std::vector<Field>, std::less<>>;

/// Every message and service type of one release.
Definitions definitionsFor(const Software& software);

/// The message types of one release, and rosbridge's rules for JSON of them.
///
/// Threading: immutable, any thread.
/// Source: Comau/eDO_core_msgs (msg/, srv/); RobotWebTools/rosbridge_suite, message_conversion.py.
class MessageTypes {
public:
    explicit MessageTypes(const Software& software);

    /// Service types have two: "edo_core_msgs/ControlSwitch.Request" and ".Response".
    bool has(std::string_view type) const { return types_.contains(type); }

    /// Completes a message, with its fields in order: missing fields get their defaults. A message
    /// with an unknown field, or with a value of another type or beyond its range, is refused as a
    /// whole. An integer may stand for a float, a float never for an integer; uint8[] may be base64
    /// or a list. Errors: type_mismatch, with rosbridge's words; not_found (no such type).
    Result<Json> complete(std::string_view type, const Json& message) const;

    /// The arguments of a service call: an object as in complete(), or a list of the fields'
    /// values. Errors: as complete().
    Result<Json> completeArguments(std::string_view type, const Json& arguments) const;

private:
    struct Place {
        std::string_view root;  // type of the whole message
        std::string field;      // "target.joints_data"
    };

    Result<Json> completeValue(std::string_view type, const Json& value, const Place& place) const;
    Result<Json> completeArray(std::string_view type, const Json& value, const Place& place) const;
    Result<Json> completeObject(std::string_view type, const Json& value, const Place& place) const;
    Json defaultOf(std::string_view type) const;

    Definitions types_;
};

/// A number for JSON: NaN and infinity become null, as rosbridge sends them.
Json finiteOrNull(double value);

}  // namespace metier::virtual_edo
