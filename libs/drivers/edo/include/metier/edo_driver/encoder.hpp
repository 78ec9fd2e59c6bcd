#pragma once

#include <array>
#include <string>
#include <string_view>

#include "metier/edo_driver/generation.hpp"
#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

// Encoders of the JSON texts for the rosbridge server. Fields that older software does not know are
// left out: missing fields keep their defaults, an unknown one would make the server drop the whole
// message. Threads: any; pure; all but SetPointText allocate. Source: docs/protocols/edo.md.

/// Announces a topic before its first message; `type` as "edo_core_msgs/JointInit".
std::string advertiseText(std::string_view topic, std::string_view type);
/// Subscribes to every message, sent as soon as it exists: no throttle, no fragments, no
/// compression.
std::string subscribeText(std::string_view topic, std::string_view type);
/// Calls /machine_bridge_sw_version_srv; its answer has the same id.
std::string softwareVersionCallText(std::string_view id);
/// Calls /algo_control_switch_srv, which takes or gives back control; see Generation.
/// \param mode mode of ControlSwitch, 0 to 255
std::string controlSwitchCallText(std::string_view id, int mode);
/// Discovers the joints (mode 0), on /bridge_init.
std::string initText(const JointLayout& layout);
/// Releases the brakes, on /bridge_jnt_reset.
std::string resetText(const JointLayout& layout, const ResetRequest& request);
/// Begins a joint motion that the robot plans, on /bridge_move.
std::string moveText(const JointLayout& layout, const JointMove& move);
/// Cancels all moves, on /bridge_move.
std::string cancelText();

/// Writes the text of a set-point into its own buffer, once per cycle.
///
/// Threading: one thread. write() does not allocate.
class SetPointText {
public:
    /// \param set_point finite values, layout.count() of them; not checked
    /// \return the text, valid until the next call
    std::string_view write(const Generation& generation, const JointLayout& layout,
                           const JointSetPoint& set_point) noexcept;

private:
    template <typename... Args>
    void append(fmt::format_string<Args...> format, const Args&... args) noexcept;
    void writeControlArray(const JointLayout& layout, const JointSetPoint& set_point) noexcept;
    void writeJointValue(const JointLayout& layout, const JointSetPoint& set_point) noexcept;

    // Seven joints take some 700 characters.
    std::array<char, 2048> buffer_{};
    std::size_t size_ = 0;
};

}  // namespace metier::edo_driver
