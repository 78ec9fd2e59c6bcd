#include "square_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/kinematics.hpp"
#include "metier/path_evaluation/placement.hpp"
#include "metier/server/kinematics_conversion.hpp"
#include "second_try.hpp"

namespace metier::app {
namespace {

using client::SkillAddress;
using client::SkillHandle;
using path_evaluation::kCorners;
using path_evaluation::Square;

constexpr const char* kPtpType = "CartesianPtpMoveSkillType";
constexpr const char* kLinearType = "CartesianLinearMoveSkillType";
constexpr std::chrono::milliseconds kSampling{10};
constexpr std::chrono::seconds kLongestReset{5};

/// The measured path of the flange; filled by the client's thread.
class PathRecorder {
public:
    explicit PathRecorder(const motion::ChainDescription& chain) : kinematics_(chain) {}

    void add(const std::vector<double>& joints) {
        const auto position = motion::JointVector::from(joints);
        if (!position || position->size() != kinematics_.axisCount()) {
            return;
        }
        const auto pose = kinematics_.forward(*position);
        const std::lock_guard lock(mutex_);
        if (recording_) {
            positions_.push_back(pose.translation);
        }
    }

    void begin() {
        const std::lock_guard lock(mutex_);
        recording_ = true;
    }

    std::vector<Eigen::Vector3d> end() {
        const std::lock_guard lock(mutex_);
        recording_ = false;
        return std::move(positions_);
    }

private:
    const motion::Kinematics kinematics_;
    std::mutex mutex_;
    bool recording_ = false;
    std::vector<Eigen::Vector3d> positions_;
};

/// One arm on its way around one square.
class SquareRun {
public:
    SquareRun(opcua::Client& client, const SquareArm& arm, const SquareSettings& settings,
              const SquareProgress& progress)
        : client_(client), arm_(arm), settings_(settings), progress_(progress) {}

    Result<SquareResult> run() {
        METIER_TRY(prepare());
        progress_(0.0, "to the first corner");
        METIER_TRY(move(*ptp_, 0));
        return goAround();
    }

private:
    Result<void> prepare() {
        METIER_ASSIGN(nodes_, client::findKinematics(client_, arm_.linear));
        METIER_TRY(place());
        METIER_ASSIGN(ptp_, SkillHandle::open(client_, arm_.ptp));
        METIER_ASSIGN(linear_, SkillHandle::open(client_, arm_.linear));
        return {};
    }

    /// Knows nothing of the robot but what its server publishes.
    Result<void> place() {
        METIER_ASSIGN(const auto data, client::readKinematics(client_, nodes_));
        METIER_ASSIGN(const auto joints, client::readJointPosition(client_, nodes_));
        METIER_ASSIGN(const auto chain, server::toChain(data, joints));
        METIER_ASSIGN(square_, path_evaluation::placeSquare(chain, chain.home, settings_.side));
        // Shared with the subscription's callback.
        recorder_ = std::make_shared<PathRecorder>(chain);
        return {};
    }

    Result<void> move(SkillHandle& skill, std::size_t corner) {
        const skill::ValueMap target{{"TargetPosition", motion::toFrame(square_.corner(corner))}};
        METIER_ASSIGN(const auto result, tryToRun(skill, target));
        const auto deviation = result.find("LargestPathDeviation");
        if (&skill == &*linear_ && deviation != result.end()) {
            if (const auto* value = std::get_if<double>(&deviation->second)) {
                reported_deviation_ = std::max(reported_deviation_, *value);
            }
        }
        return {};
    }

    Result<skill::ValueMap> tryToRun(SkillHandle& skill, const skill::ValueMap& target) {
        for (int tries_left = settings_.second_tries;; --tries_left) {
            const auto deadline = std::chrono::steady_clock::now() + settings_.move_timeout;
            auto result = skill.run(target, deadline);
            if (result || result.error().code == Errc::cancelled || tries_left <= 0) {
                return result ? Result<skill::ValueMap>(std::move(*result)) : fail(result.error());
            }
            METIER_TRY(resetUntilReady(skill, kLongestReset));
        }
    }

