#include "metier/edo_driver/generation.hpp"

#include <array>
#include <charconv>
#include <compare>
#include <optional>

namespace metier::edo_driver {
namespace {

using Version = std::array<int, 3>;

constexpr Version kHoldState{2, 1, 0};  // in this version the state has the number 8
constexpr Version kLastClassic{3, 0, 1};
constexpr Version kFirstExternal{3, 1, 2};
constexpr int kLargestMajor = 3;  // largest known major version
constexpr int kHeldState = 8;

/// The three numbers behind the last underscore.
std::optional<Version> parse(std::string_view software) {
    software.remove_prefix(software.rfind('_') + 1);  // npos + 1 is 0
    Version version{};
    const char* at = software.data();
    const char* const end = at + software.size();
    for (std::size_t i = 0; i < version.size(); ++i) {
        if (i > 0 && (at == end || *at++ != '.')) {
            return std::nullopt;
        }
        const auto [next, error] = std::from_chars(at, end, version[i]);
        if (error != std::errc{} || version[i] < 0) {
            return std::nullopt;
        }
        at = next;
    }
    return version;
}

}  // namespace

std::string_view Generation::setPointTopic() const noexcept {
    return kind == Kind::classic ? "/algo_jnt_ctrl" : "/external_control";
}

std::string_view Generation::setPointType() const noexcept {
    return kind == Kind::classic ? "edo_core_msgs/JointControlArray" : "edo_core_msgs/JointValue";
}

Generation classicGeneration() noexcept {
    return {Generation::Kind::classic, 1, 2, 9};
}

Generation externalGeneration() noexcept {
    return {Generation::Kind::external, 2, 0, 10};
}

Result<Generation> generationOf(std::string_view software) {
    const auto version = parse(software);
    if (version && *version <= kLastClassic) {
        auto classic = classicGeneration();
        classic.taken_state = *version == kHoldState ? kHeldState : classic.taken_state;
        return classic;
    }
    if (version && *version >= kFirstExternal && (*version)[0] <= kLargestMajor) {
        return externalGeneration();
    }
    return fail(Errc::not_supported,
                fmt::format("software version '{}' is not known (known: up to 3.0.1, and 3.1.2 to "
                            "3.x); set `generation` to classic or external",
                            software));
}

}  // namespace metier::edo_driver
