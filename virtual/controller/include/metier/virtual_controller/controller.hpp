#pragma once

#include <asio/io_context.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/cell/settings.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/virtual_controller/link_faults.hpp"
#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_controller {

/// An act of a person or an accident that a controller suffers, named as for `metier virtual
/// inject`.
struct Injection {
    std::string name;   ///< such as "emergency-stop"
    std::string value;  ///< its argument as text; may be empty
};

struct InjectionHelp {
    std::string name;
    std::string help;  ///< one line; names the argument, its unit and range
    /// Performs it with the argument. Errors: invalid_argument.
    std::function<Result<void>(const std::string& value)> perform{};
};

/// An injection that needs no argument and cannot fail.
std::function<Result<void>(const std::string& value)> always(std::function<void()> act);

/// Performs the one of `known` that has the name.
/// Errors: not_found, with the known names; those of the injection.
Result<void> performOneOf(const std::vector<InjectionHelp>& known, const Injection& injection);

/// Virtual controller of a robot, gripper or sensor: uses the maker's wire protocol, but has no
/// device.
///
/// Threading: made, used and destroyed on the thread that runs its io_context.
class Controller {
public:
    virtual ~Controller() = default;

    /// Injections that it supports, in addition to the link faults, which every controller has.
    virtual std::vector<InjectionHelp> injections() const = 0;
    /// By itself it performs what injections() gives.
    /// Errors: not_found (no such injection), invalid_argument.
    virtual Result<void> inject(const Injection& injection) {
        return performOneOf(injections(), injection);
    }
    /// State seen from outside: modes, joint position [rad], width [m], ...
    virtual nlohmann::ordered_json state() const = 0;
    /// Switches the power off and on: every connection breaks, every mode is the initial one.
    virtual void restart() = 0;
};

/// Request to make a virtual controller.
struct ControllerRequest {
    asio::io_context& context;
    std::string name;
    std::string address;      ///< address to listen on, such as 127.0.1.1
    cell::Settings settings;  ///< settings of the controller, which calls finish()
    const motion::RobotModel* model = nullptr;  ///< model of the arm; nullptr for other devices
    LinkFaults& faults;                         ///< outlives the controller
    WorldLink& world;                           ///< outlives the controller
};

/// One kind of virtual controller. To add one: docs/guide/add-a-robot.md.
struct ControllerType {
    std::string_view name;  ///< name in a cell file: `type = "ur"`
    std::string_view help;
    Result<std::unique_ptr<Controller>> (*start)(const ControllerRequest& request);
};

/// Every type of virtual controller of this build, by name.
const std::vector<ControllerType>& controllerTypes();

}  // namespace metier::virtual_controller
