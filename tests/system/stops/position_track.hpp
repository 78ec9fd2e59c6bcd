#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/opcua/client.hpp"

namespace metier::system_tests {

/// Measured positions of an arm with the times at which its server sampled them, from a connection
/// of its own.
///
/// Threading: one owner; the client's thread adds positions.
class PositionTrack {
public:
    /// \param url of the server that has the arm itself, not of a component
    /// \param skill any skill of that server that moves the arm
    /// Throws if it cannot watch the arm.
    PositionTrack(const std::string& url, const std::string& skill);

    /// Forgets what came before the newest position.
    void restart();
    /// The first time from which on the arm was where it rests, within 1 mrad in each axis. Call it
    /// once the arm rests; waits until its server has sampled it there, at most a minute.
    UtcTime restSince();

private:
    struct Sample {
        UtcTime time;
        std::vector<double> position;  ///< [rad]
    };
    // Shared with the callback, which may run until the subscription has ended.
    struct Samples {
        std::mutex mutex;
        std::condition_variable came;
        std::vector<Sample> taken;
    };

    std::unique_ptr<opcua::Client> client_;
    client::KinematicsNodes nodes_;
    std::shared_ptr<Samples> samples_ = std::make_shared<Samples>();
    opcua::Subscription subscription_;
};

}  // namespace metier::system_tests
