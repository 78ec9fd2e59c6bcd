#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "metier/composition/definition.hpp"
#include "metier/skill/state.hpp"

namespace metier::composition {

class Run;

/// Why a step failed.
struct StepFailure {
    enum class Kind {
        failed,
        final,      ///< neither tried again nor replaced: a client halted it, or it does not stop
        cancelled,  ///< the composed skill halted it
    };
    skill::Reason reason = skill::Reason::error;
    std::string text{};
    Kind kind = Kind::failed;
};

inline StepFailure cancelled() {
    return {skill::Reason::by_client, "halted", StepFailure::Kind::cancelled};
}

/// Outcome of a step: nothing if it succeeded.
using Outcome = std::optional<StepFailure>;
using OnEnd = std::function<void(Outcome)>;

/// One step under way.
///
/// It ends exactly once, after all steps below it have ended, and reports that in a later turn of
/// the Run. Its owner destroys it then. Threading: the owner's thread.
class Activity {
public:
    /// \param path of the step, with what it is in: "prepare/open"
    Activity(Run& run, const Step& step, std::string path, OnEnd on_end)
        : run_(run), step_(step), path_(std::move(path)), on_end_(std::move(on_end)) {}
    virtual ~Activity() = default;
    Activity(const Activity&) = delete;
    Activity& operator=(const Activity&) = delete;

    /// Once.
    virtual void start() = 0;
    /// Has what runs come to its end soon; the end follows all the same.
    virtual void halt() = 0;
    /// 0 to 1.
    virtual double progress() const = 0;

protected:
    void end(Outcome outcome);
    /// Failure of this step, whose path the text names.
    StepFailure failed(std::string_view why, skill::Reason reason = skill::Reason::error) const;

    Run& run_;
    const Step& step_;
    const std::string path_;

private:
    OnEnd on_end_;
};

/// Makes the activity that runs a step, with its attempts and time limit.
std::unique_ptr<Activity> makeActivity(Run& run, const Step& step, const std::string& above,
                                       OnEnd on_end);

/// "prepare/open"
std::string pathOf(const std::string& above, const std::string& name);

}  // namespace metier::composition
