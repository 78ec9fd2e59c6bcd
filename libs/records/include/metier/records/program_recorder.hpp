#pragma once

#include <string>
#include <string_view>

#include "metier/records/execution_row.hpp"
#include "metier/records/path_sampler.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/program.hpp"

namespace metier::records {

/// Makes a record of each execution of one Program.
///
/// Threading: the Program's owner. Nothing waits for a disk.
///
/// A record begins with the transition from Ready to Running and ends with the one back to Ready or
/// to Halted. Between them every transition, every change of sub-state or step, every intermediate
/// result and every execution that the skill started on a server is added, with the wall clock of
/// this machine. The last answer of Check is added if it came from the same session and its values
/// are those of the Start.
class ProgramRecorder final : private skill::ProgramObserver {
public:
    /// Names under which the Program's records appear; may be empty.
    struct Place {
        /// Name of the server in the cell file.
        std::string server_name{};
        /// BrowseName of the object to which the Program belongs.
        std::string controller{};
        /// Name of the arm or gripper that it moves.
        std::string device{};
    };

    /// Observes the Program from now on.
    /// An execution that is under way already is not recorded: make it before the first Start.
    /// \param program must outlive this, as must the recorder and the sampler
    /// \param sampler of the arm that the Program moves; null: it moves none
    ProgramRecorder(skill::Program& program, Recorder& recorder, PathSampler* sampler, Place place);
    /// Ends the observation; an execution that is under way is recorded as Halted, error.
    /// Destroy it on the owner's thread, before the Program.
    ~ProgramRecorder() override;
    ProgramRecorder(const ProgramRecorder&) = delete;
    ProgramRecorder& operator=(const ProgramRecorder&) = delete;

private:
    // Calls of the Program, all on its owner's thread. Between two executions key_ is 0, and what
    // comes then is not recorded.
    // Its transition follows at once.
    void onTransition(const skill::TransitionEvent& event) override;
    void onSubState(skill::SubState sub_state, std::string_view step) override;
    void onProgress(const skill::Value& intermediate) override;
    void onStarted(const skill::StartedExecution& child) override;
    void onCheck(const skill::Caller& caller, const skill::ValueMap& parameters,
                 const skill::CheckReport& report) override;

    /// Takes names, caller, parameters and start time from the Program's own record of the
    /// execution.
    void begin(const skill::ExecutionRecord& execution);
    void add(const skill::TransitionEvent& event);
    /// Ends record and path; key_ is 0 afterwards.
    void end(Outcome outcome);
    std::string checkOf(const skill::ExecutionRecord& execution) const;

    skill::Program& program_;
    Recorder& recorder_;
    PathSampler* sampler_;
    const Place place_;

    Recorder::Key key_ = 0;  ///< key of the execution under way; 0: none, or it was dropped
    skill::State state_;     ///< after the last transition
    skill::SubState sub_state_ = skill::SubState::none;
    std::string step_;
    /// The last answer of Check.
    struct Checked {
        std::string session{};
        skill::ValueMap parameters{};
        std::string report{};  ///< JSON
    };
    Checked checked_;
};

}  // namespace metier::records
