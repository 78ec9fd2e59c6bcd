#include "cell_bench.hpp"

#include <chrono>
#include <future>
#include <utility>

#include "metier/opcua_skill/motion_device_system.hpp"

namespace metier::dashboard {

using namespace std::chrono_literals;
using system_tests::orThrow;

namespace {

opcua_skill::KinematicsData twoAxes() {
    opcua_skill::KinematicsData data;
    data.joint_frames = {{}, {.x = 0.5}};
    data.joint_axes = {{0, 0, 1}, {0, 0, 1}};
    data.min_joint_position = {-3, -3};
    data.max_joint_position = {3, 3};
    for (auto* list : {&data.max_joint_velocity, &data.max_joint_acceleration, &data.max_joint_jerk,
                       &data.max_cartesian_velocity, &data.max_cartesian_acceleration,
                       &data.max_cartesian_jerk}) {
        list->assign(2, 1.0);
    }
    data.cycle_time = 0.008;
    data.tool_frames = {"flange", "pen"};
    return data;
}

}  // namespace

skill::SkillFunctions SkillByHand::functions() {
    skill::SkillFunctions functions;
    functions.check = [this](const skill::ValueMap&) {
        const std::lock_guard lock(mutex_);
        return start_;
    };
    functions.start = [this](const skill::ValueMap&, const skill::ExecutionHandle& execution) {
        const std::lock_guard lock(mutex_);
        execution_ = execution;
    };
    functions.suspend = [this](const skill::ExecutionHandle& execution) {
        const std::lock_guard lock(mutex_);
        if (suspend_) {
            execution.atRest();
        }
        return suspend_;
    };
    functions.resume = [](const skill::ExecutionHandle&) { return Result<void>(); };
    functions.reset = [this]() -> Result<void> {
        const std::lock_guard lock(mutex_);
        ++resets_;
        if (slow_resets_ > 0) {
            --slow_resets_;
            return fail(Errc::timeout, "it finds its zero");
        }
        return reset_;
    };
    return functions;
}

skill::ExecutionHandle SkillByHand::execution() const {
    const std::lock_guard lock(mutex_);
    return execution_;
}

void SkillByHand::answerStart(Result<void> answer) {
    const std::lock_guard lock(mutex_);
    start_ = std::move(answer);
}

void SkillByHand::answerSuspend(Result<void> answer) {
    const std::lock_guard lock(mutex_);
    suspend_ = std::move(answer);
}

void SkillByHand::answerReset(Result<void> answer, int first) {
    const std::lock_guard lock(mutex_);
    reset_ = std::move(answer);
    slow_resets_ = first;
}

int SkillByHand::resets() const {
    const std::lock_guard lock(mutex_);
    return resets_;
}

ArmByHand::ArmByHand(system_tests::BenchOptions options, double stroke)
    : bench_(std::move(options)) {
    bench_.addSkill(system_tests::benchDescription("MoveSkill"), move_.functions());
    bench_.addSkill(system_tests::benchDescription("TurnSkill"), turn_.functions());
    auto& nodes = bench_.server().nodes();
    const auto& system = bench_.system();
    orThrow(opcua_skill::publishKinematics(nodes, system, twoAxes(),
                                           [this] { return measured().kinematics; }));
    orThrow(opcua_skill::publishArmFigures(
        nodes, system.kinematics,
        {.commanded_joint_position = [this] { return measured().commanded; },
         .cycle_jitter = [this] { return measured().jitter; },
         .flange_wrench = [this] { return measured().wrench; }}));
    if (stroke > 0.0) {
        orThrow(opcua_skill::publishGripperFigures(nodes, system.controller, {stroke, true},
                                                   [this] { return measured().gripper; }));
    }
}

void ArmByHand::measure(const std::function<void(Measured&)>& change) {
    const std::lock_guard lock(mutex_);
    change(measured_);
}

Measured ArmByHand::measured() const {
    const std::lock_guard lock(mutex_);
    return measured_;
}

std::shared_ptr<void> ArmByHand::keepBusy() {
    // Shared by the server's thread, which waits for its end.
    const auto ends = std::make_shared<std::promise<void>>();
    const auto begun = std::make_shared<std::promise<void>>();
    bench_.server().post([begun, ended = std::make_shared<std::future<void>>(ends->get_future())] {
        begun->set_value();
        ended->wait_for(30s);
    });
    begun->get_future().wait();
    return {nullptr, [ends](void*) { ends->set_value(); }};
}

CellBench::CellBench(Access access)
    : connector_{[this](const std::string&) -> Result<opcua::ClientOptions> {
                     const auto refusal = refuse_options_ ? refuse_options_() : std::nullopt;
                     return refusal ? fail(*refusal)
                                    : Result<opcua::ClientOptions>(client_options_);
                 },
                 [](const opcua::Failure&) { return std::string("; ask a person"); }},
      people_(connector_, watches_, access, clock_) {
    tabs_.open(shown_.id(), anybody());
}

void CellBench::watch(const CellServer& server) {
    watches_.add(server);
    awaitConnected(server.name);
}

void CellBench::awaitConnected(const std::string& server) {
    shown_.await("server", [&](const nlohmann::json& told) {
        return told.at("key") == server && told.at("connected") == true;
    });
}

}  // namespace metier::dashboard
