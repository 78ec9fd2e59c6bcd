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
    /// Name of the injection: "emergency-stop".
    std::string name;
    /// Its argument as text, in the unit that its help names; may be empty.
    std::string value;
};

/// An injection that a controller supports.
struct InjectionHelp {
    /// Name of the injection.
    std::string name;
    /// One line for a person; names the argument, its unit and range.
    std::string help;
    /// Performs it with the argument. Runs on the controller's thread; must not wait.
    /// Errors: invalid_argument.
    std::function<Result<void>(const std::string& value)> perform{};
};

/// An injection that needs no argument and cannot fail.
/// Its argument is ignored.
std::function<Result<void>(const std::string& value)> always(std::function<void()> act);

/// Performs the one of `known` that has the name. Threads: the controller's.
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
    /// Switches the power off and on: every connection breaks, every mode is the initial one. Does
    /// not wait.
    virtual void restart() = 0;
};

/// Request to make a virtual controller.
struct ControllerRequest {
    /// Context whose thread runs the controller; outlives it.
    asio::io_context& context;
    /// Name of the controller in the cell file, for messages and the world.
    std::string name;
    /// Address to listen on: "127.0.1.1".
    std::string address;
    /// Settings of the controller, which calls finish().
    cell::Settings settings;
    /// Model of the arm, outlives the controller; nullptr for other devices.
    const motion::RobotModel* model = nullptr;
    /// Faults of its cable; outlives the controller.
    LinkFaults& faults;
    /// The cell around it; outlives the controller.
    WorldLink& world;
};

/// One kind of virtual controller. To add one: docs/guide/add-a-robot.md.
struct ControllerType {
    /// Name in a cell file, unique: `type = "ur"`.
    std::string_view name;
    /// One line for a person: maker, controllers, protocol.
    std::string_view help;
    /// Opens the ports and serves once the io_context runs.
    /// Errors: invalid_argument (settings), already_exists (a port); others as the controller
    ///         states.
    Result<std::unique_ptr<Controller>> (*start)(const ControllerRequest& request);
};

/// Every type of virtual controller of this build, by name.
const std::vector<ControllerType>& controllerTypes();

}  // namespace metier::virtual_controller
