#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "rtde.hpp"
#include "wire.hpp"

namespace metier::ur_driver::rtde {

namespace {

constexpr std::string_view kNotFound = "NOT_FOUND";
// No arm is there or as fast, not even with a wrist that turns without end.
constexpr double kLargestPosition = 1000.0;  // [rad]
constexpr double kLargestVelocity = 100.0;   // [rad/s]

std::size_t sizeOf(std::string_view type) noexcept {
    return type == "VECTOR6D" ? 48 : type == "DOUBLE" ? 8 : 4;
}

bool allFinite(const Joints& values) noexcept {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void read(ByteReader& reader, double& value) noexcept {
    value = reader.float64();
}

void read(ByteReader& reader, Joints& values) noexcept {
    values = reader.float64s<kAxes>();
}

template <typename Word>
void read(ByteReader& reader, Word& value) noexcept {
    if constexpr (std::is_enum_v<Word>) {
        value = static_cast<Word>(reader.number<std::underlying_type_t<Word>>());
    } else {
        value = reader.number<Word>();
    }
}

bool allWithin(const Joints& values, double limit) noexcept {
    return std::all_of(values.begin(), values.end(),
                       [limit](double v) { return std::abs(v) <= limit; });
}

bool isPossible(const ControllerState& state) noexcept {
    return allWithin(state.target_q, kLargestPosition) &&
           allWithin(state.actual_q, kLargestPosition) &&
           allWithin(state.actual_qd, kLargestVelocity);
}

bool isFinite(const ControllerState& state) noexcept {
    return std::isfinite(state.timestamp) && std::isfinite(state.speed_scaling) &&
           std::isfinite(state.target_speed_fraction) && allFinite(state.target_q) &&
           allFinite(state.actual_q) && allFinite(state.actual_qd);
}

}  // namespace

OutputRecipe::OutputRecipe(std::int32_t register_base)
    : fields_{
          {&ControllerState::timestamp, Need::required, "timestamp", "DOUBLE", {}},
          {&ControllerState::target_q, Need::required, "target_q", "VECTOR6D", {}},
          {&ControllerState::actual_q, Need::required, "actual_q", "VECTOR6D", {}},
          {&ControllerState::actual_qd, Need::required, "actual_qd", "VECTOR6D", {}},
          {&ControllerState::robot_mode, Need::required, "robot_mode", "INT32", {}},
          {&ControllerState::safety_mode, Need::required, "safety_status", "INT32", "safety_mode"},
          {&ControllerState::runtime_state, Need::required, "runtime_state", "UINT32", {}},
          {&ControllerState::script_token,
           Need::required,
           fmt::format("output_int_register_{}", register_base),
           "INT32",
           {}},
          {&ControllerState::script_counter,
           Need::required,
           fmt::format("output_int_register_{}", register_base + 1),
           "INT32",
           {}},
          {&ControllerState::speed_scaling, Need::optional, "speed_scaling", "DOUBLE", {}},
          {&ControllerState::target_speed_fraction,
           Need::optional,
           "target_speed_fraction",
           "DOUBLE",
           {}},
      } {}

std::vector<std::string> OutputRecipe::names() const {
    std::vector<std::string> names;
    names.reserve(fields_.size());
    for (const Field& field : fields_) {
        names.push_back(field.name);
    }
    return names;
}

Result<void> OutputRecipe::check(const Field& field, std::string_view type) const {
    if (type == kNotFound && field.need == Need::required && field.instead.empty()) {
        return fail(Errc::not_supported,
                    fmt::format("this software does not offer {} over RTDE", field.name));
    }
    if (type != kNotFound && type != field.type) {
        return fail(Errc::not_supported,
                    fmt::format("RTDE offers {} as {}, not as {}", field.name, type, field.type));
    }
    return {};
}

void OutputRecipe::withoutMissing(const RecipeReply& reply) {
    std::vector<Field> found;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        Field& field = fields_[i];
        if (reply.types[i] == kNotFound) {
            if (field.instead.empty()) {
                continue;
            }
            field.name = std::exchange(field.instead, {});
        }
        found.push_back(std::move(field));
    }
    fields_ = std::move(found);
}

Result<bool> OutputRecipe::take(const RecipeReply& reply) {
    if (reply.types.size() != fields_.size()) {
        return fail(Errc::invalid_argument, fmt::format("{} types for {} RTDE variables",
                                                        reply.types.size(), fields_.size()));
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        METIER_TRY(check(fields_[i], reply.types[i]));
    }
    if (std::find(reply.types.begin(), reply.types.end(), kNotFound) != reply.types.end()) {
        withoutMissing(reply);
        return false;
    }
    if (reply.id == 0) {
        return fail(Errc::not_supported, "the controller refused the RTDE variables");
    }
    id_ = reply.id;
    return true;
}

Result<ControllerState> OutputRecipe::decode(std::span<const std::byte> payload) const {
    std::size_t expected = 1;
    for (const Field& field : fields_) {
        expected += sizeOf(field.type);
    }
    ByteReader reader(payload);
    const auto id = reader.uint8();
    if (payload.size() != expected || id != id_) {
        return fail(Errc::invalid_argument,
                    fmt::format("RTDE data of recipe {} with {} bytes, not of {} with {}", id,
                                payload.size(), id_, expected));
    }
    ControllerState state;
    for (const Field& field : fields_) {
        std::visit([&](auto target) { read(reader, state.*target); }, field.target);
    }
    if (!isFinite(state)) {
        return fail(Errc::invalid_argument, "RTDE data with a value that is not finite");
    }
    if (!isPossible(state)) {
        return fail(Errc::invalid_argument,
                    "RTDE data with a position or velocity that no arm has");
    }
    return state;
}

}  // namespace metier::ur_driver::rtde
