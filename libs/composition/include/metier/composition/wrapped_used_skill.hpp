#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "metier/composition/used_skill.hpp"

namespace metier::composition {

/// A used skill that passes everything on to another one, and that one's events to its listener. A
/// class derived from it overrides what it adds.
///
/// Threading: as UsedSkill.
class WrappedUsedSkill : public UsedSkill, protected UsedSkillListener {
public:
    const std::string& name() const override { return used_->name(); }
    const skill::SkillDescription& description() const override { return used_->description(); }
    std::string serverUrl() const override { return used_->serverUrl(); }
    std::string lacks() const override { return used_->lacks(); }
    Result<void> available() const override { return used_->available(); }
    skill::State state() const override { return used_->state(); }
    std::string reasonText() const override { return used_->reasonText(); }
    bool leftOver() const override { return used_->leftOver(); }
    bool runsOthers() const override { return used_->runsOthers(); }
    void check(const skill::CheckRequest& request, skill::CheckDone done) override {
        used_->check(request, std::move(done));
    }
    void compareClocks(std::function<void(Result<ClockOffset>)> done) override {
        used_->compareClocks(std::move(done));
    }
    Result<void> reset(UsedSkillListener& listener) override {
        listener_ = &listener;
        return used_->reset(*this);
    }
    void begin(skill::StartRequest request, UsedSkillListener& listener) override {
        listener_ = &listener;
        used_->begin(std::move(request), *this);
    }
    Result<void> suspend() override { return used_->suspend(); }
    Result<void> resume() override { return used_->resume(); }
    void halt() override { used_->halt(); }
    void release() override {
        listener_ = nullptr;
        used_->release();
    }

protected:
    /// \param used not null
    explicit WrappedUsedSkill(std::unique_ptr<UsedSkill> used) : used_(std::move(used)) {}

    UsedSkill& used() noexcept { return *used_; }
    const UsedSkill& used() const noexcept { return *used_; }

    void onReset(const Result<void>& outcome) override {
        if (listener_ != nullptr) {
            listener_->onReset(outcome);
        }
    }
    void onStopping(const UsedSkillStop& stop) override {
        if (listener_ != nullptr) {
            listener_->onStopping(stop);
        }
    }
    void onSuspended() override {
        if (listener_ != nullptr) {
            listener_->onSuspended();
        }
    }
    void onResumed() override {
        if (listener_ != nullptr) {
            listener_->onResumed();
        }
    }
    void onProgress(const skill::Value& intermediate) override {
        if (listener_ != nullptr) {
            listener_->onProgress(intermediate);
        }
    }
    void onRefused(skill::Method method, const Error& error) override {
        if (listener_ != nullptr) {
            listener_->onRefused(method, error);
        }
    }
    void onEnd(UsedSkillEnd end) override {
        if (auto* const listener = std::exchange(listener_, nullptr)) {
            listener->onEnd(std::move(end));
        }
    }

    /// Listener of the execution or Reset under way; nullptr: nobody listens.
    UsedSkillListener* listener_ = nullptr;

private:
    std::unique_ptr<UsedSkill> used_;
};

}  // namespace metier::composition
