#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/skill/execution_handle.hpp"
#include "metier/skill/skill.hpp"
#include "synchronized/arm_move.hpp"

namespace metier::composition {

/// One execution: asks the arms, compares the clocks, lets them begin at one moment, and stops all
/// when one stops.
///
/// Threading: the owner's thread.
class SynchronizedWork final : public skill::ExecutionWork, private ArmMoveOwner {
public:
    struct Setup {
        const Options& options;
        std::vector<ArmMove::Setup> arms;
        double least_duration = 0.0;  ///< [s]
    };

    explicit SynchronizedWork(Setup setup);
    ~SynchronizedWork() override = default;
    SynchronizedWork(const SynchronizedWork&) = delete;
    SynchronizedWork& operator=(const SynchronizedWork&) = delete;

    void start(skill::ExecutionHandle execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    enum class Phase {
        asking,    ///< arms and clocks; nothing moves
        moving,    ///< the arms wait for their moment, or move
        resting,   ///< coming to rest for Suspend, or at rest
        dropping,  ///< resetting what stands in the way of a new begin
        stopping,  ///< halting what runs
        over,
    };
    using Answer = std::optional<ArmFailure>;
    using Ask = void (ArmMove::*)(std::function<void(Answer)>);

    void changed() override;
    void failed(ArmFailure failure) override;
    void suspendedByOther(const std::string& why) override;

    void dropOld();
    /// Asks all arms that have not arrived; `then` once all have answered well.
    void askAll(Ask ask, void (SynchronizedWork::*then)());
    void askArms() { askAll(&ArmMove::ask, &SynchronizedWork::askClocks); }
    void askClocks() { askAll(&ArmMove::compareClocks, &SynchronizedWork::begin); }
    void begin();
    void checkBegun();
    void suspendArms();
    void stop();
    void stopped();
    void deadlinePassed();
    void finish();
    bool all(bool (*holds)(const ArmMove&)) const;
    std::vector<const ArmMove*> measured() const;

    const Options& options_;
    const double least_duration_;
    std::vector<std::unique_ptr<ArmMove>> arm_moves_;
    std::vector<const ArmMove*> begun_arms_;  // since Start, or the last Resume
    skill::ExecutionHandle execution_;
    Phase phase_ = Phase::asking;
    bool rest_reported_ = false;
    std::optional<ArmFailure> failure_;
    std::uint64_t round_ = 0;  ///< answers to earlier questions are not waited for
    std::size_t pending_ = 0;
    std::uint64_t begun_ = 0;
    skill::Timer timer_;
};

/// \param arms the names of all of them, which are the default
skill::FieldList<Parameters> parameterFields(std::vector<std::string> arms);
const skill::FieldList<Results>& resultFields();

/// Combines the results of all arms.
Results resultsOf(const std::vector<const ArmMove*>& arm_moves);

}  // namespace metier::composition
