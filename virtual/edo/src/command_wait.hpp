#pragma once

#include <array>
#include <cstdint>

#include "joint_bus.hpp"

namespace metier::virtual_edo {

/// Waits until every addressed joint has raised its acknowledgement and dropped it again.
class CommandWait {
public:
    /// \param axes how many axes are awaited, of those in the mask
    void begin(std::uint64_t mask, std::size_t axes);

    /// One cycle's report. \return whether all have acknowledged
    bool take(const BusReport& report);

    /// One cycle. \return whether 10 s are over
    bool expired() { return ++age_ >= kLongestWait; }

private:
    static constexpr int kLongestWait = 1000;  // cycles
    enum class Phase : std::uint8_t { done, low, raised };

    std::array<Phase, kMostAxes> phases_{};
    int age_ = 0;
};

}  // namespace metier::virtual_edo
