#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/control.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::system_tests {

struct BenchOptions {
    std::string application_name = "metier";
    std::uint16_t port = 0;  ///< 0: a free one
    opcua::ServerLimits limits{};
    std::string application_uri = "urn:metier:server";
    std::optional<opcua::ServerSecurity> security{};  ///< none: that of a lab
    /// Both or none: time that is moved by hand. The clock must outlive the server.
    const Clock* clock = nullptr;
    /// Makes the executor of that time, which runs on the server's thread.
    std::function<std::shared_ptr<skill::Executor>(opcua::Server&)> executor{};
    /// Names of executions, kept beyond the server; empty: each skill keeps its own.
    std::shared_ptr<skill::ExecutionNames> names{};
};

/// A server in this process with the skills of one controller, made of functions, and its control.
/// A failure of the set-up throws std::runtime_error.
///
/// Threading: as opcua::Server; addSkill() and serve() on the thread that made it.
class BenchServer {
public:
    explicit BenchServer(BenchOptions options = {});
    ~BenchServer();
    BenchServer(const BenchServer&) = delete;
    BenchServer& operator=(const BenchServer&) = delete;

    /// Before serve(). The Programs have the controller's Control and share `resource`.
    skill::Program& addSkill(skill::SkillDescription description, skill::SkillFunctions functions,
                             skill::ProgramOptions options = {});
    void serve();

    opcua::Server& server() { return *server_; }
    skill::Control& control() { return *control_; }
    const opcua_skill::MotionDeviceSystem& system() const { return system_; }
    std::uint16_t port() const { return server_->port(); }
    std::string url() const { return server_->endpointUrl(); }
    /// A node of a skill, as "Options/SpeedOverride"; the skill itself for an empty path.
    opcua::NodeId node(std::string_view skill, std::string_view path = {}) const;
    /// A child of the controller, of namespace `uri`.
    opcua::NodeId controllerNode(std::string_view uri, std::vector<std::string> path);

    /// Runs work on the server's thread, and what it posts, and waits for it.
    template <typename Work>
    void onServer(Work work);

private:
    BenchOptions options_;
    SystemClock system_clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    std::shared_ptr<skill::Control> control_;  // shared with the Programs
    opcua_skill::MotionDeviceSystem system_;
};

/// The value of an Answer or a Result; throws its error.
template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    if constexpr (!std::is_void_v<typename Answer::value_type>) {
        return std::move(*answer);
    }
}

template <typename Work>
void BenchServer::onServer(Work work) {
    constexpr std::chrono::seconds patience{60};
    orThrow(server_->call(std::move(work), patience));
    orThrow(server_->call([] {}, patience));
}

/// A client of that name; throws if it cannot connect.
std::unique_ptr<opcua::Client> connectAs(const std::string& url, const std::string& name);

/// A joint move of two axes: TargetJointPosition (needed, [-100, 100] rad unless set otherwise),
/// MaxVelocity, SpeedOverride (0.5, [0, 1]), ToolFrame; results Duration and ReachedJointPosition.
skill::SkillDescription benchDescription(std::string name);

}  // namespace metier::system_tests
