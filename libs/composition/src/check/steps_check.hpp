#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/forecast.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/skill/executor.hpp"
#include "scope.hpp"

namespace metier::composition {

/// Asks the used skills of a composition, in the order in which its steps would run them, whether
/// they could be run; each from where the arms stand after the steps before. Nothing moves.
///
/// Values that are not known before the run make a note, never a refusal.
/// Threading: the owner's thread; nothing waits.
class StepsCheck {
public:
    struct Setup {
        const Composition& composition;
        BoundSkills& used;
        skill::Executor& executor;
    };

    /// \param setup  what it names must outlive this
    /// \param starts where arms stand at the beginning
    StepsCheck(Setup setup, skill::ValueMap parameters, const skill::ArmPositions& starts);
    ~StepsCheck();
    StepsCheck(const StepsCheck&) = delete;
    StepsCheck& operator=(const StepsCheck&) = delete;

    /// Begins. Once.
    /// \param longest time after which the answer is timeout
    /// \param done    called once, in this call or later, unless this ends before
    void start(std::chrono::nanoseconds longest, skill::CheckDone done);
    /// Gives the answer that nothing is known; nothing happens if it is given.
    void giveUp(const std::string& why);
    /// Whether the answer is given.
    bool over() const noexcept { return done_ == nullptr; }

private:
    struct Refusal {
        std::string text;
        std::string code;
        double fraction = 0.0;
    };
    /// Outcome of the check of a step, or of several.
    struct Finding {
        Forecast after;
        std::optional<Refusal> refusal{};
        double duration = 0.0;  ///< as far as known [s]
        bool sure = true;       ///< without a refusal: that it can be done
    };
    using Then = std::function<void(Finding)>;
    /// A step with what it is in, and what is known when it begins.
    struct Visit {
        const Step& step;
        std::string path;
        Forecast before;
    };
    using Findings = std::shared_ptr<std::vector<Finding>>;  // shared by the visits of branches

    void checkStep(const Step& step, const std::string& above, Forecast before, Then then);
    void inOrder(std::span<const Step> steps, const std::string& path, Finding so_far, Then then);

    void call(Visit visit, const Then& then);
    void ask(Visit visit, skill::ValueMap parameters, Then then);
    void answered(Visit visit, const Result<skill::CheckReport>& report, const Then& then);
    void refused(Visit visit, const skill::CheckReport& report, const Then& then);
    void unchecked(Visit visit, const std::string& why, const Then& then);

    void branches(Visit visit, Findings findings, const Then& then);
    Finding merged(const Visit& visit, const std::vector<Finding>& findings);
    static Forecast anyOf(Forecast before, const std::vector<Finding>& findings);
    Finding mergedAny(const Visit& visit, const std::vector<Finding>& findings);
    void fallback(Visit visit, std::size_t index, std::string refusals, Then then);
    void alsoLater(Visit visit, std::size_t index, Finding found, Then then);
    void choice(Visit visit, const Then& then);
    void eitherBranch(Visit visit, const Then& then);
    Finding oneOf(Finding one, Finding other);

    /// Rounds of a loop.
    struct Rounds {
        std::uint64_t most = 0;
        bool known = false;        ///< whether it will be just `most`
        bool needed = true;        ///< whether the first one will be in any case
        std::uint64_t number = 1;  ///< of the one that is checked
    };
    void loop(Visit visit, const Then& then);
    Result<Rounds> roundsOf(const Step& step) const;
    void round(Visit visit, Rounds rounds, Finding so_far, Then then);

    Finding impossible(const Visit& visit, const std::string& why) const;
    void note(std::string text);
    std::string describe(const Visit& visit) const;
    const UsedSkill& usedBy(const Step& step) const;
    void finish(Result<skill::CheckReport> report);

    Setup setup_;
    Scope scope_;
    Forecast begin_;
    skill::CheckDone done_;
    skill::Timer limit_;
    std::vector<std::string> notes_;
    std::size_t questions_ = 0;
    // Answers that come later ask it whether this is still there.
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace metier::composition
