#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hand_driven_skill.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/queue.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"

namespace metier::opcua_skill::testing {

/// The transition events of one notifier, in order.
class TransitionWatch {
public:
    /// Content of one event; the fields of model.md, section 2.
    struct Seen {
        opcua::NodeId event_type;
        opcua::NodeId source;
        std::string source_name;
        UtcTime time;
        std::string message;
        std::uint16_t severity = 0;
        std::string from;
        opcua::NodeId from_id;
        std::uint32_t from_number = 0;
        std::string to;
        opcua::NodeId to_id;
        std::uint32_t to_number = 0;
        std::string transition;
        opcua::NodeId transition_id;
        std::uint32_t transition_number = 0;
        UtcTime transition_time;
        opcua::Value intermediate_result;
        std::string execution_id;
        std::int32_t reason = -1;
        std::string reason_text;
    };

    TransitionWatch(opcua::Client& client, const opcua::NodeId& notifier);
    /// The next event; nothing within 30 s.
    std::optional<Seen> next();
    /// "ReadyToRunning", or "nothing".
    std::string nextName();
    std::size_t overflows() const { return overflows_; }

private:
    // Shared with the callback, which may run until the subscription has ended.
    std::shared_ptr<Queue<Seen>> seen_ = std::make_shared<Queue<Seen>>(100'000);
    std::atomic<std::size_t> overflows_{0};
    opcua::Subscription subscription_;
};

/// A skill of the test's server.
struct ServedSkill {
    opcua::NodeId id;
    std::shared_ptr<Hand> hand;
    skill::Program* program = nullptr;

    opcua::NodeId node(std::string_view path) const;
};

/// A server with one motion device system made at run time, and clients on loopback.
class ServedSkills : public ::testing::Test {
protected:
    ServedSkills();

    /// Before serve().
    ServedSkill add(skill::SkillDescription description, skill::ProgramOptions options = {});
    void serve();
    /// Ends the skills and the server.
    void shutDown();
    std::unique_ptr<opcua::Client> connect(const std::string& name = "test client");

    opcua::Server& server() { return *server_; }
    SkillServer& skills() { return *skills_; }
    const MotionDeviceSystem& system() const { return system_; }

private:
    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<SkillServer> skills_;
    MotionDeviceSystem system_;
};

/// Calls a method of the skill; the StatusCode's name.
std::string call(opcua::Client& client, const ServedSkill& skill, std::string_view method);
/// Writes a Variable below the skill; the StatusCode's name.
std::string write(opcua::Client& client, const ServedSkill& skill, std::string_view path,
                  const opcua::Value& value);
/// The value of a Variable below the skill for people, or the StatusCode's name.
std::string read(opcua::Client& client, const ServedSkill& skill, std::string_view path);

/// The values of one Variable of the skill as T.
template <typename T>
T readAs(opcua::Client& client, const ServedSkill& skill, std::string_view path) {
    const auto value = client.read(skill.node(path));
    EXPECT_TRUE(value) << path << ": " << value.error().message;
    if (!value) {
        return T{};
    }
    const auto typed = value->template as<T>();
    EXPECT_TRUE(typed) << path << ": " << typed.error().message;
    return typed.value_or(T{});
}

}  // namespace metier::opcua_skill::testing
