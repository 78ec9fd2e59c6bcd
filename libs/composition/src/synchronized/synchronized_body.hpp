#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "synchronized/arm_lane.hpp"
#include "metier/skill/execution.hpp"
#include "metier/skill/skill.hpp"

namespace metier::composition {

/// One execution: asks the arms, compares the clocks, lets them begin at one moment, and stops all
/// when one stops.
///
/// Threading: the owner's thread.
class SynchronizedBody final : public skill::Body, private LaneOwner {
public:
    struct Setup {
        const Options& options;
        std::vector<ArmLane::Setup> arms;
        double least_duration = 0.0;  ///< [s]
    };

    explicit SynchronizedBody(Setup setup);
    ~SynchronizedBody() override = default;
    SynchronizedBody(const SynchronizedBody&) = delete;
    SynchronizedBody& operator=(const SynchronizedBody&) = delete;

    void start(skill::Execution execution) override;
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
    using Answer = std::optional<LaneFailure>;
    using Ask = void (ArmLane::*)(std::function<void(Answer)>);

    void changed() override;
    void failed(LaneFailure failure) override;
    void suspendedByOther(const std::string& why) override;

    void dropOld();
    /// Asks all lanes that have not arrived; `then` once all have answered well.
    void askAll(Ask ask, void (SynchronizedBody::*then)());
    void askArms() { askAll(&ArmLane::ask, &SynchronizedBody::askClocks); }
    void askClocks() { askAll(&ArmLane::compareClocks, &SynchronizedBody::begin); }
    void begin();
    void checkBegun();
    void suspendLanes();
    void stop();
    void stopped();
    void deadlinePassed();
    void finish();
    bool all(bool (*holds)(const ArmLane&)) const;
    std::vector<const ArmLane*> measured() const;

    const Options& options_;
    const double least_duration_;
    std::vector<std::unique_ptr<ArmLane>> lanes_;
    std::vector<const ArmLane*> begun_lanes_;  // since Start, or the last Resume
    skill::Execution execution_;
    Phase phase_ = Phase::asking;
    bool rest_told_ = false;
    bool halting_ = false;
    std::optional<LaneFailure> failure_;
    std::uint64_t round_ = 0;  ///< answers to earlier questions are not waited for
    std::size_t pending_ = 0;
    std::uint64_t begun_ = 0;
    skill::Timer timer_;
};

/// What the arms' results say together.
Results resultsOf(const std::vector<const ArmLane*>& lanes);

}  // namespace metier::composition
