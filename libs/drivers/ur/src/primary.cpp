#include "primary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "wire.hpp"

namespace metier::ur_driver::primary {

namespace {

constexpr std::uint8_t kRobotState = 16;
constexpr std::uint8_t kRobotMessage = 20;

enum class SubPackage : std::uint8_t { kinematics = 5, configuration = 6 };
enum class Message : std::uint8_t {
    text = 0,
    version = 3,
    safety = 5,
    error = 6,
    runtime_exception = 10,
};

tl::unexpected<Error> malformed(std::string_view what, std::size_t size) {
    return fail(Errc::invalid_argument, fmt::format("primary {} of {} bytes", what, size));
}

bool allFinite(const Joints& values) noexcept {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

Result<void> readKinematics(ByteReader reader, Package& package) {
    const auto size = reader.remaining();
    Kinematics kinematics;
    reader.take(kAxes * sizeof(std::uint32_t));  // checksums
    kinematics.theta = reader.float64s<kAxes>();
    kinematics.a = reader.float64s<kAxes>();
    kinematics.d = reader.float64s<kAxes>();
    kinematics.alpha = reader.float64s<kAxes>();
    if (!reader.ok() || !allFinite(kinematics.theta) || !allFinite(kinematics.a) ||
        !allFinite(kinematics.d) || !allFinite(kinematics.alpha)) {
        return malformed("kinematics", size);
    }
    package.kinematics = kinematics;
    return {};
}

Result<void> readConfiguration(ByteReader reader, Package& package) {
    const auto size = reader.remaining();
    Configuration configuration;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        configuration.lower[axis] = reader.float64();
        configuration.upper[axis] = reader.float64();
    }
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        configuration.max_velocity[axis] = reader.float64();
        configuration.max_acceleration[axis] = reader.float64();
    }
    reader.take((5 + 4 * kAxes) * sizeof(double));  // defaults of motions, nominal DH parameters
    reader.take(3 * sizeof(std::int32_t));  // masterboard version, controller box, type of arm
    if (!reader.ok() || !allFinite(configuration.lower) || !allFinite(configuration.upper) ||
        !allFinite(configuration.max_velocity) || !allFinite(configuration.max_acceleration)) {
        return malformed("configuration", size);
    }
    package.configuration = configuration;
    return {};
}

Result<void> readSubPackage(std::uint8_t type, std::span<const std::byte> body, Package& package) {
    switch (static_cast<SubPackage>(type)) {
        case SubPackage::kinematics:
            return readKinematics(ByteReader(body), package);
        case SubPackage::configuration:
            return readConfiguration(ByteReader(body), package);
    }
    return {};
}

Result<Package> readRobotState(ByteReader reader) {
    Package package;
    while (reader.remaining() > 0) {
        const auto size = reader.number<std::uint32_t>();
        const auto type = reader.uint8();
        const auto body = reader.take(size < kHeaderSize ? std::numeric_limits<std::size_t>::max()
                                                         : size - kHeaderSize);
        if (!reader.ok()) {
            return malformed(fmt::format("sub-package {}", type), size);
        }
        METIER_TRY(readSubPackage(type, body, package));
    }
    return package;
}

Version readVersion(ByteReader& reader) {
    reader.take(reader.uint8());  // name of the software
    return {reader.uint8()};
}

Report readError(ByteReader& reader) {
    Report report{Report::Kind::error};
    report.code = reader.number<std::int32_t>();
    report.argument = reader.number<std::int32_t>();
    const auto level = reader.number<std::int32_t>();
    report.level = static_cast<Report::Level>(std::clamp<std::int32_t>(level, 0, 5));
    reader.take(8);  // type of the data and the data
    report.text = printable(reader.restAsText());
    return report;
}

Report readSafety(ByteReader& reader) {
    Report report{Report::Kind::safety, Report::Level::violation};
    report.code = reader.number<std::int32_t>();
    report.argument = reader.number<std::int32_t>();
    const auto mode = static_cast<SafetyMode>(reader.uint8());
    report.text = ur_driver::toText(mode);
    return report;
}

Report readException(ByteReader& reader) {
    Report report{Report::Kind::runtime_exception, Report::Level::fault};
    report.code = reader.number<std::int32_t>();
    report.argument = reader.number<std::int32_t>();
    report.text = printable(reader.restAsText());
    return report;
}

Result<Package> readRobotMessage(ByteReader reader) {
    const auto size = reader.remaining();
    Package package;
    reader.take(8 + 1);  // time stamp, source
    switch (static_cast<Message>(reader.uint8())) {
        case Message::text:
            package.report = Report{Report::Kind::text, Report::Level::info, 0, 0,
                                    printable(reader.restAsText())};
            break;
        case Message::version:
            package.version = readVersion(reader);
            break;
        case Message::safety:
            package.report = readSafety(reader);
            break;
        case Message::error:
            package.report = readError(reader);
            break;
        case Message::runtime_exception:
            package.report = readException(reader);
            break;
        default:
            break;
    }
    if (!reader.ok()) {
        return malformed("message", size);
    }
    return package;
}

}  // namespace

std::string Report::toText() const {
    std::string head;
    if (kind == Kind::error || kind == Kind::safety) {
        head = fmt::format("C{}A{}", code, argument);
    } else if (kind == Kind::runtime_exception) {
        head = fmt::format("runtime exception in line {}, column {}", code, argument);
    }
    return head.empty() || text.empty() ? head + text : head + ": " + text;
}

Result<std::optional<std::size_t>> firstPackageSize(const StreamBuffer& buffer) {
    const auto bytes = buffer.received();
    if (bytes.size() < kHeaderSize) {
        return std::nullopt;
    }
    const auto size = ByteReader(bytes).number<std::int32_t>();
    if (size < static_cast<std::int32_t>(kHeaderSize) ||
        size > static_cast<std::int32_t>(kMaxPackageSize)) {
        return fail(Errc::invalid_argument, fmt::format("a primary package of {} bytes", size));
    }
    if (bytes.size() < static_cast<std::size_t>(size)) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(size);
}

Result<Package> parse(std::span<const std::byte> bytes) {
    ByteReader reader(bytes);
    reader.take(4);
    const auto type = reader.uint8();
    if (!reader.ok()) {
        return malformed("package", bytes.size());
    }
    if (type == kRobotState) {
        return readRobotState(reader);
    }
    if (type == kRobotMessage) {
        return readRobotMessage(reader);
    }
    return Package{};
}

}  // namespace metier::ur_driver::primary
