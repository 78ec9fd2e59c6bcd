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

/// One thing that a person or an accident does to a controller, as `metier virtual inject` names
/// it.
struct Injection {
    std::string name;   ///< as "emergency-stop"
    std::string value;  ///< its argument as text; may be empty
};

struct InjectionHelp {
    std::string name;
    std::string help;  ///< one line; names the argument, its unit and range
};

/// The controller of a robot, gripper or sensor, without the device: speaks the maker's wire.
///
/// Threading: made, used and destroyed on the thread that runs its io_context.
class Controller {
public:
    virtual ~Controller() = default;

    /// What it can be asked to suffer, beyond the link faults, which every controller has.
    virtual std::vector<InjectionHelp> injections() const = 0;
    /// Errors: not_found (no such injection), invalid_argument.
    virtual Result<void> inject(const Injection& injection) = 0;
    /// What can be seen of it from outside: modes, joint position [rad], width [m], ...
    virtual nlohmann::ordered_json state() const = 0;
    /// As switching the power off and on: every connection breaks, every mode is the first one.
    virtual void restart() = 0;
};

/// What a virtual controller is made from.
struct ControllerRequest {
    asio::io_context& context;
    std::string name;
    std::string address;                        ///< to listen on, as 127.0.1.1
    cell::Settings settings;           ///< the controller's own; it calls finish()
    const motion::RobotModel* model = nullptr;  ///< of the arm; nullptr for other devices
    LinkFaults& faults;                         ///< outlives the controller
    WorldLink& world;                           ///< outlives the controller
};

/// One kind of virtual controller. To add one: docs/guide/add-a-robot.md.
struct ControllerType {
    std::string_view name;  ///< as in `type = "ur"`
    std::string_view help;
    Result<std::unique_ptr<Controller>> (*start)(const ControllerRequest& request);
};

/// Every virtual controller that was built, by name.
const std::vector<ControllerType>& controllerTypes();

}  // namespace metier::virtual_controller
