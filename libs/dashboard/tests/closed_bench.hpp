#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "cell_bench.hpp"
#include "metier/opcua/security.hpp"

namespace metier::dashboard {

/// A closed server that lets in anna, who may command, and otto, who may look, both with the
/// password "secret"; and the identity of a dashboard that it trusts. Throws if it cannot be made.
class ClosedArm {
public:
    ClosedArm();
    ~ClosedArm();

    ArmByHand& arm() { return *arm_; }
    std::string url() const { return arm_->url(); }
    /// As the dashboard connects by itself.
    opcua::ClientOptions options() const;
    /// How often somebody gave a name and a password.
    int attempts() const { return attempts_; }

private:
    Result<opcua::Admission> admit(const opcua::Login& login);

    const std::filesystem::path folder_;
    std::atomic<int> attempts_ = 0;
    std::optional<ArmByHand> arm_;
};

}  // namespace metier::dashboard
