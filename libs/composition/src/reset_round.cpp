#include "reset_round.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "run.hpp"

namespace metier::composition {

namespace {

constexpr std::chrono::milliseconds kPause{100};

}  // namespace

/// The Reset of one skill.
class ResetRound::One final : public UsedSkillListener {
public:
    One(Run& run, BoundSkill& used, ResetRound& round) : run_(run), used_(used), round_(round) {}
    ~One() override { used_.skill->release(); }
    One(const One&) = delete;
    One& operator=(const One&) = delete;

    /// \return whether its outcome is still to come
    bool ask() {
        const auto asked = used_.skill->reset(*this);
        return asked || again(asked.error());
    }

    void onReset(const Result<void>& outcome) override {
        run_.enter([this, outcome] {
            used_.halted_by_us = used_.halted_by_us && !outcome;
            if (outcome || !again(outcome.error())) {
                round_.ended(*this);
            }
        });
    }

private:
    /// A device that takes longer than its server waits for it is asked again, and an arm that has
    /// yet to come to rest.
    bool again(const Error& error) {
        if (error.code != Errc::timeout && error.code != Errc::resource_unavailable) {
            return false;
        }
        pause_ = run_.after(kPause, [this] {
            if (!ask()) {
                round_.ended(*this);
            }
        });
        return true;
    }

    Run& run_;
    BoundSkill& used_;
    ResetRound& round_;
    skill::Timer pause_;
};

ResetRound::ResetRound(Run& run, std::function<void()> done) : run_(run), done_(std::move(done)) {}
ResetRound::~ResetRound() = default;

void ResetRound::start(BoundSkills& skills) {
    for (auto& [alias, bound] : skills) {
        const auto& used = *bound.skill;
        if (!(bound.halted_by_us || used.leftOver()) || !used.available() ||
            used.state() != skill::State::halted) {
            continue;
        }
        auto one = std::make_unique<One>(run_, bound, *this);
        if (one->ask()) {
            open_.push_back(std::move(one));
        }
    }
    limit_ = run_.after(run_.restTime(), [this] { end(); });
    if (open_.empty()) {
        end();
    }
}

void ResetRound::ended(const One& one) {
    std::erase_if(open_, [&](const auto& open) { return open.get() == &one; });
    if (open_.empty()) {
        end();
    }
}

void ResetRound::end() {
    limit_.cancel();
    open_.clear();
    run_.later(std::exchange(done_, nullptr));
}

}  // namespace metier::composition
