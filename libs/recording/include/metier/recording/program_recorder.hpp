#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "metier/recording/path_sampler.hpp"
#include "metier/records/execution.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"

namespace metier::recording {

/// Makes a record of each execution of one Program. What begins and ends within kLater, and tells
/// nothing in between, is told to the recorder together with others of its kind: of one after the
/// other most of the cost would be to wait for memory.
///
/// Threading: the Program's owner. Nothing waits for a disk.
class ProgramRecorder final : private skill::ProgramObserver {
public:
    /// An execution is told at the latest so long after its begin and its end.
    static constexpr std::chrono::milliseconds kLater{50};

    /// What the records tell of their Program; texts may be empty.
    struct Place {
        std::string server_name{};  ///< as its cell file names it
        std::string controller{};   ///< BrowseName of what the Program belongs to
        std::string device{};       ///< the arm or gripper it moves
    };

    /// \param program  must outlive this, as the recorder and the sampler
    /// \param recorder with packedJson() as its to_json
    /// \param sampler  of the arm that the Program moves; null: it moves none
    ProgramRecorder(skill::Program& program, records::Recorder& recorder, PathSampler* sampler,
                    Place place);
    ~ProgramRecorder() override;
    ProgramRecorder(const ProgramRecorder&) = delete;
    ProgramRecorder& operator=(const ProgramRecorder&) = delete;

private:
    // Its transition, which follows at once, tells of it.
    void onBegin(const skill::ExecutionRecord& /*execution*/) override {}
    void onTransition(const skill::TransitionEvent& event) override;
    void onSubState(skill::SubState sub_state, std::string_view step) override;
    void onReason(skill::Reason /*reason*/, std::string_view /*text*/) override {}
    void onParameter(std::string_view /*name*/, const skill::Value& /*value*/) override {}
    void onResult(const skill::ValueMap& /*result*/) override {}
    void onProgress(const skill::Value& intermediate) override;
    void onDiagnostic(const skill::Diagnostic& /*diagnostic*/) override {}
    void onStarted(const skill::StartedExecution& child) override;
    void onCheck(const skill::Caller& caller, const skill::ValueMap& parameters,
                 const skill::CheckReport& report) override;

    void begin(const skill::ExecutionRecord& execution);
    void tellBegin(const skill::ExecutionRecord& execution, const std::string* check);
    void tellWhole(const skill::ExecutionRecord& execution);
    records::ExecutionView viewOf(const skill::ExecutionRecord& execution,
                                  const std::string* check);
    void tellUntold();
    void tellLater();
    bool isUnderWay() const;
    records::TransitionView transitionOf(const skill::TransitionEvent& event) const;
    std::string_view packedResult(skill::Reason reason, const skill::ValueMap& result);
    std::uint64_t endSampling();
    const std::string* checkOf(const skill::ExecutionRecord& execution) const;

    skill::Program& program_;
    records::Recorder& recorder_;
    PathSampler* sampler_;
    const Place place_;
    std::shared_ptr<const skill::ValueMap> parameters_{};  ///< that were told last
    std::string packed_parameters_{};                      ///< the same
    std::string packed_result_{};                          ///< that was told last

    records::Recorder::Key key_ = 0;  ///< of the execution that is under way; 0: none, or dropped
    bool begun_ = false;              ///< one of which nothing was told yet
    std::size_t untold_ = 0;          ///< executions before it that ended; the history has them
    std::optional<skill::Timer> later_;
    skill::State state_;  ///< that was told last
    skill::SubState sub_state_ = skill::SubState::none;
    std::string step_;
    /// What a session asked last before it starts.
    struct Checked {
        std::string session{};
        skill::ValueMap parameters{};
        std::string report{};  ///< JSON
    };
    Checked checked_;
};

}  // namespace metier::recording
