#pragma once

#include <chrono>
#include <map>
#include <string>

#include "commands.hpp"
#include "metier/skill/state.hpp"

namespace metier::app {

/// Options of a command for the loss of its client.
struct OwnerOptions {
    std::string on_loss = "default";
    std::uint32_t lease_ms = 0;  ///< 0: none is asked for

    skill::OwnerLossAction action() const {
        static const std::map<std::string, skill::OwnerLossAction> kActions{
            {"default", skill::OwnerLossAction::skill_default},
            {"halt", skill::OwnerLossAction::halt},
            {"suspend", skill::OwnerLossAction::suspend},
            {"continue", skill::OwnerLossAction::keep_going}};
        return kActions.at(on_loss);
    }
    std::chrono::milliseconds lease() const { return std::chrono::milliseconds(lease_ms); }
};

/// Adds --on-loss and --lease. \param lease_help ends with the default
inline void addOwnerOptions(CLI::App& command, OwnerOptions& options,
                            const std::string& lease_help) {
    command
        .add_option(
            "--on-loss", options.on_loss,
            "What running skills do when this client is gone; default: what each skill does "
            "by itself")
        ->check(CLI::IsMember({"default", "halt", "suspend", "continue"}))
        ->capture_default_str();
    command.add_option("--lease", options.lease_ms, lease_help)
        ->transform(
            CLI::AsNumberWithUnit(std::map<std::string, std::uint32_t>{{"ms", 1}, {"s", 1000}},
                                  CLI::AsNumberWithUnit::CASE_SENSITIVE, "ms or s"))
        ->check(CLI::Range(100, 3'600'000));
}

}  // namespace metier::app
