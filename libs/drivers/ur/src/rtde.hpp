#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controller_state.hpp"
#include "metier/base/error.hpp"
#include "stream_buffer.hpp"

/// The real-time data exchange of Universal Robots, version 2: bytes, no socket.
/// Source of every layout: docs/protocols/ur.md#rtde.
namespace metier::ur_driver::rtde {

inline constexpr std::uint16_t kProtocolVersion = 2;
inline constexpr std::size_t kHeaderSize = 3;
/// No package is longer: its size is a uint16.
inline constexpr std::size_t kMaxPackageSize = 65535;

enum class PackageType : std::uint8_t {
    request_protocol_version = 'V',
    get_controller_version = 'v',
    text_message = 'M',
    data = 'U',
    setup_outputs = 'O',
    setup_inputs = 'I',
    start = 'S',
    pause = 'P',
};

using Bytes = std::vector<std::byte>;

/// One package as it came; its payload points into the buffer it was taken from.
struct Package {
    PackageType type{};
    std::span<const std::byte> payload;
};

/// The first package of the buffer; nothing if it is not complete yet.
/// `buffer` still holds it: consume(kHeaderSize + payload.size()) when it was read.
/// Errors: invalid_argument if the size is no size. Without an error nothing allocates.
Result<std::optional<Package>> firstPackage(const StreamBuffer& buffer);

// ---- what a client sends ----
Bytes requestProtocolVersion();
/// A package without content: get_controller_version, start, pause.
Bytes request(PackageType type);
/// \param frequency of the data packages [Hz]
Bytes setupOutputs(double frequency, const std::vector<std::string>& names);
Bytes setupInputs(const std::vector<std::string>& names);

// ---- answers of a controller. Errors of all: invalid_argument, the package is malformed ----
/// Parses the answer to requestProtocolVersion, start and pause.
Result<bool> parseAccepted(std::span<const std::byte> payload);

struct ControllerVersion {
    std::uint32_t major = 0;
    std::uint32_t minor = 0;
    std::uint32_t bugfix = 0;
    std::uint32_t build = 0;
};
Result<ControllerVersion> parseControllerVersion(std::span<const std::byte> payload);

/// Answer to setupOutputs and setupInputs.
struct RecipeReply {
    std::uint8_t id = 0;  ///< 0: not valid
    /// One per name that was asked for: a type, NOT_FOUND or IN_USE.
    std::vector<std::string> types;
};
Result<RecipeReply> parseRecipeReply(std::span<const std::byte> payload);

struct TextMessage {
    enum class Level : std::uint8_t { exception = 0, error = 1, warning = 2, info = 3 };
    Level level{};
    std::string message;
    std::string source;
};
Result<TextMessage> parseTextMessage(std::span<const std::byte> payload);

/// Variables that the controller is asked to send, and the decoder of its data packages.
class OutputRecipe {
public:
    /// Begins with all variables that the driver can use.
    /// \param register_base as in Setpoint
    explicit OutputRecipe(std::int32_t register_base);

    std::vector<std::string> names() const;

    /// Takes the answer to setupOutputs(names()).
    /// \return whether the recipe is in force; if not, names() are now the ones to ask for instead,
    ///         since older software does not know all
    /// Errors: not_supported if a variable is missing that the driver needs (the text names it),
    ///         invalid_argument if the answer does not fit the question.
    Result<bool> take(const RecipeReply& reply);

    /// Errors: invalid_argument (another recipe, another size, a value that is not finite).
    /// Without an error nothing allocates.
    Result<ControllerState> decode(std::span<const std::byte> payload) const;

private:
    enum class Need : std::uint8_t { required, optional };
    /// Destination of a value.
    using Target = std::variant<double ControllerState::*, Joints ControllerState::*,
                                std::int32_t ControllerState::*, RobotMode ControllerState::*,
                                SafetyMode ControllerState::*, RuntimeState ControllerState::*>;
    struct Field {
        Target target;
        Need need;
        std::string name;
        std::string_view type;
        std::string instead;  ///< name to ask for if there is no such name; empty: none
    };

    Result<void> check(const Field& field, std::string_view type) const;
    void withoutMissing(const RecipeReply& reply);

    std::vector<Field> fields_;
    std::uint8_t id_ = 0;
};

/// Values that the script on the controller reads in each of its steps.
struct Setpoint {
    std::int32_t token = 0;    ///< the script goes on as long as it finds its own here
    std::int32_t counter = 0;  ///< changes with each set-point
    Joints position{};         ///< [rad]
};

/// The registers of a Setpoint: integer register base is the token, base + 1 the counter; double
/// registers base to base + 5 are the position.
std::vector<std::string> setpointNames(std::int32_t register_base);
/// Errors: resource_unavailable if another client holds one of them, not_supported if one does not
///         exist, invalid_argument; the text names it.
Result<void> checkSetpointReply(const RecipeReply& reply, std::int32_t register_base);

inline constexpr std::size_t kSetpointPackageSize =
    kHeaderSize + 1 + 2 * sizeof(std::int32_t) + kAxes * sizeof(double);
/// The package that writes it. Does not allocate.
std::array<std::byte, kSetpointPackageSize> setpointPackage(std::uint8_t recipe_id,
                                                            const Setpoint& setpoint) noexcept;

}  // namespace metier::ur_driver::rtde
