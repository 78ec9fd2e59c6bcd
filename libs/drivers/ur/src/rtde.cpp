#include "rtde.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "metier/base/text.hpp"
#include "wire.hpp"

namespace metier::ur_driver::rtde {

namespace {

Bytes package(PackageType type, const Bytes& payload) {
    Bytes bytes;
    ByteWriter writer(std::back_inserter(bytes));
    writer.number(static_cast<std::uint16_t>(kHeaderSize + payload.size()));
    writer.number(static_cast<std::uint8_t>(type));
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    return bytes;
}

tl::unexpected<Error> malformed(std::string_view what, std::size_t size) {
    return fail(Errc::invalid_argument, fmt::format("RTDE {} of {} bytes", what, size));
}

std::vector<std::string> typesIn(std::string_view text) {
    std::vector<std::string> types;
    for (const auto type : split(text, ',')) {
        types.push_back(printable(type));
    }
    return types;
}

}  // namespace

Result<std::optional<Package>> firstPackage(const StreamBuffer& buffer) {
    const auto bytes = buffer.received();
    if (bytes.size() < kHeaderSize) {
        return std::nullopt;
    }
    ByteReader reader(bytes);
    const auto size = reader.number<std::uint16_t>();
    const auto type = static_cast<PackageType>(reader.uint8());
    if (size < kHeaderSize) {
        return malformed("package", size);
    }
    if (bytes.size() < size) {
        return std::nullopt;
    }
    return Package{type, bytes.subspan(kHeaderSize, size - kHeaderSize)};
}

Bytes requestProtocolVersion() {
    Bytes payload;
    ByteWriter(std::back_inserter(payload)).number(kProtocolVersion);
    return package(PackageType::request_protocol_version, payload);
}

Bytes request(PackageType type) {
    return package(type, {});
}

Bytes setupOutputs(double frequency, const std::vector<std::string>& names) {
    Bytes payload;
    ByteWriter writer(std::back_inserter(payload));
    writer.float64(frequency);
    writer.text(fmt::format("{}", fmt::join(names, ",")));
    return package(PackageType::setup_outputs, payload);
}

Bytes setupInputs(const std::vector<std::string>& names) {
    Bytes payload;
    ByteWriter(std::back_inserter(payload)).text(fmt::format("{}", fmt::join(names, ",")));
    return package(PackageType::setup_inputs, payload);
}

Result<bool> parseAccepted(std::span<const std::byte> payload) {
    if (payload.size() != 1) {
        return malformed("acceptance", payload.size());
    }
    return payload[0] == std::byte{1};
}

Result<ControllerVersion> parseControllerVersion(std::span<const std::byte> payload) {
    ByteReader reader(payload);
    ControllerVersion version;
    version.major = reader.number<std::uint32_t>();
    version.minor = reader.number<std::uint32_t>();
    version.bugfix = reader.number<std::uint32_t>();
    version.build = reader.number<std::uint32_t>();
    if (!reader.ok()) {
        return malformed("controller version", payload.size());
    }
    return version;
}

Result<RecipeReply> parseRecipeReply(std::span<const std::byte> payload) {
    ByteReader reader(payload);
    RecipeReply reply;
    reply.id = reader.uint8();
    if (!reader.ok()) {
        return malformed("recipe", payload.size());
    }
    reply.types = typesIn(reader.restAsText());
    return reply;
}

Result<TextMessage> parseTextMessage(std::span<const std::byte> payload) {
    ByteReader reader(payload);
    TextMessage text;
    text.message = printable(reader.text(reader.uint8()));
    text.source = printable(reader.text(reader.uint8()));
    const auto level = reader.uint8();
    if (!reader.ok() || level > static_cast<std::uint8_t>(TextMessage::Level::info)) {
        return malformed("text message", payload.size());
    }
    text.level = static_cast<TextMessage::Level>(level);
    return text;
}

std::vector<std::string> setpointNames(std::int32_t register_base) {
    std::vector<std::string> names{fmt::format("input_int_register_{}", register_base),
                                   fmt::format("input_int_register_{}", register_base + 1)};
    for (std::int32_t axis = 0; axis < static_cast<std::int32_t>(kAxes); ++axis) {
        names.push_back(fmt::format("input_double_register_{}", register_base + axis));
    }
    return names;
}

Result<void> checkSetpointReply(const RecipeReply& reply, std::int32_t register_base) {
    const auto names = setpointNames(register_base);
    if (reply.types.size() != names.size()) {
        return fail(Errc::invalid_argument, fmt::format("{} types for {} input registers",
                                                        reply.types.size(), names.size()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view expected = i < 2 ? "INT32" : "DOUBLE";
        if (reply.types[i] == "IN_USE") {
            return fail(Errc::resource_unavailable,
                        fmt::format("{} is in use by another client of RTDE: end it or choose "
                                    "another register_base",
                                    names[i]));
        }
        if (reply.types[i] != expected) {
            return fail(Errc::not_supported,
                        fmt::format("{} is {}, not {}: this software may have fewer registers; "
                                    "choose another register_base",
                                    names[i], reply.types[i], expected));
        }
    }
    if (reply.id == 0) {
        return fail(Errc::not_supported, "the controller refused the input registers");
    }
    return {};
}

std::array<std::byte, kSetpointPackageSize> setpointPackage(std::uint8_t recipe_id,
                                                            const Setpoint& setpoint) noexcept {
    std::array<std::byte, kSetpointPackageSize> bytes{};
    ByteWriter writer(bytes.begin());
    writer.number(static_cast<std::uint16_t>(kSetpointPackageSize));
    writer.number(static_cast<std::uint8_t>(PackageType::data));
    writer.number(recipe_id);
    writer.number(setpoint.token);
    writer.number(setpoint.counter);
    for (const double position : setpoint.position) {
        writer.float64(position);
    }
    return bytes;
}

}  // namespace metier::ur_driver::rtde
