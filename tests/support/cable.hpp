#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "metier/link/child_process.hpp"

namespace metier::system_tests {

/// A network cable between this process and the programs of its far end: a pair of virtual
/// interfaces and two network namespaces, which vanish with this process. Servers of this process
/// listen on its loopback addresses as ever; the far end reaches them by addressOf().
///
/// Threading: one thread, the one that starts the processes: it and its children, and threads that
/// it starts from then on, are in the near namespace.
class Cable {
public:
    /// Whether this user and this kernel allow it; else why not.
    static std::string obstacle();
    /// Throws if a step fails.
    Cable();

    /// The command, run at the far end.
    std::vector<std::string> atFarEnd(std::vector<std::string> command) const;
    /// Puts the calling thread there, and the threads that it starts from then on.
    void enterFarEnd() const;
    /// Address at which the far end reaches servers of this process.
    static constexpr const char* kNearAddress = "10.77.0.1";
    /// Address of a server of this process, as the far end sees it.
    static std::string addressOf(const std::string& url);

    void unplug();
    /// Lets nothing through in either direction.
    void dropEverything();
    /// Lets nothing through from the far end to here.
    void dropWhatComes();
    /// Loses packets at random.
    /// \param percent in each direction
    void lose(int percent);
    /// Makes data that is sent from here wait for its turn at this rate, in a queue of at most that
    /// length; more is lost. Lasts as long as the cable.
    void slowDown(int bits_per_second, std::chrono::milliseconds queue);
    /// Plugged in, and lets everything through.
    void restore();
    /// Packets that it lost so far, by lose() and by the drop...() since the last restore().
    std::string lossCounts() const;

private:
    link::ChildProcess far_end_;  // keeps the far namespace
};

}  // namespace metier::system_tests
