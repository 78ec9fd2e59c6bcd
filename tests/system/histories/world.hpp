#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "../bench_server.hpp"
#include "hand_time.hpp"
#include "metier/skill/program_observer.hpp"
#include "model.hpp"
#include "tcp_relay.hpp"

namespace metier::system_tests {

/// A server with two skills, three clients that command it, carol through a relay, and one that
/// looks on. Time stands until a step moves it. The work of the skills do what steps say.
///
/// Threading: one thread takes steps.
class World final : public Taker {
public:
    World();
    ~World() override;
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// Brings it to where a history begins, whatever was before.
    /// \return the results of the executions before
    std::array<std::string, kSkills> beginAnew();

    std::string take(const Step& step) override;
    std::vector<std::string> seen() override;

private:
    struct Nodes {
        opcua::NodeId skill, target, speed, start, start_with, check, suspend, resume, halt, reset,
            get_execution;
    };
    class Emitted;
    /// One skill: what its work holds on the server's thread, and what the onlooker heard.
    struct Side {
        Nodes nodes;
        skill::Program* program = nullptr;
        skill::ExecutionHandle execution;
        double speed = 0;
        std::atomic<bool> fault_stays{false};
        std::unique_ptr<Emitted> emitted;
        std::vector<std::string> heard;  ///< guarded by mutex_
        std::size_t heard_count = 0;     ///< guarded by mutex_
        opcua::Subscription subscription;
    };

    void addSkill(std::size_t number);
    static skill::SkillFunctions functionsOf(Side& side, bool may_be_suspended);
    void findNodes();
    void connect(std::size_t client);
    void subscribe(Side& side);
    void hear(Side& side, const opcua::EventNotice& notice);
    std::string nameOf(const std::string& execution_id) const;

    static std::string write(opcua::Client& client, const Side& side, const Step& step);
    std::string command(const Step& step);
    std::string startWith(const Step& step);
    static std::string check(opcua::Client& client, const Side& side, const Step& step);
    std::string execution(opcua::Client& client, const Side& side, std::uint32_t name);
    std::string control(const Step& step);
    void happen(const Step& step);
    static std::vector<opcua::KeyValue> parametersOf(const StartChoice& choice);
    std::string fullName(std::uint32_t name) const;
    std::string lineOf(std::size_t skill, const std::vector<opcua::DataValue>& values) const;

    std::shared_ptr<HandTime> time_;
    std::array<Side, kSkills> sides_;  // also while the server closes its sessions
    BenchServer bench_;
    std::unique_ptr<testing::TcpRelay> relay_;
    std::array<std::unique_ptr<opcua::Client>, kClients> clients_;
    std::array<std::uint64_t, kClients> epochs_{};
    std::unique_ptr<opcua::Client> onlooker_;
    std::vector<opcua::ReadItem> looked_at_;
    std::map<Act, opcua::NodeId> control_nodes_;
    opcua::NodeId lock_;
    std::uint64_t history_ = 0;  ///< so that names of executions are new in each
    std::mutex mutex_;
    std::condition_variable changed_;
};

}  // namespace metier::system_tests
