#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/skill/executor.hpp"
#include "metier/skill/skill.hpp"

namespace metier::example {

/// A skill, and what it is for.
struct Offered {
    std::unique_ptr<skill::Skill> skill;
    /// Tasks by which others find it: "inspect".
    std::vector<std::string> terms;
};

/// The device of a program.
struct Device {
    /// BrowseName of the controller that has the skills.
    std::string name;
    /// One line for people.
    std::string description;
    /// Namespace of its skill types.
    std::string types;
    /// Makes its skills; their timers run on the executor, which is the server's thread.
    std::function<std::vector<Offered>(std::shared_ptr<skill::Executor>)> skills;
};

/// Serves the skills of a device on this machine until Ctrl-C; the argument is the port, 0 or none:
/// a free one. Prints "ready URL" once clients may connect.
/// \return exit status of the program
int serve(const Device& device, int argc, char** argv);

}  // namespace metier::example