    Result<SquareResult> goAround() {
        METIER_ASSIGN(const auto subscription,
                      client::subscribeJointPosition(
                          client_, nodes_, kSampling,
                          [recorder = recorder_](const auto& joints) { recorder->add(joints); }));
        METIER_ASSIGN(const auto missed_before, client::readMissedCycles(client_, nodes_));
        METIER_TRY(noteNow());
        const auto start = std::chrono::steady_clock::now();
        for (int lap = 0; lap < settings_.laps; ++lap) {
            METIER_TRY(goOneLap(lap));
        }
        const auto time = std::chrono::steady_clock::now() - start;
        METIER_TRY(noteNow());
        METIER_ASSIGN(const auto missed, client::readMissedCycles(client_, nodes_));
        return result(time, missed - missed_before);
    }

    Result<void> goOneLap(int lap) {
        for (std::size_t side = 1; side <= kCorners; ++side) {
            const auto sides_done = static_cast<double>(lap) * kCorners + static_cast<double>(side);
            METIER_TRY(move(*linear_, side));
            progress_(sides_done / (kCorners * static_cast<double>(settings_.laps)),
                      fmt::format("lap {} of {}, side {} of {}", lap + 1, settings_.laps, side,
                                  kCorners));
        }
        return {};
    }

    /// Takes the arm's place at a standstill into the recorded path.
    Result<void> noteNow() {
        METIER_ASSIGN(const auto joints, client::readJointPosition(client_, nodes_));
        recorder_->begin();
        recorder_->add(joints);
        return {};
    }

    SquareResult result(std::chrono::duration<double> time, std::uint64_t missed_cycles) {
        SquareResult result;
        result.path.name = arm_.name;
        result.path.square = square_;
        result.path.positions = recorder_->end();
        result.path.measurement = path_evaluation::measure(square_, result.path.positions);
        result.laps = settings_.laps;
        result.time = time;
        result.missed_cycles = missed_cycles;
        result.reported_deviation = reported_deviation_;
        return result;
    }

    opcua::Client& client_;
    const SquareArm& arm_;
    const SquareSettings& settings_;
    const SquareProgress& progress_;
    client::KinematicsNodes nodes_;
    Square square_;
    std::shared_ptr<PathRecorder> recorder_;
    std::optional<SkillHandle> ptp_;
    std::optional<SkillHandle> linear_;
    double reported_deviation_ = 0;
};

/// Takes a skill of that type, or else of one that is derived from it.
void take(const client::SkillAddress& skill, std::string_view type, client::SkillAddress& taken) {
    if (skill.type_name == type || (taken.name.empty() && skill.servesAs(type))) {
        taken = skill;
    }
}

}  // namespace

Result<std::vector<SquareArm>> findSquareArms(opcua::Client& client, const std::string& url,
                                              std::vector<Error>& left_out) {
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    std::map<std::string, SquareArm> by_controller;
    for (const auto& skill : skills) {
        auto& arm = by_controller[skill.controllerName()];
        take(skill, kPtpType, arm.ptp);
        take(skill, kLinearType, arm.linear);
    }
    std::vector<SquareArm> arms;
    for (auto& [controller, arm] : by_controller) {
        if (arm.ptp.name.empty() || arm.linear.name.empty()) {
            continue;
        }
        const auto nodes = client::findKinematics(client, arm.linear);
        if (!nodes && nodes.error().code == Errc::not_found) {
            left_out.push_back(
                {Errc::not_found, fmt::format("{}: {}", url, nodes.error().message)});
            continue;
        }
        if (!nodes) {
            return fail(nodes.error());
        }
        arm.name = nodes->device_name;
        arm.url = url;
        arms.push_back(std::move(arm));
    }
    return arms;
}

Result<SquareResult> runSquare(opcua::Client& client, const SquareArm& arm,
                               const SquareSettings& settings, const SquareProgress& progress) {
    return SquareRun(client, arm, settings, progress).run();
}

}  // namespace metier::app
