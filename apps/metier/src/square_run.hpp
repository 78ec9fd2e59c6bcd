#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/path_evaluation/drawing.hpp"

namespace metier::app {

/// An arm that a client found: its two skills for a square, whatever robot it is.
struct SquareArm {
    std::string name;  ///< name of its motion device
    std::string url;
    client::SkillAddress ptp;
    client::SkillAddress linear;
};

struct SquareSettings {
    int laps = 3;
    double side = 0.1;  ///< [m]
    /// Longest time for one move.
    std::chrono::seconds move_timeout{60};
    /// Number of further attempts after a failed move, each after a Reset. Only for trials in which
    /// nobody can be in the way.
    int second_tries = 0;
};

struct SquareResult {
    path_evaluation::DrawnPath path;
    int laps = 0;
    std::chrono::duration<double> time{};
    std::uint64_t missed_cycles = 0;
    double reported_deviation = 0;  ///< largest that the server itself measured [m]
};

/// \param fraction done, 0 to 1
using SquareProgress = std::function<void(double fraction, const std::string& text)>;

/// Every controller of a server that has both skills.
Result<std::vector<SquareArm>> findSquareArms(opcua::Client& client, const std::string& url,
                                              std::vector<Error>& left_out);

/// Places a square where the arm has room, goes to its first corner by PTP and around it by LIN.
/// Waits until it is done.
/// Errors: the first move that was refused or failed, with its reason.
Result<SquareResult> runSquare(opcua::Client& client, const SquareArm& arm,
                               const SquareSettings& settings, const SquareProgress& progress);

}  // namespace metier::app
