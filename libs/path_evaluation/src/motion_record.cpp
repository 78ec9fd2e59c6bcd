#include "metier/path_evaluation/motion_record.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "metier/base/text.hpp"

namespace metier::path_evaluation {
namespace {

using motion::JointVector;

/// Time, then joint positions, as one line of CSV has them.
Result<std::vector<double>> numbersOf(std::string_view line) {
    std::vector<double> values;
    for (const auto part : split(line, ',')) {
        const auto word = trimmed(part);
        const auto value = numberIn<double>(word);
        if (!value) {
            return fail(Errc::invalid_argument, fmt::format("'{}' is not a number", word));
        }
        values.push_back(*value);
    }
    return values;
}

/// Appends to the record, or returns the reason why not.
Result<void> append(MotionRecord& record, double time, std::span<const double> joints) {
    METIER_ASSIGN(auto position, JointVector::from(joints));
    if (!std::isfinite(time)) {
        return fail(Errc::invalid_argument, fmt::format("time {} s is not finite", time));
    }
    if (position.empty()) {
        return fail(Errc::invalid_argument, "no joint positions behind the time");
    }
    if (!record.empty() && record.back().position.size() != position.size()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} joint positions, {} before", position.size(),
                                record.back().position.size()));
    }
    if (!record.empty() && time <= record.back().time) {
        return fail(Errc::invalid_argument,
                    fmt::format("time {} s is not after {} s", time, record.back().time));
    }
    record.push_back({time, position});
    return {};
}

Result<MotionRecord> recordOfCsv(std::string_view text, std::string_view name) {
    MotionRecord record;
    bool first = true;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const auto end = text.find('\n');
        const auto line = trimmed(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const bool heading = first && !numberIn<double>(trimmed(line.substr(0, line.find(','))));
        first = false;
        if (heading) {
            continue;
        }
        const auto values = numbersOf(line);
        const auto taken = values ? append(record, values->front(), std::span(*values).subspan(1))
                                  : Result<void>(tl::unexpected(values.error()));
        if (!taken) {
            return fail(Errc::invalid_argument,
                        fmt::format("{}:{}: {}", name, number, taken.error().message));
        }
    }
    return record;
}

Result<MotionRecord> recordOfJson(std::string_view text, std::string_view name) {
    MotionRecord record;
    try {
        const auto json = nlohmann::json::parse(text);
        for (const auto& sample : json.is_array() ? json : json.at("preview")) {
            const auto joints = sample.at("joint_position").get<std::vector<double>>();
            if (auto taken = append(record, sample.at("time").get<double>(), joints); !taken) {
                return fail(Errc::invalid_argument,
                            fmt::format("{}: position {}: {}", name, record.size() + 1,
                                        taken.error().message));
            }
        }
    } catch (const nlohmann::json::exception& error) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: position {}: {}", name, record.size() + 1, error.what()));
    }
    return record;
}

}  // namespace

Result<MotionRecord> parseRecord(std::string_view text, std::string_view name) {
    const auto content = trimmed(text);
    const bool json = content.starts_with('[') || content.starts_with('{');
    auto record = json ? recordOfJson(text, name) : recordOfCsv(text, name);
    if (record && record->size() < kFewestRecorded) {
        return fail(Errc::invalid_argument, fmt::format("{}: {} positions, at least {} needed",
                                                        name, record->size(), kFewestRecorded));
    }
    return record;
}

Result<MotionRecord> loadRecord(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf())) {
        return fail(Errc::not_found,
                    fmt::format("{}: no such file, or nothing in it", file.string()));
    }
    return parseRecord(text.str(), file.string());
}

std::string toCsv(const MotionRecord& record) {
    std::string csv = "time";
    const std::size_t axes = record.empty() ? 0 : record.front().position.size();
    for (std::size_t axis = 1; axis <= axes; ++axis) {
        fmt::format_to(std::back_inserter(csv), ",q{}", axis);
    }
    csv += "\n";
    for (const auto& [time, position] : record) {
        fmt::format_to(std::back_inserter(csv), "{}", time);
        for (const double value : position) {
            fmt::format_to(std::back_inserter(csv), ",{}", value);
        }
        csv += "\n";
    }
    return csv;
}

}  // namespace metier::path_evaluation
