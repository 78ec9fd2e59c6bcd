#pragma once

#include "metier/iiwa_driver/wire.hpp"

namespace metier::iiwa_driver {

/// Decides by the cabinet's states whether the arm may move. The protocol has no safety state, only
/// "ready to move", which is 0 in every stop, without drives and without the enabling switch.
///
/// It is not documented whether a cabinet stays ready while it moves: that is learned from its
/// states.
/// Threading: one thread, the cycle. Nothing allocates.
class Readiness {
public:
    /// \param step since the answer before [s]
    void take(const CabinetState& answer, double step) noexcept;
    bool notReady() const noexcept { return not_ready_; }

private:
    bool ready_while_moving_ = false;  ///< seen on this connection
    double missing_ = 0.0;             ///< [s]
    bool not_ready_ = false;
};

}  // namespace metier::iiwa_driver
